"""The calculation as spreadsheet formulas, each written once for the chosen gear and for the list of all.

Names such as `T_av` are defined names of the workbook. `{T_N}` stands for a figure of one gear: a defined name where
the chosen gear is calculated, a cell of its row in the list of candidates. A blank figure is not published. Blocks of
the cycle are summed by SUMPRODUCT, which every spreadsheet program evaluates without array formulas.
"""

from collections.abc import Mapping
from dataclasses import dataclass

from hpn.wording import N_

UNLIMITED, NOT_RATED, NONE = N_("unlimited"), N_("not rated"), "–"
"""What stands where a number would: no limit, figure not published, failed without a number."""

RATINGS = {
    "ratio": "ratio",
    "T_N": "rated_torque_Nm",
    "T_R": "repeated_peak_torque_Nm",
    "T_M": "momentary_peak_torque_Nm",
    "n_av_limit": "average_input_speed_rpm",
    "n_in_limit": "maximum_input_speed_rpm",
    "F_R_dyn": "dynamic_radial_load_N",
    "F_A_dyn": "dynamic_axial_load_N",
    "amb_min": "ambient_temperature_minimum_degC",
    "amb_max": "ambient_temperature_maximum_degC",
    "backlash": "backlash_arcmin",
    "K_3": "torsional_stiffness_Nm_per_rad",
    "weight": "weight_kg",
    "L_max": "length_max_mm",
}
"""Figures of a gear: name in formulas, field of the catalogue."""


MOTOR_TORQUES = ("T_mot_peak", "T_mot_rms")


@dataclass(frozen=True, slots=True)
class Term:
    """A calculated quantity: its name in formulas, its symbol, what it is, its unit, and how it is calculated."""

    name: str
    symbol: str
    label: str
    unit: str
    formula: str
    equation: str = ""

    @property
    def by_efficiency(self) -> bool:
        """Whether it is a torque at the motor, a lower bound without an efficiency."""
        return self.name in MOTOR_TORQUES


_WORK = "SUMPRODUCT(ABS(speed_rpm)*duration_s)"
_CYCLE_TIME = "(SUM(duration_s)+pause_s)"

CYCLE_TERMS = (
    Term("T_max", "T_max", N_("Largest torque"), "Nm", "SUMPRODUCT(MAX(ABS(torque_Nm)))"),
    Term(
        "T_av",
        "T_av",
        N_("Average torque"),
        "Nm",
        f"IF(T_max=0,0,T_max*(SUMPRODUCT(ABS(speed_rpm)*duration_s*(ABS(torque_Nm)/T_max)^(10/3))/{_WORK})^0.3)",
        "17.2",
    ),
    Term(
        "T_rms",
        "T_rms",
        N_("RMS torque"),
        "Nm",
        f"IF(T_max=0,0,T_max*SQRT(SUMPRODUCT((torque_Nm/T_max)^2*duration_s)/{_CYCLE_TIME}))",
    ),
    Term("n_out_max", "n_out,max", N_("Largest output speed"), "rpm", "SUMPRODUCT(MAX(ABS(speed_rpm)))"),
    Term("n_out_av", "n_out,av", N_("Average output speed"), "rpm", f"{_WORK}/{_CYCLE_TIME}", "17.4"),
    Term(
        "k_b",
        "k",
        N_("Load factor of bearing life and speed"),
        "",
        '(bearing_speed*bearing_life/(n_out_av*L_b*IF(life_basis="L10",5,1)))^(1/3)',
    ),
)
"""What the cycle comes to, whatever the gear."""

_R, _A = "(radial_used/{F_R_dyn})", "(axial_used/{F_A_dyn})"
_P = f'({_R}+{_A}+(model="iso281")*(({_R}+0.56*{_R}+{_A}+ABS({_R}-0.56*{_R}-{_A}))/2-{_R}-{_A}))'
_LOADED = "COUNT(F_R,F_A,radial_N,axial_N)>0"


def _bearing(formula: str) -> str:
    return f'IF(NOT({_LOADED}),"",IF(OR({{F_R_dyn}}="",{{F_A_dyn}}=""),"",{formula}))'


GEAR_TERMS = (
    Term("n_in_av", "n_in,av", N_("Average input speed"), "rpm", "{ratio}*n_out_av", "17.5"),
    Term("n_in_max", "n_in,max", N_("Largest input speed"), "rpm", "{ratio}*n_out_max", "17.6"),
    Term(
        "N_k_max",
        "N_k,max",
        N_("Allowed emergency stops"),
        "",
        'IF(OR(T_k="",{T_R}=""),"",IF(ABS(T_k)<={T_R},"[unlimited]",IFERROR(INT(10^(8.5-1.5*ABS(T_k)/{T_R})*(1+1E-12)),0)))',
        "17.9",
    ),
    Term(
        "L_10",
        "L_10",
        N_("Gear life"),
        "h",
        'IF({T_N}="","",IF(T_av=0,"[unlimited]",'
        'IFERROR(rated_life*rated_speed/{n_in_av}*({T_N}/T_av)^(10/3),"[unlimited]")))',
        "17.10",
    ),
    Term("P_max", "f_w·P_max", N_("Largest bearing load"), "", _bearing(f"f_w*SUMPRODUCT(MAX({_P}))")),
    Term(
        "P_m",
        "f_w·P_m",
        N_("Equivalent bearing load"),
        "",
        _bearing(f"f_w*(SUMPRODUCT(ABS(speed_rpm)*duration_s*{_P}^3)/{_WORK})^(1/3)"),
    ),
    Term(
        "L_b50",
        "L_b,50",
        N_("Bearing life L50"),
        "h",
        'IF({P_m}="","",IFERROR(bearing_life*bearing_speed/n_out_av/{P_m}^3,"[unlimited]"))',
    ),
    Term("T_mot_peak", "T_max/(i·η)", N_("Peak motor torque needed"), "Nm", 'T_max/({ratio}*IF(eta="",1,eta))'),
    Term("T_mot_rms", "T_rms/(i·η)", N_("RMS motor torque needed"), "Nm", 'T_rms/({ratio}*IF(eta="",1,eta))'),
)
"""What a gear comes to under the cycle."""


@dataclass(frozen=True, slots=True)
class SheetCheck:
    """A check as formulas: when it is asked for, its value, its limit, and the utilisation of published figures."""

    asked: str
    demand: str
    limit: str
    utilisation: str = ""

    @property
    def ratio(self) -> str:
        """Utilisation; blank where not asked for, words where there is no number."""
        used = self.utilisation or f"{self.demand}/{self.limit}"
        unknown = f'OR({self.demand}="",{self.limit}="")'
        return f'IF(NOT({self.asked}),"",IF({unknown},"[not rated]",{used}))'

    @property
    def shown_demand(self) -> str:
        """The value, where the check is asked for."""
        return f'IF({self.asked},{self.demand},"")'

    @property
    def shown_limit(self) -> str:
        """The limit, where the check is asked for."""
        return f'IF({self.asked},{self.limit},"")'


def _given(name: str) -> str:
    return f'{name}<>""'


_MIDDLE, _HALF = "(({amb_min}+{amb_max})/2)", "(({amb_max}-{amb_min})/2)"

CHECKS = {
    "average_torque": SheetCheck("TRUE", "T_av", "{T_N}"),
    "repeated_peak_torque": SheetCheck("TRUE", "T_max", "{T_R}"),
    "momentary_peak_torque": SheetCheck(_given("T_k"), "ABS(T_k)", "{T_M}"),
    "momentary_peak_count": SheetCheck(
        'AND(T_k<>"",N_k<>"")',
        "N_k",
        "{N_k_max}",
        'IF({N_k_max}="[unlimited]",0,IF({N_k_max}=0,"–",N_k/{N_k_max}))',
    ),
    "average_input_speed": SheetCheck("TRUE", "{n_in_av}", "{n_av_limit}"),
    "maximum_input_speed": SheetCheck("TRUE", "{n_in_max}", "{n_in_limit}"),
    "life": SheetCheck(_given("L_10_req"), "{L_10}", "L_10_req", 'IF({L_10}="[unlimited]",0,L_10_req/{L_10})'),
    "output_bearing_load": SheetCheck(_LOADED, "{P_max}", "1"),
    "output_bearing_life": SheetCheck(_LOADED, "{P_m}", "k_b"),
    "motor_speed": SheetCheck(_given("n_mot"), "{n_in_max}", "n_mot"),
    "motor_peak_torque": SheetCheck(_given("T_mot"), "{T_mot_peak}", "T_mot"),
    "motor_rated_torque": SheetCheck(_given("T_mot_N"), "{T_mot_rms}", "T_mot_N"),
    "ambient_temperature": SheetCheck(
        _given("t_amb"),
        "t_amb",
        'IF(OR({amb_min}="",{amb_max}=""),"",IF(t_amb>=' + _MIDDLE + ",{amb_max},{amb_min}))",
        f"ABS(t_amb-{_MIDDLE})/{_HALF}",
    ),
    "backlash": SheetCheck(_given("j_req"), "{backlash}", "j_req"),
    "torsional_stiffness": SheetCheck(_given("K_3_req"), "{K_3}", "K_3_req", "K_3_req/{K_3}"),
    "weight": SheetCheck(_given("m_req"), "{weight}", "m_req"),
    "length": SheetCheck(_given("L_req"), "{L_max}", "L_req"),
}


def written(formula: str, names: Mapping[str, str], words: Mapping[str, str]) -> str:
    """A formula for one gear: its figures by `names`, and the words in the reader's language."""
    for english, word in words.items():
        formula = formula.replace(f'"[{english}]"', '"' + word.replace('"', '""') + '"')
    return "=" + formula.format_map(names)

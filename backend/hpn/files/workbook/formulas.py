"""The calculation as spreadsheet formulas, each written once for the chosen gear and for the list of candidates.

Names such as `T_av` are defined names of the workbook, made from the symbols. `{T_N}` is a figure of one gear: a
defined name where the chosen gear is calculated, a cell of its row in the list of candidates. A blank figure is not
published. Blocks of the cycle are summed by SUMPRODUCT, which every spreadsheet program evaluates without array
formulas.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from string import Formatter

from hpn.catalogue.gear import Gear
from hpn.engine.check import Check
from hpn.engine.checks import CHECKS
from hpn.engine.checks.output_bearing import LOADED
from hpn.words.quantities import CANDIDATE, DUTY, GEAR, INPUTS
from hpn.words.units import suffix_of
from hpn.words.wording import N_, Named

UNLIMITED, NOT_RATED, NONE = N_("unlimited"), N_("not rated"), "–"
"""Texts in place of a number: no limit, figure not published, failed without a number."""

REVERSES = "reverses"
"""Name of the cell that says whether the torque acts both ways; blank where the signs of the torques say."""

_NAMES = {
    "η": "eta",
    "t_p": "pause_s",
    "k": "k_b",
    "t_min": "amb_min",
    "t_max": "amb_max",
    "L_b,50": "L_b50",
    "T_max/(i·η)": "T_mot_peak",
    "T_rms/(i·η)": "T_mot_rms",
    "f_w·P_max": "P_max",
    "f_w·P_m": "P_m",
    "t_b": "t_rise",
    "t_r": "t_reaction",
    "φ_a": "phi_a",
    "φ_w": "phi_w",
    "φ_e": "phi_e",
    "φ_req": "phi_req",
    "φ_stop": "phi_stop",
}
"""Names of symbols that are not allowed as a defined name, or that differ from another in capitals only."""


def cell_name(symbol: str) -> str:
    """Defined name of a symbol: `T_mot,N` is `T_mot_N`, `n_in(max)` is `n_in_limit`."""
    return _NAMES.get(symbol) or symbol.replace("(max)", "_limit").replace(",", "_")


RATINGS = {
    cell_name(named.symbol): field for field, named in GEAR.items() if named.symbol and field not in Gear.unpublished()
}
"""Published figures of a gear: name in formulas, field of the catalogue."""

MOTOR_TORQUES = ("T_mot_peak", "T_mot_rms")


@dataclass(frozen=True, slots=True)
class CellTerm:
    """A calculated quantity: its name and symbol, the suffix of its unit, its formula, and its field of a candidate."""

    named: Named
    unit: str
    formula: str
    field: str = ""

    @property
    def name(self) -> str:
        """Its name in formulas."""
        return cell_name(self.named.symbol)

    @property
    def by_efficiency(self) -> bool:
        """True for a torque at the motor, which is a lower bound without an efficiency."""
        return self.name in MOTOR_TORQUES


def _duty(field: str, formula: str) -> CellTerm:
    return CellTerm(DUTY[field], suffix_of(field), formula)


def _result(field: str, formula: str) -> CellTerm:
    return CellTerm(CANDIDATE[field], suffix_of(field), formula, field)


# --- The cycle --------------------------------------------------------------------------------------------------------

_WORK = "SUMPRODUCT(ABS(speed_rpm)*duration_s)"
_CYCLE_TIME = "(SUM(duration_s)+pause_s)"


def _varying(name: str, steady: str) -> str:
    """Formula of a figure of phases that vary; of a steady phase where a cell is empty."""
    return f'(ABS({steady})*({name}="")+{name})'


_PEAKS, _FASTEST = _varying("peak_torque_Nm", "torque_Nm"), _varying("peak_speed_rpm", "speed_rpm")
_RMS = _varying("rms_torque_Nm", "torque_Nm")
_SIGNED = f"SIGN(torque_Nm)*{_PEAKS}"
_UNUSED = '(duration_s="")*1E+99'
"""Term that keeps a spare row from being the largest."""

_BOTH_WAYS = f'IF({REVERSES}="",SUMPRODUCT(--(torque_Nm<0))=0,{REVERSES})'
_LARGEST = "SUMPRODUCT(MAX(ABS(torque_Nm)))"
"""Largest mean torque, by which powers are scaled."""

CYCLE_TERMS = (
    _duty("maximum_torque_Nm", f"SUMPRODUCT(MAX({_PEAKS}))"),
    _duty(
        "average_torque_Nm",
        f"IF({_LARGEST}=0,0,{_LARGEST}*"
        f"(SUMPRODUCT(ABS(speed_rpm)*duration_s*(ABS(torque_Nm)/{_LARGEST})^(10/3))/{_WORK})^0.3)",
    ),
    CellTerm(
        Named(N_("RMS torque"), "T_rms"),
        "Nm",
        f"IF(T_max=0,0,T_max*SQRT(SUMPRODUCT(({_RMS}/T_max)^2*duration_s)/{_CYCLE_TIME}))",
    ),
    CellTerm(
        Named(N_("Smallest torque, signed"), "T_lo"),
        "Nm",
        f"IF({_BOTH_WAYS},-T_max,MIN(-SUMPRODUCT(MAX(-{_SIGNED}-{_UNUSED})),IF(pause_s>0,0,1E+99)))",
    ),
    CellTerm(
        Named(N_("Largest torque, signed"), "T_hi"),
        "Nm",
        f"IF({_BOTH_WAYS},T_max,MAX(SUMPRODUCT(MAX({_SIGNED}-{_UNUSED})),IF(pause_s>0,0,-1E+99)))",
    ),
    _duty("maximum_output_speed_rpm", f"SUMPRODUCT(MAX({_FASTEST}))"),
    _duty("average_output_speed_rpm", f"{_WORK}/{_CYCLE_TIME}"),
    CellTerm(
        Named(N_("Life factor"), "k"),
        "",
        '(bearing_speed*bearing_life/(n_out_av*L_b*IF(life_basis="L10",5,1)))^(1/3)',
    ),
)
"""Figures of the cycle, the same for every gear."""


# --- The gear ---------------------------------------------------------------------------------------------------------

_R, _A = "(radial_used/{F_R_dyn_limit})", "(axial_used/{F_A_dyn_limit})"
_P = f'({_R}+{_A}+(model="iso281")*(({_R}+0.56*{_R}+{_A}+ABS({_R}-0.56*{_R}-{_A}))/2-{_R}-{_A}))'


def _bearing(formula: str) -> str:
    return f'IF(NOT({LOADED}),"",IF(OR({{F_R_dyn_limit}}="",{{F_A_dyn_limit}}=""),"",{formula}))'


GEAR_TERMS = (
    _result("average_input_speed_rpm", "{i}*n_out_av"),
    _result("maximum_input_speed_rpm", "{i}*n_out_max"),
    _result(
        "momentary_peak_count",
        'IF(OR(T_k="",{T_R}=""),"",IF(ABS(T_k)<={T_R},"[unlimited]",IFERROR(INT(10^(8.5-1.5*ABS(T_k)/{T_R})*(1+1E-12)),0)))',
    ),
    _result(
        "life_L10_h",
        'IF({T_N}="","",IF(T_av=0,"[unlimited]",'
        'IFERROR(rated_life*rated_speed/{n_in_av}*({T_N}/T_av)^(10/3),"[unlimited]")))',
    ),
    CellTerm(Named(N_("Largest bearing load"), "f_w·P_max"), "", _bearing(f"f_w*SUMPRODUCT(MAX({_P}))")),
    CellTerm(
        Named(N_("Equivalent bearing load"), "f_w·P_m"),
        "",
        _bearing(f"f_w*(SUMPRODUCT(ABS(speed_rpm)*duration_s*{_P}^3)/{_WORK})^(1/3)"),
    ),
    _result("bearing_life_L50_h", 'IF({P_m}="","",IFERROR(bearing_life*bearing_speed/n_out_av/{P_m}^3,"[unlimited]"))'),
    _result("motor_peak_torque_Nm", 'T_max/({i}*IF(eta="",1,eta))'),
    _result("natural_frequency_Hz", 'IF(OR(J_L="",{K_3}=""),"",SQRT({K_3}/J_L)/2/PI())'),
    _result(
        "position_error_arcmin",
        'IF(OR({phi_a}="",{j}="",{K_3}=""),"",{phi_a}+(T_hi-T_lo)/{K_3}*10800/PI()+IF(AND(T_lo<=0,T_hi>=0),{j},0))',
    ),
    _result("motor_rated_torque_Nm", 'T_rms/({i}*IF(eta="",1,eta))'),
)
"""Figures of a gear under the cycle."""


# --- Checks -----------------------------------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class SheetCheck:
    """A check as formulas: condition under which it is asked for, demand, limit, utilisation of published figures."""

    asked: str
    demand: str
    limit: str
    utilisation: str

    @property
    def ratio(self) -> str:
        """Utilisation; blank where not asked for, words where there is no number."""
        unknown = f'OR({self.demand}="",{self.limit}="")'
        return f'IF(NOT({self.asked}),"",IF({unknown},"[not rated]",{self.utilisation}))'

    @property
    def shown_demand(self) -> str:
        """The value, where the check is asked for."""
        return f'IF({self.asked},{self.demand},"")'

    @property
    def shown_limit(self) -> str:
        """The limit, where the check is asked for."""
        return f'IF({self.asked},{self.limit},"")'


def formulas_of(check: Check) -> SheetCheck | None:
    """A check as formulas; None where no cell holds what it compares."""
    sheet = check.sheet
    if sheet is None:
        return None
    asked = f'{cell_name(INPUTS[check.asked].symbol)}<>""' if check.asked else "TRUE"
    share = f"{sheet.limit}/{sheet.demand}" if check.kind == "minimum" else f"{sheet.demand}/{sheet.limit}"
    return SheetCheck(sheet.asked or asked, sheet.demand, sheet.limit, sheet.share or share)


CHECK_FORMULAS: Mapping[str, SheetCheck] = {
    check.code: formulas for check in CHECKS if (formulas := formulas_of(check)) is not None
}
"""Checks that the workbook calculates, by code; the others stand in it as saved."""


def written(formula: str, names: Mapping[str, str], words: Mapping[str, str]) -> str:
    """A formula for one gear: its figures by `names`, and the words in the reader's language."""
    for english, word in words.items():
        formula = formula.replace(f'"[{english}]"', '"' + word.replace('"', '""') + '"')
    return "=" + formula.format_map(names)


def terms_of(formula: str) -> set[str]:
    """Figures of the gear that a formula takes."""
    return {name for _, name, *_ in Formatter().parse(formula) if name}

"""How each check is written, and which published figure its limit is."""

from dataclasses import dataclass

from hpn.report.export import Export
from hpn.report.language import Language


@dataclass(frozen=True, slots=True)
class Standing:
    """Relation that a check tests, in the handbook's symbols, and the catalogue figure behind its limit."""

    relation: str
    figure: str | None = None


STANDINGS = {
    "average_torque": Standing("T_av ≤ T_A = T_N", "rated_torque_Nm"),
    "repeated_peak_torque": Standing("T_max ≤ T_R", "repeated_peak_torque_Nm"),
    "momentary_peak_torque": Standing("T_k ≤ T_M", "momentary_peak_torque_Nm"),
    "momentary_peak_count": Standing("N_k ≤ N_k,max", "repeated_peak_torque_Nm"),
    "average_input_speed": Standing("n_in,av ≤ n_av(max)", "average_input_speed_rpm"),
    "maximum_input_speed": Standing("n_in,max ≤ n_in(max)", "maximum_input_speed_rpm"),
    "life": Standing("L_10 ≥ L_10,req", "rated_torque_Nm"),
    "output_bearing_load": Standing("max f_w · P_i ≤ 1", "dynamic_radial_load_N"),
    "output_bearing_life": Standing("f_w · P_m ≤ k", "dynamic_radial_load_N"),
    "motor_speed": Standing("n_in,max ≤ n_mot"),
    "motor_peak_torque": Standing("T_max / (i · η) ≤ T_mot"),
    "motor_rated_torque": Standing("T_rms / (i · η) ≤ T_mot,N"),
    "ambient_temperature": Standing("t_min ≤ t_amb ≤ t_max", "ambient_temperature_maximum_degC"),
    "backlash": Standing("j ≤ j_req", "backlash_arcmin"),
    "torsional_stiffness": Standing("K_3 ≥ K_3,req", "torsional_stiffness_Nm_per_rad"),
    "weight": Standing("m ≤ m_req", "weight_kg"),
    "length": Standing("L_max ≤ L_req", "length_max_mm"),
}
"""By check code; the tests hold them against the checks."""


def source(export: Export, code: str, language: Language) -> str:
    """Where the limit of a check on the reported gear comes from, as exactly as it is known."""
    gear, name = export.gear(export.candidate["designation"]), STANDINGS[code].figure
    exact = gear.sources.get(name) if gear and name else None
    return language.filled(exact or export.definitions[code]["source"])

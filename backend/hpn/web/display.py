"""Numbers and names as a reader sees them. Full precision stays in the API and in the page's `data-value`."""

import re

from markupsafe import Markup, escape

from hpn.checks import telling_decimals
from hpn.wording import N_

GROUP = "\N{NARROW NO-BREAK SPACE}"
_SUPERSCRIPT = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")

CHECK_NAMES = {
    "average_torque": N_("average torque"),
    "repeated_peak_torque": N_("repeated peak torque"),
    "momentary_peak_torque": N_("momentary peak torque"),
    "momentary_peak_count": N_("number of emergency stops"),
    "average_input_speed": N_("average input speed"),
    "maximum_input_speed": N_("maximum input speed"),
    "life": N_("gear life"),
    "output_bearing_load": N_("largest load on the output bearing"),
    "output_bearing_life": N_("life of the output bearing"),
    "motor_speed": N_("motor speed"),
    "motor_peak_torque": N_("motor peak torque"),
    "motor_rated_torque": N_("motor rated torque"),
    "ambient_temperature": N_("ambient temperature"),
    "backlash": N_("backlash"),
    "torsional_stiffness": N_("torsional stiffness"),
    "weight": N_("weight"),
    "length": N_("length"),
}
"""Checks by code, as they stand inside a sentence."""

BEST = {
    "weight": N_("The lightest gear that passes every check."),
    "utilisation": N_("The gear that stays furthest below its closest limit."),
    "length": N_("The shortest gear that passes every check."),
    "motor_torque": N_("The gear that needs the least motor torque among those that pass every check."),
    "life": N_("The gear with the longest life among those that pass every check."),
    "stiffness": N_("The stiffest gear that passes every check."),
}
"""Why the selected gear is selected, by what the candidates are ranked by."""

FIELD_NAMES = {
    "T": N_("Torque"),
    "n": N_("Speed"),
    "t": N_("Duration"),
    "FRi": N_("Radial load"),
    "FAi": N_("Axial load"),
    "tp": N_("Pause"),
    "Tk": N_("Emergency-stop torque"),
    "Nk": N_("Number of emergency stops"),
    "FR": N_("Radial load"),
    "FA": N_("Axial load"),
    "fw": N_("Load coefficient"),
    "Lb": N_("Bearing life"),
    "Lbb": N_("Basis of the bearing life"),
    "bm": N_("Envelope"),
    "i": N_("Ratio"),
    "size": N_("Size"),
    "Lh": N_("Gear life"),
    "ta": N_("Ambient temperature"),
    "bl": N_("Backlash"),
    "K3": N_("Torsional stiffness"),
    "m": N_("Weight"),
    "L": N_("Length"),
    "u": N_("Use at most"),
    "aa": N_("Special area of use"),
    "rank": N_("Prefer"),
    "nm": N_("Motor's maximum speed"),
    "Tm": N_("Motor's peak torque"),
    "Tmn": N_("Motor's rated torque"),
    "eta": N_("Gear efficiency"),
    "gear": N_("Candidate"),
}
"""Inputs by query name, as a list of errors calls them."""

LIMIT_FIGURES = {
    "average_torque": "rated_torque_Nm",
    "repeated_peak_torque": "repeated_peak_torque_Nm",
    "momentary_peak_torque": "momentary_peak_torque_Nm",
    "momentary_peak_count": "repeated_peak_torque_Nm",
    "average_input_speed": "average_input_speed_rpm",
    "maximum_input_speed": "maximum_input_speed_rpm",
    "life": "rated_torque_Nm",
    "output_bearing_load": "dynamic_radial_load_N",
    "output_bearing_life": "dynamic_radial_load_N",
    "ambient_temperature": "ambient_temperature_maximum_degC",
    "backlash": "backlash_arcmin",
    "torsional_stiffness": "torsional_stiffness_Nm_per_rad",
    "weight": "weight_kg",
    "length": "length_max_mm",
}
"""Catalogue figure that a check draws on, whose source stands beside it; the other limits are the user's."""


def capped_percent(utilisation: float | None, allowed: float = 1.0) -> str:
    """Percentage without its sign, for a narrow cell: beyond tenfold it matters no more by how much."""
    if utilisation is not None and utilisation >= 9.995:
        return ">999"
    return percent(utilisation, allowed).removesuffix(f"{GROUP}%")


def figure(value: float | None) -> str:
    """Number for reading: catalogue figures as printed, computed ones to three digits, never fewer than the integer.

    32.0210136 is `32.0`, 1167275.9 is `1 167 276`, 9.3 stays `9.3`, None is a dash.
    """
    if value is None:
        return "–"
    magnitude = abs(value)
    if magnitude >= 1e10 or 0 < magnitude < 1e-4:
        mantissa, exponent = f"{value:.2e}".split("e")
        return f"{mantissa}·10{str(int(exponent)).translate(_SUPERSCRIPT)}"
    short = f"{value:.12g}"
    if len(short.lstrip("-").replace(".", "").lstrip("0")) <= 4 and "e" not in short:
        return _grouped(short)
    if magnitude >= 100:
        return _grouped(f"{value:.0f}")
    return f"{value:#.3g}".rstrip(".")


def plain(number: str) -> str:
    """A number that was rounded already, such as `2e+04` or `1234.5`, for reading."""
    if "e" not in number:
        return _grouped(number) if number[-1:].isdigit() else number
    mantissa, exponent = number.split("e")
    if -5 <= int(exponent) < 10:
        return _grouped(f"{float(number):.12f}".rstrip("0").rstrip("."))
    return f"{mantissa}·10{str(int(exponent)).translate(_SUPERSCRIPT)}"


def percent(utilisation: float | None, allowed: float = 1.0) -> str:
    """Utilisation as a percentage, with as many digits as it takes to tell it from what is allowed."""
    if utilisation is None:
        return "–"
    value = utilisation * 100
    if value > 99_999:
        return f">{GROUP}99{GROUP}999{GROUP}%"
    digits = telling_decimals(value, 100 * allowed, 1 if 0 < value < 9.95 else 0)
    return f"{_grouped(f'{value:.{digits}f}')}{GROUP}%"


_SYMBOL = re.compile(r"\b([A-Za-z])_([A-Za-z0-9]+(?:_[a-z]+)*(?:\([a-z]+\))?)")


def symbols(text: str) -> Markup:
    """Text with the handbook's symbols set as such: `T_R` with R as an index, `n_out_av` with two words as one."""
    return Markup(_SYMBOL.sub(_set, str(escape(text))))


def _set(symbol: re.Match[str]) -> str:
    return f'<var class="symbol">{symbol[1]}<sub>{symbol[2].replace("_", " ")}</sub></var>'


def _grouped(number: str) -> str:
    """Thousands apart, from 1 000 on."""
    whole, dot, fraction = number.partition(".")
    return f"{int(whole):,}".replace(",", GROUP) + dot + fraction if not whole.startswith("-0") else number

"""The symbols of links and of the form, and the field of the application that each stands for."""

from dataclasses import dataclass
from typing import Literal

from hpn.units import suffix_of

Kind = Literal["number", "whole", "text"]


@dataclass(frozen=True, slots=True)
class Symbol:
    """A query name, and the field of the application that it stands for."""

    name: str
    path: tuple[str, ...]
    kind: Kind = "number"
    many: bool = False


PHASE_SYMBOLS = (
    Symbol("T", ("torque_Nm",)),
    Symbol("n", ("speed_rpm",)),
    Symbol("t", ("duration_s",)),
    Symbol("FRi", ("radial_N",)),
    Symbol("FAi", ("axial_N",)),
)
"""Repeated once per phase, all of equal length."""

SYMBOLS = (
    Symbol("tp", ("duty_cycle", "pause_s")),
    Symbol("Tk", ("emergency_stop", "torque_Nm")),
    Symbol("Nk", ("emergency_stop", "count"), "whole"),
    Symbol("FR", ("output_load", "radial_N")),
    Symbol("FA", ("output_load", "axial_N")),
    Symbol("fw", ("output_load", "load_coefficient")),
    Symbol("Lb", ("output_load", "life_h")),
    Symbol("Lbb", ("output_load", "life_basis"), "text"),
    Symbol("bm", ("output_load", "model"), "text"),
    Symbol("i", ("requirements", "ratios"), "whole", many=True),
    Symbol("size", ("requirements", "sizes"), "text", many=True),
    Symbol("Lh", ("requirements", "life_h")),
    Symbol("ta", ("requirements", "ambient_temperature_degC")),
    Symbol("bl", ("requirements", "backlash_arcmin")),
    Symbol("K3", ("requirements", "torsional_stiffness_Nm_per_rad")),
    Symbol("m", ("requirements", "weight_kg")),
    Symbol("L", ("requirements", "length_mm")),
    Symbol("u", ("requirements", "utilisation")),
    Symbol("eta", ("requirements", "efficiency")),
    Symbol("aa", ("application_area",), "text"),
    Symbol("rank", ("rank_by",), "text"),
    Symbol("nm", ("requirements", "motor", "maximum_speed_rpm")),
    Symbol("Tm", ("requirements", "motor", "peak_torque_Nm")),
    Symbol("Tmn", ("requirements", "motor", "rated_torque_Nm")),
)
"""Everything but the phases, in the order of a canonical link: one part of an application at a time."""

PHASE_BY_NAME = {symbol.name: symbol for symbol in PHASE_SYMBOLS}
PHASE_BY_LEAF = {symbol.path[0]: symbol for symbol in PHASE_SYMBOLS}
BY_NAME = {symbol.name: symbol for symbol in SYMBOLS}
BY_PATH = {symbol.path: symbol for symbol in SYMBOLS}
UNITS = {
    symbol.name: suffix_of(symbol.path[-1]) or ""
    for symbol in (*PHASE_SYMBOLS, *SYMBOLS)
    if symbol.kind != "text" and not symbol.many
}

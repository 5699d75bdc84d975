"""Table of inputs: symbol in links, place in the application, and appearance in the form.

Form, link writer and link reader are loops over it. An input's name and sign are in `hpn.words.quantities`.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cache

from hpn.documents.common import COMMON
from hpn.engine.notice import AREAS
from hpn.links import labels
from hpn.links.row_symbols import BODY_SYMBOLS, PHASE_SYMBOLS, TURN_SYMBOLS, move_symbols
from hpn.links.symbol import MOTION_PATH, Symbol
from hpn.physics.motion.mechanisms import CLASSES, Rotary
from hpn.tables.inputs import Input, Inputs
from hpn.tables.numbers import Kind
from hpn.words.quantities import CANDIDATE
from hpn.words.terms import BEARING_MODELS, JUDGED, LIFE_BASES, POSITION_ERROR_AT, RANKINGS
from hpn.words.wording import N_


@dataclass(frozen=True, slots=True)
class FormGroup:
    """Inputs under one heading of the form, in its order; a folded group opens where an input in it is given."""

    code: str
    title: str
    names: tuple[str, ...]
    folded: bool = True
    hint: str = ""

    @property
    def symbols(self) -> tuple["Symbol", ...]:
        """Inputs of the group."""
        return tuple(BY_NAME[name] for name in self.names)


YEAR = N_("A year (yr) counts as 8766 h, without a standstill.")
"""Hint beside a life: a year is 365.25 days of operation."""

SYMBOLS = (
    Symbol("tp", ("duty_cycle", "pause_s")),
    Symbol("Tk", ("emergency_stop", "torque_Nm")),
    Symbol("Nk", ("emergency_stop", "count"), "whole"),
    Symbol(
        "TB", ("emergency_stop", "brake", "torque_Nm"), hint=N_("At the motor, the largest; T_k follows for each gear.")
    ),
    Symbol("tb", ("emergency_stop", "brake", "rise_time_s"), placeholder="0"),
    Symbol("tr", ("emergency_stop", "brake", "reaction_time_s"), placeholder="0"),
    Symbol(
        "nb", ("emergency_stop", "brake", "speed_rpm"), hint=N_("At the output; by default the largest of the cycle.")
    ),
    Symbol(
        "TL",
        ("emergency_stop", "brake", "load_torque_Nm"),
        placeholder="0",
        hint=N_("At the gear, of weight and process; a motion has its own."),
    ),
    Symbol(
        "To",
        ("emergency_stop", "brake", "opposing_torque_Nm"),
        hint=N_("With friction and J · α; by default the load’s torque."),
    ),
    Symbol(
        "kd",
        ("emergency_stop", "brake", "dynamic_factor"),
        hint=N_("Your own, in place of the bound of T_k."),
    ),
    Symbol("FR", ("output_load", "radial_N")),
    Symbol("FA", ("output_load", "axial_N")),
    Symbol(
        "fw",
        ("output_load", "load_coefficient"),
        placeholder="1",
        offered=(1, 1.2, 1.5),
        hint=N_("1–1.2 smooth, 1.2–1.5 normal, 1.5–3 with impact"),
    ),
    Symbol("Lb", ("output_load", "life_h"), placeholder="20000", hint=YEAR),
    Symbol(
        "Lbb",
        ("output_load", "life_basis"),
        "text",
        choices=LIFE_BASES,
    ),
    Symbol(
        "bm",
        ("output_load", "model"),
        "text",
        choices=BEARING_MODELS,
        hint=N_("ISO 281 permits more than the line where both loads act."),
        supplied={"digitised": "curves"},
    ),
    Symbol(
        "xR",
        ("output_load", "radial_position_mm"),
        hint=N_("From the shoulder outwards; by default the shaft’s centre."),
    ),
    Symbol(
        "yA",
        ("output_load", "axial_radius_mm"),
        placeholder="0",
        hint=N_("From the shaft’s axis; by default along it."),
    ),
    Symbol(
        "xc",
        ("output_load", "shaft_centre_mm"),
        "by_size",
        hint=N_("From the shoulder; by size: 20A:\u00a021; others:\u00a018"),
    ),
    Symbol(
        "fm",
        ("output_load", "from_motion"),
        "flag",
        choices={"": N_("not counted"), "1": N_("counted: it sits on the gear’s shaft")},
    ),
    Symbol("hx", ("output_load", "rack_helix_deg"), placeholder="0"),
    Symbol(
        "kb",
        ("output_load", "belt_tension_factor"),
        placeholder="2",
        hint=N_("Radial load over the largest tangential force; acts always."),
    ),
    Symbol(
        "dt",
        ("output_load", "drive", "type"),
        "text",
        choices={"": N_("neither"), "rack_and_pinion": N_("pinion of a rack"), "belt": N_("pulley of a belt")},
    ),
    Symbol("dd", ("output_load", "drive", "diameter_mm")),
    Symbol("i", ("requirements", "ratios"), "whole", many=True),
    Symbol("size", ("requirements", "sizes"), "text", many=True),
    Symbol("Lh", ("requirements", "life_h"), hint=YEAR),
    Symbol("ta", ("requirements", "ambient_temperature_degC"), offered=(0, 25, 40)),
    Symbol("bl", ("requirements", "backlash_arcmin"), offered="backlash_arcmin"),
    Symbol("K3", ("requirements", "torsional_stiffness_Nm_per_rad"), offered="torsional_stiffness_Nm_per_rad"),
    Symbol("m", ("requirements", "weight_kg"), offered="weight_kg"),
    Symbol("L", ("requirements", "length_mm"), offered="length_max_mm"),
    Symbol(
        "u",
        ("requirements", "utilisation"),
        placeholder="1",
        offered=(0.7, 0.8, 0.9, 1),
        hint=N_("0.8 keeps every load at or below 80\u202f% of its limit."),
    ),
    Symbol(
        "uw",
        ("requirements", "worst_case_utilisation"),
        offered=(0.8, 0.9, 1),
        hint=N_("Of the load checks in the worst case; by default u."),
    ),
    Symbol(
        "ot",
        ("requirements", "over_tolerance"),
        "flag",
        choices={"1" if worst else "": text for worst, text in JUDGED.items()},
    ),
    Symbol(
        "eta",
        ("requirements", "efficiency"),
        placeholder="1",
        hint=N_("Your assumption; without one the motor side has no losses."),
    ),
    Symbol("JL", ("requirements", "load_inertia_kgm2")),
    Symbol(
        "fn", ("requirements", "natural_frequency_Hz"), hint=N_("Motor held; needs the load’s inertia or a motion.")
    ),
    Symbol("pe", ("requirements", "position_error_arcmin"), hint=N_("Accuracy, wind-up and backlash, added.")),
    Symbol("pem", ("requirements", "position_error_mm"), hint=N_("At the radius below.")),
    Symbol("pr", ("requirements", "position_radius_mm")),
    Symbol(
        "pea",
        ("requirements", "position_error_at"),
        "text",
        choices=POSITION_ERROR_AT,
        hint=N_("At rest: in phases at speed 0, dwells and the pause."),
    ),
    Symbol(
        "rf",
        ("requirements", "rest_friction_Nm"),
        placeholder="0",
        hint=N_("At the gear; holds the axis at speed 0 and in the pause."),
    ),
    Symbol(
        "lr",
        ("requirements", "load_reverses"),
        "flag",
        choices={"": N_("as the signs of the torques say"), "1": N_("both ways"), "0": N_("no torque reverses")},
    ),
    Symbol(
        "aa",
        ("application_area",),
        "text",
        choices={"": N_("none"), **AREAS},
        hint=N_("Needs a risk assessment and the manufacturer’s approval."),
    ),
    Symbol(
        "rank",
        ("rank_by",),
        "text",
        choices={code: ranking.choice for code, ranking in RANKINGS.items()},
    ),
    Symbol("nm", ("requirements", "motor", "maximum_speed_rpm")),
    Symbol("Tm", ("requirements", "motor", "peak_torque_Nm")),
    Symbol("Tmn", ("requirements", "motor", "rated_torque_Nm")),
    Symbol("nmr", ("requirements", "motor", "rated_speed_rpm")),
    Symbol("Jm", ("requirements", "motor", "inertia_kgm2")),
    Symbol("Jr", ("requirements", "motor", "inertia_ratio")),
    Symbol("md", ("requirements", "motor", "designation"), "text"),
    Symbol("Tst", ("requirements", "motor", "stall_torque_Nm")),
    Symbol("mmo", ("requirements", "motor", "weight_kg")),
    Symbol(
        "mcv",
        ("requirements", "motor", "curve"),
        "curve",
        hint=N_("A line per point: speed : continuous : peak torque; from 0."),
    ),
    Symbol("mnm", ("requirements", "motor", "name"), "text"),
)
"""Inputs except phases and motion, in the order of a canonical link: one part of an application at a time."""


def _of_mechanism(name: str, field: str, kind: Kind = "number", hint: str = "") -> Symbol:
    return Symbol(name, (*MOTION_PATH, *field.split(".")), kind, hint=hint)


MECHANISM_SYMBOLS = (
    _of_mechanism("mech", "mechanism.type", "text"),
    _of_mechanism("J", "mechanism.inertia_kgm2"),
    _of_mechanism("mg", "mechanism.gravity_mass_kg"),
    _of_mechanism("rg", "mechanism.gravity_radius_mm"),
    _of_mechanism("Tf", "mechanism.friction_torque_Nm"),
    _of_mechanism("Ff", "mechanism.friction_force_N", hint=N_("Of seals, wipers, pressed gibs: whatever the weight.")),
    _of_mechanism(
        "mc", "mechanism.counterweight_kg", hint=N_("Moves with the mass; its weight acts against the mass’s.")
    ),
    _of_mechanism("b", "mechanism.viscous_friction_Nm_per_rpm"),
    _of_mechanism("etam", "mechanism.efficiency"),
    _of_mechanism("im", "mechanism.ratio", hint=N_("Turns of the gear per turn of the mechanism.")),
    _of_mechanism("th0", "start_deg", hint=N_("Of the mass off the shaft, from the horizontal.")),
    _of_mechanism("d", "mechanism.diameter_mm"),
    _of_mechanism("h", "mechanism.lead_mm"),
    _of_mechanism("ml", "mechanism.mass_kg"),
    _of_mechanism("inc", "mechanism.incline_deg", hint=N_("If positive, positive motion raises the mass.")),
    _of_mechanism("mu", "mechanism.friction_coefficient"),
)
"""Inputs of a mechanism and of the start of its motion, in the order of a canonical link."""

FIRST_OF_MECHANISM = ("d", "h", "ml", "mc", "J", "Tf")
"""Inputs that nearly every mechanism needs, in the order of the form; the others are folded."""

_IN_FORM = (*FIRST_OF_MECHANISM, "mg", "rg", "th0", "inc", "b", "mu", "Ff", "etam", "im")

_OF_TURNING = {
    "J": N_("Of everything that turns with pinion, pulley or screw."),
    "Tf": N_("At pinion, pulley or screw, against the motion."),
}
_OF_ROTARY = {"J": N_("Of all that turns, including a mass off the shaft.")}


@cache
def mechanism_symbols(mechanism: str) -> tuple[Symbol, ...]:
    """Symbols of a mechanism besides its kind, in the order of the form, each with its default as placeholder.

    An unknown mechanism is rotary.
    """
    model = CLASSES.get(mechanism, Rotary)
    hints = _OF_ROTARY if model is Rotary else _OF_TURNING
    symbols = []
    for symbol in (BY_NAME[name] for name in _IN_FORM):
        field = model.model_fields.get(symbol.path[-1])
        if field is not None or (model is Rotary and symbol.name == "th0"):
            default = 0.0 if field is None else field.default
            text = f"{default:g}" if isinstance(default, float) else ""
            symbols.append(replace(symbol, placeholder=text, hint=hints.get(symbol.name, symbol.hint)))
    return tuple(symbols)


GROUPS = (
    FormGroup("load", N_("Loads"), ("fm", "dt", "dd", "hx", "kb", "FR", "FA", "fw", "Tk", "Nk"), folded=False),
    FormGroup("lever", N_("Where the loads act"), ("xR", "yA", "xc")),
    FormGroup(
        "wishes",
        N_("Requirements"),
        ("i", "size", "u", "rank", "Lh", "Lb", "Lbb"),
        folded=False,
        hint=N_("ratios i and sizes: none selected = all"),
    ),
    FormGroup(
        "motor", N_("Motor"), ("nm", "Tm", "Tmn", "eta", "nmr", "Jm", "Jr", "JL", "md", "mnm", "Tst", "mmo", "mcv")
    ),
    FormGroup(
        "brake",
        N_("Brake of the emergency stop"),
        ("TB", "tb", "tr", "nb", "TL", "To", "kd"),
    ),
    FormGroup(
        "stiffness",
        N_("Stiffness and position"),
        ("fn", "pe", "pem", "pr", "pea", "lr", "rf"),
    ),
    FormGroup(
        "tolerance",
        N_("Tolerance"),
        ("uw", "ot"),
        hint=N_("Counts where inputs have a tolerance."),
    ),
    FormGroup("limits", N_("Properties and environment"), ("bm", "bl", "K3", "m", "L", "ta", "aa")),
)
"""Groups of the form below its duty cycle, which includes the pause."""

BY_NAME = {symbol.name: symbol for symbol in (*SYMBOLS, *MECHANISM_SYMBOLS)}
BY_PATH = {symbol.path: symbol for symbol in (*SYMBOLS, *MECHANISM_SYMBOLS)}
COMMON_NAMES = {BY_PATH[path].name: name for name in COMMON if (path := tuple(name.split("."))) in BY_PATH}
"""Paths of values that an axis may have from its machine, by their names in links."""

_SINGLE = (*PHASE_SYMBOLS, *SYMBOLS, *MECHANISM_SYMBOLS)
LABELS = {
    **{symbol.name: symbol.named.name for symbol in (*TURN_SYMBOLS, *_SINGLE, *BODY_SYMBOLS)},
    "ms": N_("Angle or distance"),
    "mx": N_("External torque or force"),
    "gear": CANDIDATE["designation"].name,
    "tol": N_("Tolerance"),
    **{
        f"{field}{symbol.name}": symbol.named.name
        for field in ("tol_", "tols_")
        for symbol in (*TURN_SYMBOLS, *_SINGLE)
    },
    **labels.LABELS,
    **labels.OF_AXIS,
}
"""Names of the form's fields in a list of errors."""

AXIS_INPUTS = Inputs(
    *(Input(each.name, each.place.removeprefix("duty_cycle."), each.named, each.kind, each.many) for each in SYMBOLS)
)
"""Inputs that a table of axes may have as columns."""


BY_SIZE = frozenset(symbol.name for symbol in SYMBOLS if symbol.kind == "by_size")
CURVES = frozenset(symbol.name for symbol in SYMBOLS if symbol.kind == "curve")
MERGED = BY_SIZE | CURVES
"""Inputs with several numbers in one text, which may also be repeated."""


def units_of(mechanism: str) -> Mapping[str, str]:
    """Names of inputs of numbers, with the suffix of their unit; units of moves depend on the mechanism."""
    symbols = (*move_symbols(mechanism), *_SINGLE, *BODY_SYMBOLS)
    return {
        symbol.name: symbol.unit
        for symbol in symbols
        if symbol.kind in ("number", "whole", "by_size") and not symbol.many
    }

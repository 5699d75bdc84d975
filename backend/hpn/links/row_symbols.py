"""Symbols of the form's tables: a symbol for each column of phases, moves and bodies."""

from collections.abc import Collection, Iterable, Sequence

from hpn.application.phase import Phase
from hpn.links.rows import EVEN, OF_ANY_ROW, OPTIONAL, shown_columns, used_columns
from hpn.links.symbol import Symbol
from hpn.physics.motion.mechanisms import CLASSES
from hpn.physics.motion.moves import DEFAULT_JERK_SHARE
from hpn.tables.inputs import NAME, PHASE

PHASE_SYMBOLS = tuple(Symbol(each.role, (each.place,), each.kind) for each in (*PHASE, NAME))
"""Symbols of phases: repeated once per phase, all of equal length."""

_OF_A_MOVE = {"mj": f"{DEFAULT_JERK_SHARE:g}", "mx": "0"}
"""Defaults of a move."""


def _of_moves(way: str, speed: str, acceleration: str, external: str) -> tuple[Symbol, ...]:
    jerk = acceleration.replace("acceleration", "jerk").replace("s2", "s3")
    fields = ("profile", way, "time_s", speed, acceleration, "jerk_share", jerk, external)
    ramps = ("acceleration_time_s", "deceleration_time_s", acceleration.replace("acc", "dec"))
    return tuple(
        Symbol(
            name, ("motion", "move", field), "text" if name == "mv" else "number", placeholder=_OF_A_MOVE.get(name, "")
        )
        for name, field in zip(
            ("mv", "ms", "mt", "mn", "ma", "mj", *OPTIONAL["jerk"], "mx", *OPTIONAL["ramps"], *OPTIONAL["unequal"]),
            (*fields, *ramps),
            strict=True,
        )
    ) + tuple(symbol for symbol in PHASE_SYMBOLS if symbol.name in OF_ANY_ROW)


TURN_SYMBOLS = _of_moves("angle_deg", "speed_rpm", "acceleration_deg_per_s2", "external_torque_Nm")
STROKE_SYMBOLS = _of_moves("distance_mm", "speed_mm_per_s", "acceleration_mm_per_s2", "external_force_N")
"""Symbols of moves: repeated once per move, all of equal length; a move has loads and a name like a phase."""

BODY_SYMBOLS = (
    Symbol("qs", ("body", "shape"), "text"),
    Symbol("qm", ("body", "mass_kg")),
    Symbol("qr", ("body", "density_g_per_cm3")),
    Symbol("qd", ("body", "diameter_mm")),
    Symbol("qi", ("body", "inner_diameter_mm")),
    Symbol("ql", ("body", "length_mm")),
    Symbol("qw", ("body", "width_mm")),
    Symbol("qh", ("body", "height_mm")),
    Symbol("qe", ("body", "distance_mm"), placeholder="0"),
    Symbol("qn", ("body", "count"), "whole", placeholder="1"),
)
"""Symbols of bodies, from which the form calculates a moment of inertia, repeated once per body; no link has them."""


_PLACES = {
    name: k
    for k, name in enumerate((NAME.role, "mv", "ms", "mt", "mn", *OPTIONAL["ramps"], EVEN, *OPTIONAL["unequal"]))
}
"""Places in a table of columns that stand elsewhere in a link."""


def table_columns(symbols: Iterable[Symbol], groups: Collection[str]) -> list[Symbol]:
    """Columns of phases or moves in a table, the name first and the ramps of a move after its speed."""
    by_name = {symbol.name: symbol for symbol in symbols}
    columns = shown_columns(by_name, groups)
    return [by_name[name] for name in sorted(columns, key=lambda name: _PLACES.get(name, len(_PLACES)))]


def columns_used(phases: Sequence[Phase]) -> tuple[Symbol, ...]:
    """Columns of a table of phases: torque, speed and duration, and the used groups of loads and varying figures."""
    used = {s.name for s in PHASE_SYMBOLS if any(getattr(phase, s.path[0]) is not None for phase in phases)}
    return tuple(PHASE_BY_NAME[name] for name in used_columns(PHASE_BY_NAME, used))


def move_symbols(mechanism: str) -> tuple[Symbol, ...]:
    """Symbols of the moves of a mechanism; an unknown mechanism is rotary."""
    return STROKE_SYMBOLS if mechanism in CLASSES else TURN_SYMBOLS


PHASE_BY_NAME = {symbol.name: symbol for symbol in PHASE_SYMBOLS}
PHASE_BY_LEAF = {symbol.path[0]: symbol for symbol in PHASE_SYMBOLS}
BODY_BY_NAME = {symbol.name: symbol for symbol in BODY_SYMBOLS}
BODY_BY_LEAF = {symbol.path[-1]: symbol for symbol in BODY_SYMBOLS}
MOVE_BY_NAME = {symbol.name: symbol for symbol in TURN_SYMBOLS}
MOVE_BY_LEAF = {symbol.path[-1]: symbol for symbol in (*TURN_SYMBOLS, *STROKE_SYMBOLS)}

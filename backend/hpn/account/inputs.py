"""The application line by line: loads and requirements, mechanism, moves and phases."""

import itertools
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from hpn.account.lines import Kind, Line, LineTable, QuantityColumn, Value
from hpn.application import Application, CurvePoint, DutyCycle
from hpn.application.motion import Motion
from hpn.words.motion import MOTION
from hpn.words.quantities import INPUTS
from hpn.words.terms import JUDGED
from hpn.words.titles import row_label
from hpn.words.wording import N_, Named, Quantity, Sentence, listed

_LOADING = ("duty_cycle.", "emergency_stop.", "output_load.")

LOADS = tuple(path for path in INPUTS if path.startswith(_LOADING))
"""Loads of the gear besides the phases, by their paths in the application."""

REQUIREMENTS = tuple(path for path in INPUTS if not path.startswith((*_LOADING, "phase.")))
"""Requirements of the gear, likewise."""

UNSAID: Mapping[str, Value] = {
    "requirements.position_error_at": "cycle",
    "requirements.rest_friction_Nm": 0.0,
    "output_load.from_motion": False,
    "requirements.over_tolerance": False,
}
"""Inputs with a default that asks for nothing: it is not listed."""

OF_SHAFT: Mapping[str, tuple[str, ...]] = {
    "output_load.from_motion": ("rack_and_pinion", "belt"),
    "output_load.drive.type": ("rack_and_pinion", "belt"),
    "output_load.drive.diameter_mm": ("rack_and_pinion", "belt"),
    "output_load.rack_helix_deg": ("rack_and_pinion",),
    "output_load.belt_tension_factor": ("belt",),
}
"""Inputs of a pinion or pulley on the shaft -> the drives with which they count."""


def lines_of(application: Application, paths: Iterable[str]) -> list[Line]:
    """Inputs at paths of INPUTS with a value or a default; for the load, also the defaults of a phase's load."""
    values = ((path, _value(application, path)) for path in paths)
    return [_line(path, INPUTS[path], value) for path, value in values if value is not None]


def _value(application: Application, path: str) -> Any:
    if path in OF_SHAFT and application.shaft_drive not in OF_SHAFT[path]:
        return None
    first, *rest = path.split(".")
    part: Any = application.loads if first == "output_load" else getattr(application, first)
    for step in rest:
        part = getattr(part, step, None)
    return None if part == UNSAID.get(path) else part


def _line(code: str, named: Named, value: Any = None, kind: Kind = "entered") -> Line:
    if isinstance(value, tuple) and isinstance(value[0], CurvePoint):
        return Line(code, named, _points(value))
    if isinstance(value, tuple):
        return Line(code, named, ", ".join(map(str, value)))
    if isinstance(value, bool):
        return Line(code, named, JUDGED[value] if code == "requirements.over_tolerance" else str(value), kind=kind)
    return Line.entered(code, named, value, kind)


def _points(curve: Sequence[CurvePoint]) -> Sentence:
    """Points of a motor's torque curve in one text."""
    values = [
        {
            "speed": Quantity(point.speed_rpm, "rpm", 12),
            "continuous": Quantity(point.continuous_Nm, "Nm", 12),
            "peak": Quantity(point.peak_Nm, "Nm", 12),
        }
        for point in curve
    ]
    return listed(
        [Sentence(N_("{speed}: {continuous}, peak {peak}"), dict(value)) for value in values], N_("{first}; {rest}")
    )


# --- Motion -----------------------------------------------------------------------------------------------------------

_OF_MOVE = {f"motion.{at}": named for at, named in MOTION.items() if at.startswith("move.") and at != "move.name"}
_LOADS_OF_MOVE = {f"phase.{name}": INPUTS[f"phase.{name}"] for name in ("radial_N", "axial_N")}
MOVES = _OF_MOVE | _LOADS_OF_MOVE
"""Names of a move's fields, by their places; its own name stands beside its number."""

PHASES_TITLE, MOTION_TITLE, MOVES_TITLE = N_("Load phases of the motion"), N_("Motion"), N_("Moves")
PHASE_HEAD, MOVE_HEAD = N_("Phase"), N_("Move")


def mechanism_of(motion: Motion) -> list[Line]:
    """Lines of mechanism and start; a default is left out."""
    lines = []
    for path, named in MOTION.items():
        part, _, name = path.rpartition(".")
        owner: Any = motion.mechanism if part == "mechanism" else motion
        if part != "move" and _has_value(owner, name):
            lines.append(_line(f"motion.{path}", named, getattr(owner, name)))
    return lines


def moves_of(motion: Motion) -> LineTable:
    """Table of the moves, without default values, and without columns that no move sets."""
    columns = []
    for place, named in MOVES.items():
        name = place.rpartition(".")[2]
        values = [getattr(move, name) if _has_value(move, name) else None for move in motion.moves]
        if any(value is not None for value in values):
            columns.append(QuantityColumn(_line(place, named), values))
    names = [move.name for move in motion.moves]
    named_moves = QuantityColumn(_line("motion.move.name", MOTION["move.name"]), names)
    return LineTable({MOVE_HEAD: [*map(row_label, itertools.count(), names)]}, tuple(columns), named_moves)


def _has_value(owner: Any, name: str) -> bool:
    field = type(owner).model_fields.get(name)
    return field is not None and getattr(owner, name) not in (None, field.default)


# --- Phases -----------------------------------------------------------------------------------------------------------

_ALWAYS = ("torque_Nm", "speed_rpm", "duration_s")
_WHERE_GIVEN = ("peak_torque_Nm", "peak_speed_rpm", "rms_torque_Nm", "least_torque_Nm", "radial_N", "axial_N")


def phases_of(cycle: DutyCycle) -> LineTable:
    """Table of the load phases, as given or rounded from a motion; always with torque, speed and duration."""
    phases = cycle.load_phases
    kind: Kind = "entered" if cycle.motion is None else "computed"
    optional = [name for name in _WHERE_GIVEN if any(getattr(phase, name) is not None for phase in phases)]
    return LineTable(
        _labels(cycle),
        tuple(
            QuantityColumn(
                _line(f"phase.{name}", INPUTS[f"phase.{name}"], kind=kind), [getattr(phase, name) for phase in phases]
            )
            for name in (*_ALWAYS, *optional)
        ),
        QuantityColumn(_line("phase.name", INPUTS["phase.name"]), [phase.name for phase in phases]),
    )


def _labels(cycle: DutyCycle) -> Mapping[str, Sequence[str]]:
    """Number and name of each phase; for a motion the number of each phase and its move."""
    phases, motion = cycle.load_phases, cycle.motion
    if motion is None:
        return {PHASE_HEAD: [row_label(place, phase.name) for place, phase in enumerate(phases)]}
    moves = [row_label(move, motion.moves[move].name) for move in motion.course.move.tolist()]
    return {PHASE_HEAD: [str(place) for place, _ in enumerate(phases, 1)], MOVE_HEAD: moves}

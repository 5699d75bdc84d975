"""Inputs of documents as lines, by their JSON pointers and paths."""

import re
from collections.abc import Sequence
from typing import Any

from hpn.account import over_tolerance
from hpn.account.lines import Line
from hpn.account.over_tolerance import ToleranceLine
from hpn.application.input_fields import takes_tolerance
from hpn.application.tolerances import Tolerance
from hpn.links.symbols import AXIS_INPUTS
from hpn.words.quantities import QUANTITIES
from hpn.words.units import suffix_of
from hpn.words.wording import N_, Named, Sentence

_ROW = re.compile(r"(duty_cycle\.phases|duty_cycle\.motion\.moves)\.([0-9]+)(?:\.(.+))?")
_MOTION = "duty_cycle.motion."

AXIS = {
    "name": Named(N_("Name")),
    "quantity": Named(N_("Quantity")),
    "note": Named(N_("Note")),
    "ordering_code": Named(N_("Ordering code")),
    "without": Named(N_("Common values that do not hold")),
    "title": Named(N_("Title")),
    "reference": Named(N_("Reference")),
    "author": Named(N_("Author")),
    "duty_cycle": Named(N_("Duty cycle")),
    "duty_cycle.phases": Named(N_("Duty cycle")),
    "duty_cycle.motion": Named(N_("Motion")),
    "motion.moves": Named(N_("Moves")),
}
"""Names of the fields of an axis or a document outside its application, and of its duty cycle."""

COLUMNS = {each.place: each.named for each in AXIS_INPUTS.by_role.values()}
"""Names of the columns of a table of axes, which the faults of its cells name."""

PHASE, MOVE = N_("{input}, phase {number}"), N_("{input}, move {number}")
POINT = N_("{input}, point {number}")
WHOLE = N_("Phase"), N_("Move")
"""Names of a phase and of a move as a whole."""

_POINT_OF = "requirements.motor.curve"
_POINT = re.compile(r"requirements\.motor\.curve\.([0-9]{1,3})\.[A-Za-z_]+")
_TOLERANCE = re.compile(r"tolerances\.(.+?)(?:\.(minus|plus))?(?:\.(percent|absolute))?")
_SIGNS = {"minus": "−", "plus": "+", None: "±"}


def line_of(path: str, value: Any) -> Line:
    """Line of an input by its path in the application, with dots."""
    code, _ = _code_of(path)
    if tolerance := _tolerance_of(path):
        line, _, unit = tolerance
        return Line(code, line.named, value, unit)
    named = AXIS.get(code) or QUANTITIES.get(code) or Named(code)
    if path == "without" and isinstance(value, list):
        return Line(code, named, _listed(value))
    if isinstance(value, dict) and all(isinstance(each, float | int) for each in value.values()):
        return Line(code, named, value, suffix_of(code))
    if isinstance(value, list):
        return Line(code, named, ", ".join(map(str, value)) or None)
    if isinstance(value, bool):
        return Line(code, named, str(value))
    if isinstance(value, float | int | str) or value is None:
        return Line.entered(code, named, value or None if isinstance(value, str) else value)
    return Line(code, named, str(value))


def label_of(pointer: str) -> Sentence:
    """Name of an input by its pointer into an axis or document; with the number of its phase, move or curve point."""
    path = path_of(pointer)
    code, row = _code_of(path)
    named = AXIS.get(code) or QUANTITIES.get(code) or COLUMNS.get(code) or Named(code)
    if point := _POINT.fullmatch(path):
        curve = QUANTITIES[_POINT_OF].name
        return Sentence(POINT, {"input": curve, "number": int(point[1]) + 1}, ("input",))
    if tolerance := _tolerance_of(path):
        line, sign, _ = tolerance
        return Sentence("{sign} {input}", {"sign": sign, "input": line.place})
    if row is None:
        return Sentence("{text}", {"text": named.name}, ("text",))
    if path.endswith(f".{row}"):
        return Sentence("{input} {number}", {"input": WHOLE[path.startswith(_MOTION)], "number": row + 1}, ("input",))
    template = MOVE if path.startswith(_MOTION) else PHASE
    return Sentence(template, {"input": named.name, "number": row + 1}, ("input",))


def _listed(paths: Sequence[str]) -> Sentence | None:
    """Names of inputs by their paths, in one line."""
    names = {f"name_{place}": label_of(path) for place, path in enumerate(paths)}
    return Sentence("; ".join(f"{{{name}}}" for name in names), names) if names else None


def _tolerance_of(path: str) -> tuple[ToleranceLine, str, str] | None:
    """Input that a path is the tolerance of, the sides that it lies to, and its unit; None of any other path."""
    match = _TOLERANCE.fullmatch(path)
    if match is None or not takes_tolerance(match[1]):
        return None
    unit = suffix_of(match[1]) if match[3] == "absolute" else "percent" if match[3] else ""
    line = over_tolerance.line_of(match[1], Tolerance(percent=0.0))
    return line, _SIGNS[match[2]], "" if unit == "degC" else unit


def path_of(pointer: str) -> str:
    """Path of a pointer, with dots; without a first part `resolved` or `common`."""
    path = pointer.lstrip("/").replace("/", ".").replace("~1", "/").replace("~0", "~")
    return path.removeprefix("resolved.").removeprefix("common.")


def _code_of(path: str) -> tuple[str, int | None]:
    """Key of an input in `QUANTITIES`, and the index of its phase or move, from 0."""
    match = _ROW.fullmatch(path)
    if match is not None and int(match[2]) < 10**6:
        kind = "phase" if match[1].endswith("phases") else "motion.move"
        code = f"{kind}.{match[3] or 'name'}"
        return (f"phase.{match[3]}" if code not in QUANTITIES else code), int(match[2])
    return (f"motion.{path.removeprefix(_MOTION)}" if path.startswith(_MOTION) else path), None

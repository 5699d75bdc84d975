"""Inputs of documents as lines, by their JSON pointers and paths."""

import re
from typing import Any

from hpn.account.lines import Line
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
}
"""Names of the fields of an axis or a document beside its application."""

PHASE, MOVE = N_("{input}, phase {number}"), N_("{input}, move {number}")


def line_of(path: str, value: Any) -> Line:
    """Line of an input by its path in the application, with dots."""
    code, _ = _code_of(path)
    named = AXIS.get(code) or QUANTITIES.get(code) or Named(code)
    if isinstance(value, dict) and all(isinstance(each, float | int) for each in value.values()):
        return Line(code, named, value, suffix_of(code))
    if isinstance(value, list):
        return Line(code, named, ", ".join(map(str, value)) or None)
    if isinstance(value, bool):
        return Line(code, named, str(value))
    if isinstance(value, float | int | str) or value is None:
        return Line(code, named, value or None if isinstance(value, str) else value, suffix_of(code))
    return Line(code, named, str(value))


def label_of(pointer: str) -> Sentence:
    """Name of an input by its pointer into an axis or document; of a phase or move with its number."""
    path = path_of(pointer)
    code, row = _code_of(path)
    named = AXIS.get(code) or QUANTITIES.get(code) or Named(code)
    if row is None:
        return Sentence("{text}", {"text": named.name}, ("text",))
    template = MOVE if path.startswith(_MOTION) else PHASE
    return Sentence(template, {"input": named.name, "number": row + 1}, ("input",))


def path_of(pointer: str) -> str:
    """Path with dots of a pointer, without its first part where that is the application or the common values."""
    path = pointer.lstrip("/").replace("/", ".").replace("~1", "/").replace("~0", "~")
    return path.removeprefix("resolved.").removeprefix("common.")


def _code_of(path: str) -> tuple[str, int | None]:
    """Place of an input in `QUANTITIES`, and the number of its phase or move."""
    match = _ROW.fullmatch(path)
    if match is not None and int(match[2]) < 10**6:
        kind = "phase" if match[1].endswith("phases") else "motion.move"
        code = f"{kind}.{match[3] or 'name'}"
        return (f"phase.{match[3]}" if code not in QUANTITIES else code), int(match[2])
    return (f"motion.{path.removeprefix(_MOTION)}" if path.startswith(_MOTION) else path), None

"""Form of a change on the page of a machine: its fields as sent, the values in them, and its state on the page."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, Self

import msgspec

from hpn.documents.common import flat
from hpn.store import Machine, SavedAxis
from hpn.tables.files import packed, unpacked
from hpn.tables.numbers import read_value
from hpn.web.columns import common_of, json_of, own_of, without_of
from hpn.web.door.visit import current
from hpn.web.edits import Plan
from hpn.web.form import common as fields
from hpn.web.form.form import Form
from hpn.words.wording import N_, Sentence

OF_MANY = ("u", "Lh", "Lb", "fw", "size", "i")
"""Fields that can be set for several axes at once, as can their quantity."""

QUANTITY = "quantity"
MOST_UNDONE = 20
"""Number of changes that can be undone, one after the other."""

NO_VALUE = N_("Enter a value, or take the machine’s.")


@dataclass(frozen=True, slots=True)
class Command:
    """Fields of the form as sent. `seen` are the marked axes with the versions that the page showed."""

    do: str = ""
    target: str = ""
    symbol: str = "u"
    seen: Mapping[int, int] = field(default_factory=dict)
    everything: bool = False
    before: str = ""
    past: tuple[str, ...] = ()
    pairs: tuple[tuple[str, str], ...] = ()

    @classmethod
    def of(cls, pairs: Sequence[tuple[str, str]]) -> Self:
        """Values of a form's fields; malformed marks are left out."""
        texts = dict(pairs)
        marks = [text.partition(":") for name, text in pairs if name == "axis"]
        seen = {int(n): int(v) for n, _, v in marks if is_number(n) and is_number(v)}
        past = tuple(text for name, text in pairs if name == "past")[-MOST_UNDONE:]
        field_name = texts.get("field", "u")
        return cls(
            texts.get("do", ""),
            texts.get("target", ""),
            field_name if field_name in (*OF_MANY, QUANTITY) else "u",
            seen,
            "everything" in texts,
            texts.get("before", ""),
            past,
            tuple(pairs),
        )


def is_number(text: str) -> bool:
    """True for a whole number of at most 9 digits."""
    return text.isascii() and text.isdigit() and len(text) < 10


@dataclass(frozen=True)
class Editing:
    """Change on the page: its command, effect, problems, and the changes that can be undone."""

    command: Command = field(default_factory=Command)
    common: Form | None = None
    before: str = ""
    many: Form = field(default_factory=lambda: fields.form_of({}, current()))
    quantity: str = ""
    plan: Plan | None = None
    message: Sentence | None = None
    is_refused: bool = False
    overtaken: tuple[int, ...] = ()
    added: tuple[int, ...] = ()
    past: tuple[str, ...] = ()


# --- Reading ----------------------------------------------------------------------------------------------------------


def opened_common(machine: Machine) -> Editing:
    """Opened form with the present common values."""
    values = dict(flat(common_of(machine)))
    return Editing(common=fields.form_of(values, current(), has_tolerances=True), before=packed(json_of(values)))


def values_in(text: str) -> dict[str, Any]:
    """Common values that a form was opened with; empty if the text is blank or unreadable."""
    try:
        values = msgspec.json.decode(unpacked(text.encode()) or b"{}")
    except msgspec.DecodeError:
        return {}
    return values if isinstance(values, dict) else {}


def patch_in(command: Command) -> tuple[Editing, dict[str, Any] | None]:
    """Content of the page, and merge patch of the own values to set; None without a valid value."""
    if command.symbol == QUANTITY:
        text = dict(command.pairs).get(QUANTITY, "")
        value = read_value(text, "whole") if text.strip() else Sentence(NO_VALUE)
        editing = Editing(command, quantity=text)
        if isinstance(value, Sentence):
            return replace(editing, message=value, is_refused=True), None
        return editing, {QUANTITY: value}
    form, values = fields.read(command.pairs, [command.symbol], current())
    editing = Editing(command, many=form)
    if form.problems or not values:
        message = form.problems[0].message if form.problems else Sentence(NO_VALUE)
        return replace(editing, message=message, is_refused=True), None
    return editing, {"application": fields.nested(values)}


def inherited(axis: SavedAxis, name: str) -> dict[str, Any]:
    """Merge patch that makes an axis inherit the machine's value of a field."""
    path = fields.BY_SYMBOL[name][0]
    patch: dict[str, Any] = {}
    part = path.partition(".")[0]
    if own_of(axis).get(part) is not None:
        patch["application"] = fields.nested({path: None})
    if path in (without := without_of(axis)):
        patch["without"] = [each for each in without if each != path]
    return patch

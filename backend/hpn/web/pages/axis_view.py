"""Axis of a machine in the workbench: its own values, its inherited values, and its place."""

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any, NamedTuple
from urllib.parse import parse_qsl, urlencode

from pydantic import ValidationError

from hpn.account.over_tolerance import ToleranceLine, line_of
from hpn.application import Application
from hpn.catalogue import Catalogue
from hpn.catalogue.ordering import OrderingCode, ordering_code, read_ordering_code
from hpn.documents.axis import Axis
from hpn.documents.common import COMMON, Common, flat, is_common
from hpn.documents.common import TOLERANCE as COMMON_TOLERANCE
from hpn.documents.merge import Resolved, resolve
from hpn.links.row_symbols import MOVE_BY_NAME, PHASE_BY_NAME
from hpn.links.rows import TEXT, TOLERANCE
from hpn.links.symbols import BY_NAME, BY_PATH, COMMON_NAMES
from hpn.links.writer import to_link
from hpn.store import AxesOfGear, Machine, RevisionLine, SavedAxis
from hpn.tables.numbers import read_value
from hpn.web.columns import common_of, own_of, without_of
from hpn.web.door.visit import current
from hpn.web.form import link_reader
from hpn.web.form.common import OF_TOLERANCE, form_of
from hpn.web.form.form import Form
from hpn.web.form.own_part import carried_over, pairs_of_own, written
from hpn.web.form.query import FIRST_TOLERANCE, FieldProblem, Pairs
from hpn.web.form.refusals import refusal_of
from hpn.web.form.tolerance_fields import EXACT, INPUT_OF
from hpn.web.pages.revisions_view import MOST_REVISIONS
from hpn.words.wording import Sentence

Json = dict[str, Any]

WITHOUT, VERSION, OPENED, PLACE, EDIT = "wo", "v", "opened", "axis", "edit"
LABELS = ("name", "quantity", "note")
OF_AXIS = frozenset((WITHOUT, VERSION, OPENED, PLACE, EDIT, *LABELS))
"""Parameters of an axis beside those of its application: common values that it leaves out, its labels, its version and
own part when it was opened, its identity for other pages, and the step that asks for the key.
"""

CHOSEN = ("gear", "order_output", "order_motor")
"""Parameters that make an axis's ordering code."""

_OWN = {*PHASE_BY_NAME, *MOVE_BY_NAME, *BY_NAME, TEXT, TOLERANCE, WITHOUT}
_PRESS = re.compile(r"(without|common):([A-Za-z0-9]{1,8}|tolerances\.[A-Za-z0-9_.]{1,100})")


@dataclass(frozen=True, slots=True)
class Neighbours:
    """Axes before and after an axis in the order of its machine; None at its ends."""

    previous: SavedAxis | None = None
    next: SavedAxis | None = None


class CommonTolerance(NamedTuple):
    """Tolerance of the machine, and reasons why it doesn't apply to an axis: left out, not asked, own tolerance."""

    path: str
    line: ToleranceLine
    is_left: bool
    is_not_asked: bool
    is_own: bool


@dataclass(frozen=True)
class AxisView:
    """Axis with typed inputs.

    `labels` are name, quantity and note as typed, `own` is its own part, and `without` are the names of common values
    that don't apply to it. `typed` holds these and the ordering code as pairs. `opened` holds the pairs of the axis
    when it was opened, None if unknown; `version` is its version then. `may_change` is False for a reader who may not
    save it. `gears` are those of the machine's other axes, `revisions` those of the machine, the latest first.
    """

    machine: Machine
    axis: SavedAxis
    neighbours: Neighbours
    labels: Mapping[str, str]
    own: Json
    resolved: Resolved
    without: tuple[str, ...]
    typed: tuple[tuple[str, str], ...]
    opened: tuple[tuple[str, str], ...] | None
    version: int
    may_change: bool = True
    gears: Mapping[str, AxesOfGear] = field(default_factory=dict, repr=False)
    revisions: Sequence[RevisionLine] = ()

    most_revisions = MOST_REVISIONS

    @property
    def place(self) -> str:
        """Address of the axis's page."""
        return place_of(self.machine.id, self.axis.number)

    @property
    def document(self) -> str:
        """Address of the document whose revisions have the axis."""
        return f"/{self.machine.kind}s/{self.machine.id}"

    @property
    def row(self) -> str:
        """Place of the axis on the page of a revision: its row in a machine."""
        return f"#axis-{self.axis.number}" if self.machine.kind == "machine" else ""

    @property
    def key(self) -> str:
        """Identity of the axis in a form's hidden field: ids of machine and axis."""
        return f"{self.machine.id}/{self.axis.number}"

    @property
    def at(self) -> int:
        """Place of the axis in the order, from 1."""
        return self.machine.order.index(self.axis.number) + 1

    @property
    def common(self) -> Mapping[str, Any]:
        """Common values of the machine by the names of links."""
        symbols = ((BY_PATH.get(tuple(path.split("."))), value) for path, value in flat(common_of(self.machine)))
        return {symbol.name: _choice(value) for symbol, value in symbols if symbol}

    @property
    def common_tolerances(self) -> list[CommonTolerance]:
        """Common tolerances of the machine, each with the reasons why it doesn't apply."""
        own = self.own.get("tolerances") or {}
        return [
            CommonTolerance(
                path, line_of(name, each), path in self.without, path in self.resolved.not_asked, name in own
            )
            for name, each in (Common.model_validate(common_of(self.machine)).tolerances or {}).items()
            for path in [f"{COMMON_TOLERANCE}{name}"]
        ]

    @cached_property
    def tolerances(self) -> Mapping[str, str]:
        """Tolerances inherited from the machine, in the notation of fields, by the names of fields."""
        absent = {each.path for each in self.common_tolerances if each.is_left or each.is_not_asked}
        values = {path: value for path, value in flat(common_of(self.machine)) if path not in absent}
        texts = form_of(values, current(), has_tolerances=True).texts
        return {field: texts[field] for field in OF_TOLERANCE if field in texts}

    @property
    def paths(self) -> tuple[str, ...]:
        """Paths of the common values that don't apply to the axis."""
        return tuple(path for name in self.without if (path := _path_of(name)))

    @property
    def is_changed(self) -> bool:
        """True if the axis differs from its state when it was opened."""
        return self.typed != self.opened

    @property
    def overtaken(self) -> bool:
        """True if somebody else has saved the axis since."""
        return self.version != self.axis.version

    @property
    def opened_text(self) -> str:
        """Pairs of the axis when it was opened, for a form or an address."""
        return "" if self.opened is None else urlencode(self.opened)

    def link(self, application: Application) -> str:
        """Address of the axis with another whole application, without gear, pins and ordering code."""
        own = [pair for pair in self.typed if pair[0] not in (*CHOSEN, *LABELS)]
        if application != self.resolved.application and self.resolved.application is not None:
            now, then = (_pairs(to_link(each)) for each in (self.resolved.application, application))
            own = carried_over(now, then, own, self.common)
        return self._link_of(own)

    @property
    def open_link(self) -> str:
        """Address of an axis that is still open, without gear, pins and ordering code."""
        return self._link_of([pair for pair in self.typed if pair[0] not in (*CHOSEN, *LABELS)])

    def _link_of(self, own: Pairs) -> str:
        labels = [pair for pair in self.typed if pair[0] in LABELS]
        since = [(VERSION, str(self.version)), (OPENED, self.opened_text)]
        return f"{self.place}?{written([*own, *labels, *since])}"

    def address(self, link: str, tail: str) -> str:
        """Address for the address bar; without a query for an axis in its stored state."""
        as_stored = not self.is_changed and not self.overtaken and "&pin=" not in tail
        return self.place if as_stored else link + tail


def place_of(id: str, number: int) -> str:
    """Address of the page of an axis."""
    return f"/machines/{id}/axes/{number}"


def stored_pairs(axis: SavedAxis, catalogue: Catalogue) -> tuple[tuple[str, str], ...]:
    """Pairs of a stored axis."""
    labels = {"name": axis.name or "", "quantity": str(axis.quantity), "note": axis.note or ""}
    names = [symbol.name if (symbol := BY_PATH.get(tuple(path.split(".")))) else path for path in without_of(axis)]
    code = read_ordering_code(catalogue, axis.ordering_code or "")
    chosen = {"gear": code.gear.designation, **code.labels} if isinstance(code, OrderingCode) else {}
    return _state(pairs_of_own(own_of(axis)), names, labels, chosen)


def _state(
    own: Pairs, without: Sequence[str], labels: Mapping[str, str], chosen: Mapping[str, str]
) -> tuple[tuple[str, str], ...]:
    pairs_left_out = [(WITHOUT, name) for name in sorted(without)]
    named = [(name, labels[name]) for name in LABELS if labels[name]]
    ordered = [(name, chosen[name]) for name in CHOSEN if chosen.get(name)]
    return (*own, *pairs_left_out, *named, *ordered)


def view_of(
    machine: Machine, axis: SavedAxis, neighbours: Neighbours, pairs: Pairs, catalogue: Catalogue
) -> tuple[Form, AxisView]:
    """Form and axis with the inputs of a query; with the stored inputs if the query has none of the axis's own."""
    stored = stored_pairs(axis, catalogue)
    if not any(name in _OWN for name, _ in pairs):
        pairs = [*(pair for pair in stored if pair[0] not in dict(pairs)), *pairs]
    pairs, focus = _pressed(pairs)
    if common_of(machine).get("tolerances"):  # they have fields, and count even if the axis's own don't
        pairs = [pair for pair in pairs if pair[0] != EXACT]
        pairs += [] if any(name in INPUT_OF or name == TOLERANCE for name, _ in pairs) else [(FIRST_TOLERANCE, "")]
    texts = dict(reversed(pairs))
    without = tuple(dict.fromkeys(text for name, text in pairs if name == WITHOUT and _path_of(text)))
    labels = {name: texts.get(name, dict(stored).get(name, "")).strip() for name in LABELS}
    paths = [path for name in without if (path := _path_of(name))]
    seen: list[tuple[Json, Resolved]] = []

    def whole(document: Json) -> Json:
        own = _without_blanks(document)
        seen[:] = [(own, resolve(own, common_of(machine), paths))]
        return dict(seen[0][1].whole) or document

    form = link_reader.parse([pair for pair in pairs if pair[0] not in OF_AXIS], whole)
    own, resolved = seen[0]
    form = replace(form, focus=focus or form.focus, problems=(*form.problems, *_faults(labels)))
    chosen = {"gear": form.gear, **_ordered(form, catalogue)}
    version = int(texts[VERSION]) if re.fullmatch(r"[0-9]{1,9}", texts.get(VERSION, "")) else axis.version
    opened = stored if version == axis.version else _pairs_in(texts.get(OPENED, ""))
    typed = _state(pairs_of_own(own), without, labels, chosen)
    return form, AxisView(machine, axis, neighbours, labels, own, resolved, without, typed, opened, version)


def _ordered(form: Form, catalogue: Catalogue) -> Mapping[str, str]:
    """Labels of the ordering code as typed; the default version of the output counts as blank."""
    return ordering_code(catalogue, catalogue.gears[0], *(form.labels[name] for name in CHOSEN[1:])).labels


def _path_of(name: str) -> str | None:
    """Path of a common value by its symbol, or of a tolerance by its path; None for any other text."""
    return COMMON_NAMES.get(name) or (name if name not in COMMON and is_common(name) else None)


def _pairs_in(text: str) -> tuple[tuple[str, str], ...] | None:
    return tuple(parse_qsl(text, keep_blank_values=True, max_num_fields=None)) or None


def _pressed(pairs: Pairs) -> tuple[Pairs, str | None]:
    """Pairs after the buttons of common values were applied, and the field to focus."""
    focus = None
    for _, text in [pair for pair in pairs if pair[0] == "do"]:
        if (press := _PRESS.fullmatch(text)) and (field := _field_of(press[2])):
            name, focus = press[2], f"f-{field}"
            pairs = [pair for pair in pairs if pair != ("do", text) and pair[0] != field and pair != (WITHOUT, name)]
            pairs += [(WITHOUT, name)] if press[1] == "without" else []
    return pairs, focus


def _field_of(name: str) -> str | None:
    """Name of the field of a common value, or of a tolerance by its path; None for any other text."""
    if name in BY_NAME:
        return name
    return next((field for field, path in OF_TOLERANCE.items() if path == name), name if is_common(name) else None)


def _choice(value: Any) -> Any:
    """Common value in the form of a field's choices."""
    return str(int(value)) if isinstance(value, bool) else value


def _without_blanks(document: Json) -> Json:
    """Own part of an axis, without blank values, which are inherited."""
    own = {name: value for name, value in document.items() if value not in (None, {}, [])}
    for name, part in own.items():
        if isinstance(part, dict):
            own[name] = {field: value for field, value in part.items() if value not in (None, [])}
    return {name: value for name, value in own.items() if value != {}}


def values_of(labels: Mapping[str, str]) -> Axis:
    """Labels of an axis as typed; ValidationError for an invalid one."""
    quantity = read_value(labels["quantity"] or "1", "whole")
    return Axis.model_validate({"name": labels["name"] or None, "note": labels["note"] or None, "quantity": quantity})


def _faults(labels: Mapping[str, str]) -> list[FieldProblem]:
    if isinstance(quantity := read_value(labels["quantity"] or "1", "whole"), Sentence):
        return [FieldProblem("quantity", None, quantity)]
    try:
        values_of(labels)
    except ValidationError as refused:
        errors = refused.errors(include_url=False, include_input=False)
        return [FieldProblem(str(error["loc"][0]), None, refusal_of(error)) for error in errors]
    return []


def _pairs(link: str) -> Pairs:
    return parse_qsl(link.partition("?")[2], keep_blank_values=True)

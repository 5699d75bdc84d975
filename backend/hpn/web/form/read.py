"""Links and the form: from the symbols of a query to the application model.

The form, the address bar and every link that somebody writes by hand go through `parse`; `write.to_link` is the way
back. Names are the handbook's symbols, values are in the units of the API.
"""

import difflib
import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any
from urllib.parse import urlencode

from pydantic import ValidationError

from hpn.application import MOST_WISHES, Application
from hpn.phase import MAXIMUM_PHASES
from hpn.reader import Reader
from hpn.units import suffix_of
from hpn.web.door.access import MAXIMUM_QUERY_BYTES as MAXIMUM_QUERY_BYTES
from hpn.web.form import numbers
from hpn.web.form.labels import LABELS, faults_of, query_of
from hpn.web.form.numbers import WAS, WRITTEN, read_value
from hpn.web.form.symbols import (
    BY_NAME,
    BY_PATH,
    PHASE_BY_LEAF,
    PHASE_BY_NAME,
    PHASE_SYMBOLS,
    SYMBOLS,
    UNITS,
    Symbol,
)
from hpn.wording import N_, Quantity, Sentence

Pairs = Sequence[tuple[str, str]]

PAGE_NAMES = ("gear", "pin", "unpin", "do", WRITTEN, WAS)
"""Parameters of the page alone: the candidate looked at, those pinned beside it (repeated), one to take away, and
the buttons that edit the rows, one after the other."""

ROWS_IN_TABLE = 100
"""A longer duty cycle is edited as text: a field for each of its figures would weigh megabytes."""

_UNSEEN = re.compile("[\u00ad\u200b-\u200d\u2060\ufeff]")
"""Characters without width, which come with links copied from documents that break their lines with them."""

_REQUIRED = ("T", "n", "t")
_LOADS = ("FRi", "FAi")
# Where an error of a whole part of the model is shown.
_PARTS = {("duty_cycle",): "T", ("duty_cycle", "phases"): "T", ("output_load",): "FR", ("emergency_stop",): "Tk"}


@dataclass(frozen=True)
class FieldProblem:
    """What is wrong with one input: the query name and, for a repeated one, which of its values."""

    name: str
    index: int | None
    message: Sentence

    @property
    def of_phase(self) -> bool:
        """Whether the input stands in the duty table."""
        return self.name in PHASE_BY_NAME

    @property
    def place(self) -> str:
        """Element of the page that takes this input."""
        return f"{self.name}-{self.index}" if self.of_phase else f"f-{self.name}"


@dataclass(frozen=True)
class Form:
    """A query as given, and the application it describes, or why it describes none.

    `origins` are the places at which the rows of the duty table stood before the buttons that edit it.
    """

    rows: tuple[Mapping[str, str], ...]
    origins: tuple[int | None, ...]
    texts: Mapping[str, str]
    lists: Mapping[str, tuple[str, ...]]
    with_loads: bool = False
    gear: str = ""
    pins: tuple[str, ...] = ()
    focus: str | None = None
    problems: tuple[FieldProblem, ...] = ()
    application: Application | None = None
    written: str = ""
    was: str = ""
    typed: str | None = None
    labels: Mapping[str, str] = field(default_factory=lambda: dict.fromkeys(LABELS, ""))

    @property
    def long(self) -> bool:
        """Whether the duty cycle is edited as text instead of in a table."""
        return len(self.rows) > ROWS_IN_TABLE

    @property
    def text(self) -> str:
        """The duty cycle as text, one phase per line: as typed, if it was."""
        return "\n".join("\t".join(row.values()) for row in self.rows) if self.typed is None else self.typed

    @property
    def empty(self) -> bool:
        """Nobody has filled in a phase yet: neither an application nor an error."""
        return self.application is None and not self.problems

    def messages(self, name: str, index: int | None = None) -> list[Sentence]:
        """What is wrong with one input."""
        return [problem.message for problem in self.problems if (problem.name, problem.index) == (name, index)]


def address_of_empty(form: Form) -> str:
    """Address of a form without a phase, with all else that it says."""
    lists = [(name, text) for name, texts in form.lists.items() for text in texts]
    given = [(name, text) for name, text in (*form.texts.items(), *lists) if text.strip()]
    return "/?" + urlencode([("T", ""), ("n", ""), ("t", ""), *given]) + query_of(form.labels)


def parse(pairs: Pairs) -> Form:
    """Read a query. Whatever it says, the form comes back with it and with a message beside each wrong field."""
    pairs, written = in_wire_units(pairs)
    given = _Given()
    for name, text in pairs:
        given.add(name, text)
    rows, focus = given.edited()
    problems = [*given.problems(), *_list_problems(given)]
    application = None
    if not _untouched(given, rows):
        document, found = _document(rows, given)
        problems += found
        application, refused = _validated(document, rows, problems)
        problems += refused
    return Form(
        rows=tuple(rows),
        origins=given.origins,
        texts={name: texts[0] for name, texts in given.scalars.items()},
        lists={name: tuple(texts) for name, texts in given.lists.items()},
        with_loads=given.with_loads,
        gear=given.page.get("gear", "").strip(),
        pins=given.pinned(),
        focus=focus,
        problems=tuple(problems),
        application=None if problems else application,
        written=written,
        labels={name: given.labels.get(name, [""])[0] for name in LABELS},
    )


def in_wire_units(pairs: Pairs) -> tuple[Pairs, str]:
    """Pairs of a form as a link has them, and the marker of what they were written in: see `numbers`."""
    # In the texts of people such characters join emoji and letters.
    seen = [(_UNSEEN.sub("", name), text if name in LABELS else _UNSEEN.sub("", text)) for name, text in pairs]
    return numbers.to_wire(seen, UNITS)


def for_reader(form: Form, reader: Reader) -> Form:
    """The same form with what the reader's fields show: their units and decimal mark."""
    cells = [(text, UNITS[name]) for row in form.rows for name, text in row.items()]
    named = {name: text for name, text in form.texts.items() if name in UNITS}
    shown = numbers.to_fields([*cells, *((text, UNITS[name]) for name, text in named.items())], reader, form.written)
    texts = iter(shown.texts)
    rows = tuple({name: next(texts) for name in row} for row in form.rows)
    return replace(
        form,
        rows=rows,
        texts={**form.texts, **{name: next(texts) for name in named}},
        written=reader.marker,
        was=shown.was,
    )


_Placed = tuple[int | None, dict[str, str]]
"""A row of the duty table, and where it stood before the buttons that edit it."""


class _Given:
    """A query sorted into phases, scalars, lists and what belongs to the page."""

    def __init__(self) -> None:
        self.columns: dict[str, list[str]] = {}
        self.scalars: dict[str, list[str]] = {}
        self.lists: dict[str, list[str]] = {}
        self.labels: dict[str, list[str]] = {}
        self.page: dict[str, str] = {}
        self.presses: list[str] = []
        self.pins: list[str] = []
        self.unknown: list[str] = []
        self.with_loads = False
        self.origins: tuple[int | None, ...] = (None,)

    def add(self, name: str, text: str) -> None:
        """Take one pair of the query."""
        if name in PHASE_BY_NAME:
            self.columns.setdefault(name, []).append(text)
        elif name == "do":
            self.presses.append(text)
        elif name == "pin":
            self.pins += [text.strip()] if text.strip() else []
        elif name in PAGE_NAMES:
            self.page[name] = text
        elif name in LABELS:
            self.labels.setdefault(name, []).append(text)
        elif name not in BY_NAME:
            self.unknown.append(name)
        elif text.strip():  # the plain form submits blank fields too: they count as absent
            texts = (self.lists if BY_NAME[name].many else self.scalars).setdefault(name, [])
            if len(texts) <= MOST_WISHES:  # one more than there may be is enough to refuse them
                texts.append(text)

    def edited(self) -> tuple[list[dict[str, str]], str | None]:
        """Rows of the duty table after the buttons that were pressed, and the element to go on from."""
        self.with_loads = any(name in self.columns for name in _LOADS)
        length = max((len(texts) for texts in self.columns.values()), default=0)
        shown = self._shown()
        placed: list[_Placed] = [
            (k, {name: texts[k] if k < len(texts := self.columns.get(name, [])) else "" for name in shown})
            for k in range(min(length, MAXIMUM_PHASES + 1))
        ]
        focus = None
        for press in self.presses[:50]:
            focus = self._press(press, placed)
        placed = placed or [(None, dict.fromkeys(self._shown(), ""))]
        self.origins = tuple(origin for origin, _ in placed)
        return [row for _, row in placed], focus

    def _shown(self) -> list[str]:
        return [name for name in PHASE_BY_NAME if name in _REQUIRED or self.with_loads]

    def _press(self, press: str, placed: list[_Placed]) -> str | None:
        """Edit the rows as one button does; the element to go on from, if it does anything."""
        do, _, number = press.partition(":")
        k = int(number) - 1 if re.fullmatch(r"[0-9]{1,5}", number) else -1
        if do == "add":
            placed.append((None, dict.fromkeys(self._shown(), "")))
            return f"T-{len(placed) - 1}"
        if do == "loads":
            self.with_loads = not self.with_loads
            placed[:] = [(origin, {name: row.get(name, "") for name in self._shown()}) for origin, row in placed]
            return "loads"
        if not 0 <= k < len(placed):
            return None
        if do == "remove":
            del placed[k]
            return f"T-{min(k, max(len(placed) - 1, 0))}"
        if do in ("up", "down"):
            to = min(max(k + (1 if do == "down" else -1), 0), len(placed) - 1)
            placed.insert(to, placed.pop(k))
            # At either end the way on is back.
            onward = do if 0 < to < len(placed) - 1 else "down" if to == 0 else "up"
            return f"{onward}-{to}"
        return None

    def pinned(self) -> tuple[str, ...]:
        """Pinned gears, without the one whose button takes it away."""
        return tuple(pin for pin in self.pins if pin != self.page.get("unpin"))

    def problems(self) -> Iterable[FieldProblem]:
        """Names that are unknown, repeated, or repeated unequally often."""
        for name in self.unknown[:20]:
            yield FieldProblem(name[:60], None, _unknown(name))
        for name, texts in (*self.scalars.items(), *self.labels.items()):
            if len(texts) > 1:
                listed = ", ".join(text.strip()[:20] for text in texts[:5])
                yield FieldProblem(name, None, Sentence(N_("takes one value, given were {texts}"), {"texts": listed}))
        for name, texts in self.labels.items():
            yield from (FieldProblem(name, None, fault) for fault in faults_of(texts[0]))
        if self.columns and not self.presses:
            yield from self._unequal()

    def _unequal(self) -> Iterable[FieldProblem]:
        counts = {name: len(self.columns.get(name, [])) for name in (*_REQUIRED, *self.columns)}
        longest = max(counts, key=lambda name: counts[name])
        for name, count in counts.items():
            if count < counts[longest]:
                values = {"count": str(count), "name": name, "most": str(counts[longest]), "longest": longest}
                template = N_("missing: the link gives {count} × {name}, but {most} × {longest}")
                yield FieldProblem(name, min(count, MAXIMUM_PHASES), Sentence(template, values))


def _unknown(name: str) -> Sentence:
    leaves = {s.path[-1].lower(): s.name for s in (*SYMBOLS, *PHASE_SYMBOLS)}
    names = {known.lower(): known for known in (*PHASE_BY_NAME, *BY_NAME, *PAGE_NAMES, *LABELS)}
    near = difflib.get_close_matches(name[:60].lower(), leaves | names, n=1, cutoff=0.4)
    if not near:
        return Sentence(N_("{name} is not a parameter of this page"), {"name": name[:60]})
    values = {"name": name[:60], "near": (leaves | names)[near[0]]}
    return Sentence(N_("{name} is not a parameter of this page; did you mean {near}?"), values)


def _list_problems(given: _Given) -> Iterable[FieldProblem]:
    for name, texts in given.lists.items():
        for k, text in enumerate(texts):
            if BY_NAME[name].kind != "text" and isinstance(message := read_value(text, "whole"), Sentence):
                yield FieldProblem(name, k, message)


def _untouched(given: _Given, rows: list[dict[str, str]]) -> bool:
    """The form was sent with its duty table still blank."""
    return all(name in given.columns for name in _REQUIRED) and not any(map(_filled, rows))


def _filled(row: Mapping[str, str]) -> bool:
    return any(text.strip() for text in row.values())


def _document(rows: Sequence[Mapping[str, str]], given: _Given) -> tuple[dict[str, Any], list[FieldProblem]]:
    """Nested input of the application model; what can't be read is left out and reported."""
    problems: list[FieldProblem] = []
    phases: list[dict[str, Any]] = []
    for k, row in enumerate(rows):
        if _filled(row):
            phase: dict[str, Any] = {}
            phases.append(phase)
            for name, text in row.items():
                _put(phase, PHASE_BY_NAME[name], text, FieldProblem(name, k, Sentence("")), problems)
    document: dict[str, Any] = {"duty_cycle": {"phases": phases}}
    for name, texts in given.scalars.items():
        _put(document, BY_NAME[name], texts[0], FieldProblem(name, None, Sentence("")), problems)
    for name, texts in given.lists.items():
        values = [value for text in texts if not isinstance(value := read_value(text, BY_NAME[name].kind), Sentence)]
        document.setdefault(BY_NAME[name].path[0], {})[BY_NAME[name].path[1]] = values or None
    return document, problems


def _put(
    document: dict[str, Any], symbol: Symbol, text: str, place: FieldProblem, problems: list[FieldProblem]
) -> None:
    if not text.strip():
        return
    value = read_value(text, symbol.kind)
    if isinstance(value, Sentence):
        problems.append(FieldProblem(place.name, place.index, value))
        return
    for step in symbol.path[:-1]:
        document = document.setdefault(step, {})
    document[symbol.path[-1]] = value


def _validated(
    document: dict[str, Any], rows: Sequence[Mapping[str, str]], known: Sequence[FieldProblem]
) -> tuple[Application | None, list[FieldProblem]]:
    kept = [k for k, row in enumerate(rows) if _filled(row)] or [0]
    places = {(problem.name, problem.index) for problem in known}
    try:
        return Application.model_validate(document), []
    except ValidationError as refusal:
        errors = refusal.errors(include_url=False, include_input=False)
    problems = []
    for error in errors:
        name, index = place_of(error["loc"], kept)
        if error["type"] == "no_motion":
            name = "n"
        # What could not be read was left out of the model, which then misses it, or the whole that it belongs to.
        consequence = known and error["type"] in ("no_motion", "no_load")
        refused_phases = error["type"] == "too_short" and any(map(_filled, rows))
        if (name, index) not in places and not consequence and not refused_phases:
            problems.append(FieldProblem(name, index, _refusal(error)))
    return None, problems


def place_of(location: Sequence[int | str], rows: Sequence[int] = ()) -> tuple[str, int | None]:
    """Query name and index of a location in the application model; `rows` are the rows that became phases."""
    path = tuple(step for step in location if isinstance(step, str))
    index = next((step for step in location if isinstance(step, int)), None)
    if path[:2] == ("duty_cycle", "phases"):
        name = PHASE_BY_LEAF[path[2]].name if len(path) > 2 and path[2] in PHASE_BY_LEAF else "T"
        k = index or 0
        return name, rows[k] if k < len(rows) else k
    if path in BY_PATH:
        return BY_PATH[path].name, index
    return _PARTS.get(path, ".".join(path)), None


_BOUNDS = {
    "greater_than": (N_("must be above {bound}"), "gt"),
    "greater_than_equal": (N_("must be at least {bound}"), "ge"),
    "less_than": (N_("must be below {bound}"), "lt"),
    "less_than_equal": (N_("must be at most {bound}"), "le"),
}


def _refusal(error: Any) -> Sentence:
    """Text for one error of the model."""
    context = error.get("ctx", {})
    if error["type"] in _BOUNDS:
        template, key = _BOUNDS[error["type"]]
        return Sentence(template, {"bound": Quantity(context[key], suffix_of(str(error["loc"][-1])) or "", 12)})
    if error["type"] == "no_load":
        return Sentence(N_("give a radial or an axial load, here or in a phase"))
    if error["type"] in ("missing", "too_short"):
        return Sentence(N_("is missing"))
    if error["type"] == "too_long":
        return Sentence(N_("takes at most {bound} values"), {"bound": str(context["max_length"])})
    if error["type"] == "literal_error":
        return Sentence(N_("must be one of {expected}"), {"expected": context["expected"].replace("'", "")})
    return Sentence("{text}", {"text": error["msg"]}, ("text",))

"""Links and the form: from the symbols of a query to the application model.

The form, the address bar and every link that somebody writes by hand go through `parse`; `link_writer.to_link` is the
way back. Names are the handbook's symbols, values are in the units of the API.
"""

import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any
from urllib.parse import urlencode

from pydantic import ValidationError

from hpn.application import Application
from hpn.physics.motion.mechanisms import TYPES
from hpn.tables import numbers
from hpn.tables.inputs import NAME
from hpn.tables.numbers import read_value
from hpn.web.door.access import MAXIMUM_QUERY_BYTES as MAXIMUM_QUERY_BYTES
from hpn.web.form.given import REQUIRED, FieldProblem, Given
from hpn.web.form.helpers import BeltInput, BodyTable, belt_of, body_table, with_figures
from hpn.web.form.labels import LABELS, query_of
from hpn.web.form.offers import with_offers
from hpn.web.form.refusals import refusal_of
from hpn.web.form.rows import TEXT, WIDTHS, expanded, filled
from hpn.web.form.symbols import (
    BY_NAME,
    BY_PATH,
    MECHANISM_SYMBOLS,
    MOTION_PATH,
    MOVE_BY_LEAF,
    PHASE_BY_LEAF,
    PHASE_BY_NAME,
    PHASE_SYMBOLS,
    Symbol,
    mechanism_symbols,
    move_symbols,
    table_columns,
    units_of,
)
from hpn.web.form.ways import CYCLE_NAMES, START, switched, taken_over
from hpn.words.reader import Reader
from hpn.words.titles import LONGEST_NAME, faults_of, numbered
from hpn.words.wording import N_, Sentence

Pairs = Sequence[tuple[str, str]]

ROWS_IN_TABLE = 100
"""A longer duty cycle is edited as text: a field for each of its figures would weigh megabytes."""

LONGEST_ASIDE = 8_000
"""Characters of what was typed another way that still fit an address."""

_UNSEEN = re.compile("[\u00ad\u200b-\u200d\u2060\ufeff]")
"""Characters without width, which come with links copied from documents that break their lines with them."""

_OF_TWO_PHASES = re.compile(r"([1-9][0-9]{1,4}),([1-9][0-9]{1,4})")
"""Two values as likely as a number with decimals: `40,32`, which `9,3` is not."""

_SEVERAL = re.compile(r"(?![0-9]+,0+$)[0-9]{1,5}([\s,;/]+[0-9]{1,5}){1,10}")
"""Several whole numbers in one text; `5,0` is one."""

# Inputs beside which an error of a whole part of the model is shown.
_PARTS = {
    ("duty_cycle",): "T",
    ("duty_cycle", "phases"): "T",
    MOTION_PATH: "mech",
    (*MOTION_PATH, "mechanism"): "mech",
    ("output_load",): "FR",
    ("emergency_stop",): "Tk",
    ("emergency_stop", "brake"): "TB",
}

_TABLES = (
    (("duty_cycle", "phases"), PHASE_BY_LEAF, "T"),
    ((*MOTION_PATH, "moves"), MOVE_BY_LEAF, "mv"),
)
"""Tables of the model, their inputs by field, and the input beside which any other error of a row is shown."""


@dataclass(frozen=True)
class Form:
    """A query as given, and the application it describes, or why it describes none.

    `origins` are the places at which the rows of the duty table stood before the buttons that edit it. Of a motion the
    mechanism stands in `texts`, and `moves` has a row per move; `bodies` are what its moment of inertia may be worked
    out from. `asides` are the inputs of other ways to give the cycle. `written` is the marker of the language and units
    in which a form was filled in; None for a link.
    """

    rows: tuple[Mapping[str, str], ...]
    origins: tuple[int | None, ...]
    texts: Mapping[str, str]
    lists: Mapping[str, tuple[str, ...]]
    moves: tuple[Mapping[str, str], ...] = ()
    has_motion: bool = False
    bodies: BodyTable = field(default_factory=BodyTable)
    belt: BeltInput = field(default_factory=BeltInput)
    asides: tuple[str, ...] = ()
    shown: frozenset[str] = frozenset()
    gear: str = ""
    pins: tuple[str, ...] = ()
    focus: str | None = None
    problems: tuple[FieldProblem, ...] = ()
    application: Application | None = None
    written: str | None = None
    was: str = ""
    typed: str | None = None
    labels: Mapping[str, str] = field(default_factory=lambda: dict.fromkeys(LABELS, ""))

    @property
    def as_text(self) -> bool:
        """True where the duty cycle is edited as text instead of in a table."""
        return len(self.rows) > ROWS_IN_TABLE

    @property
    def long(self) -> bool:
        """True where the form is posted, since it may be too long for an address."""
        return self.as_text or self.moves_are_hidden or sum(map(len, self.asides)) > LONGEST_ASIDE

    @property
    def moves_are_hidden(self) -> bool:
        """True where there are more moves than the page has fields for."""
        return len(self.moves) > ROWS_IN_TABLE

    @property
    def has_both(self) -> bool:
        """True where phases are given beside a motion, which is refused."""
        return self.has_motion and any(map(filled, self.rows))

    @property
    def mechanism(self) -> str:
        """Kind of mechanism that moves."""
        given = self.texts.get("mech", "").strip()
        return given if given in TYPES else TYPES[0]

    @property
    def mechanism_symbols(self) -> tuple[Symbol, ...]:
        """Inputs of the mechanism: its own, and any other that is given, which is refused where it stands."""
        own = mechanism_symbols(self.mechanism)
        names = {"mech", *(symbol.name for symbol in own)}
        return (*own, *(symbol for symbol in MECHANISM_SYMBOLS if symbol.name in self.texts.keys() - names))

    @property
    def columns(self) -> list[Symbol]:
        """Columns of the table of phases."""
        return table_columns(PHASE_SYMBOLS, self.shown)

    @property
    def move_columns(self) -> list[Symbol]:
        """Columns of the table of moves."""
        return table_columns(move_symbols(self.mechanism), self.shown)

    def row(self, problem: FieldProblem) -> str:
        """Number of the row that a problem is in, with its name where it has one."""
        at = problem.index or 0
        rows = self.moves if self.has_motion and not self.has_both else self.rows
        return numbered(at, rows[at].get(NAME.role, "").strip() if at < len(rows) else "")

    @property
    def text(self) -> str:
        """The duty cycle as text, one phase per line: as typed, if it was."""
        columns = PHASE_SYMBOLS[: next((width for group, width in WIDTHS.items() if group in self.shown), 3)]
        lines = ("\t".join(row.get(symbol.name, "") for symbol in columns) for row in self.rows)
        return "\n".join(lines) if self.typed is None else self.typed

    @property
    def empty(self) -> bool:
        """Nobody has filled in a phase yet: neither an application nor an error."""
        return self.application is None and not self.problems

    def messages(self, name: str, index: int | None = None) -> list[Sentence]:
        """Messages on one input."""
        return [problem.message for problem in self.problems if (problem.name, problem.index) == (name, index)]


def address_of_empty(form: Form) -> str:
    """Address of a form without a phase, with all else that it says."""
    lists = [(name, text) for name, texts in form.lists.items() for text in texts]
    given = [(name, text) for name, text in (*form.texts.items(), *lists) if text.strip() and name != "mech"]
    start = START[form.mechanism if form.has_motion else "phases"]
    return "&".join(filter(None, (f"/?{start}", urlencode(given)))) + query_of(form.labels)


def parse(pairs: Pairs) -> Form:
    """Form of a query, with everything that the query says and a message for each wrong field."""
    typed = next((text for name, text in pairs if name == TEXT), None)
    before = expanded(pairs)
    pairs, written = in_wire_units(taken := with_offers(before))
    typed = typed if taken == before else None
    pairs = with_figures(switched(_own(pairs)))
    form = replace(_parsed(pairs, written), typed=None if typed is None else typed.replace("\r\n", "\n"))
    if ("do", "take") in pairs and form.has_motion and form.application is not None:
        return _parsed(taken_over(pairs, form.application), written)
    return form


def _own(pairs: Pairs) -> Pairs:
    """Pairs before another way is chosen: of the worked example its phases alone, since nobody has given the rest."""
    buttons = [(name, text) for name, text in pairs if name == "do" and text.startswith("way:")]
    before = [pair for pair in pairs if pair[0] != "do"]
    if buttons and _parsed(before, None).application == Application.worked_example():
        return [*((name, text) for name, text in pairs if name in LABELS or name in CYCLE_NAMES), *buttons]
    return pairs


def _parsed(pairs: Pairs, written: str | None) -> Form:
    """Form of pairs in the wire's units."""
    given = Given()
    for name, text in pairs:
        given.add(name, text)
    phases, moved, bodies, focus = given.tables()
    rows, moves = phases.texts, moved.texts if given.has_motion else []
    problems = [*given.problems(), *_list_problems(given)]
    application = None
    if not _untouched(given, rows, moves):
        document, found = _document(rows, moves, given)
        problems += found
        application, refused = _validated(document, moves or rows, problems)
        problems += refused
    decimal = Reader.of_marker(written or "").decimal
    return Form(
        rows=tuple(rows),
        origins=(moved if given.has_motion else phases).origins,
        texts=given.scalars,
        lists={name: tuple(texts) for name, texts in given.lists.items()},
        moves=tuple(moves),
        has_motion=given.has_motion,
        bodies=body_table(bodies.texts) if given.has_motion else BodyTable(),
        belt=belt_of(given.belt),
        asides=tuple(given.asides),
        shown=frozenset(given.shown),
        gear=given.page.get("gear", "").strip(),
        pins=given.pinned(),
        focus=focus,
        problems=tuple(replace(problem, message=problem.message.marked(decimal)) for problem in problems),
        application=None if problems else application,
        written=written,
        labels={name: given.labels.get(name, [""])[0] for name in LABELS},
    )


def visible(text: str) -> str:
    """A part of a link without characters that have no width."""
    return _UNSEEN.sub("", text)


def in_wire_units(pairs: Pairs) -> tuple[Pairs, str | None]:
    """Pairs of a form as a link has them, and the marker of what they were written in: see `numbers`."""
    # In the texts of people such characters join emoji and letters.
    seen = [(visible(name), text if name in (*LABELS, NAME.role) else visible(text)) for name, text in pairs]
    return numbers.to_wire(seen, units_of(dict(seen).get("mech", "").strip()))


def for_reader(form: Form, reader: Reader) -> Form:
    """The same form with what the reader's fields show: their units and decimal mark."""
    units = units_of(form.texts.get("mech", "").strip())
    tables = (*form.rows, *form.moves, *form.bodies.rows, form.belt.texts, form.texts)
    cells = [(text, units[name]) for table in tables for name, text in table.items() if name in units]
    shown = numbers.to_fields(cells, reader, form.written)
    texts = iter(shown.texts)
    rows, moves, bodies, (belt, named) = (
        tuple({name: next(texts) if name in units else text for name, text in table.items()} for table in part)
        for part in (form.rows, form.moves, form.bodies.rows, (form.belt.texts, form.texts))
    )
    return replace(
        form,
        rows=rows,
        moves=moves,
        bodies=replace(form.bodies, rows=bodies),
        belt=replace(form.belt, texts=belt),
        texts=named,
        written=reader.marker,
        was=shown.was,
    )


def _list_problems(given: Given) -> Iterable[FieldProblem]:
    for name, texts in given.lists.items():
        for k, text in enumerate(texts):
            if BY_NAME[name].kind != "text" and isinstance(message := read_value(text, "whole"), Sentence):
                if _SEVERAL.fullmatch(text.strip()):
                    example = "&".join(f"{name}={value}" for value in re.findall("[0-9]+", text)[:3])
                    message = Sentence(N_("give each value for itself: {example}"), {"example": example})
                yield FieldProblem(name, k, message)


def _untouched(given: Given, rows: list[dict[str, str]], moves: list[dict[str, str]]) -> bool:
    """The form was sent with its duty table still blank, but for the profile that a move begins with."""
    begun = {"mv"} if "mt" in given.columns else set()
    if any(map(filled, rows)) or any(filled(move).keys() - begun for move in moves):
        return False
    if given.has_motion:
        return "mv" in given.columns and given.scalars.get("mech", "").strip() in TYPES
    return all(name in given.columns for name in REQUIRED)


def _document(
    rows: Sequence[Mapping[str, str]], moves: Sequence[Mapping[str, str]], given: Given
) -> tuple[dict[str, Any], list[FieldProblem]]:
    """Nested input of the application model; what can't be read is left out and reported."""
    problems: list[FieldProblem] = []
    cycle: dict[str, Any] = {}
    if given.has_motion:
        symbols = {symbol.name: symbol for symbol in move_symbols(given.scalars.get("mech", "").strip())}
        cycle["motion"] = {"mechanism": {}, "moves": _table(moves, symbols, problems)}
    else:
        cycle["phases"] = _table(rows, PHASE_BY_NAME, problems)
        if len(cycle["phases"]) == 1:
            problems = [_with_two_phases(problem, given.columns[problem.name]) for problem in problems]
    document: dict[str, Any] = {"duty_cycle": cycle}
    for name, text in given.scalars.items():
        symbol = BY_NAME[name]
        _put(document, symbol.path, symbol, text, FieldProblem(name, None, Sentence("")), problems)
    for name, texts in given.lists.items():
        values = [value for text in texts if not isinstance(value := read_value(text, BY_NAME[name].kind), Sentence)]
        document.setdefault(BY_NAME[name].path[0], {})[BY_NAME[name].path[1]] = values or None
    return document, problems


def _with_two_phases(problem: FieldProblem, texts: Sequence[str]) -> FieldProblem:
    """Fault of a number in the only phase, with advice where it may be two numbers."""
    match = next(filter(None, (_OF_TWO_PHASES.fullmatch(text.strip()) for text in texts)), None)
    if match is None:
        return problem
    values = {"advice": problem.message, "first": match[1], "second": match[2]}
    template = N_("{advice}; if {first} and {second} are meant, give two phases")
    return replace(problem, message=Sentence(template, values))


def _table(
    rows: Sequence[Mapping[str, str]], symbols: Mapping[str, Symbol], problems: list[FieldProblem]
) -> list[dict[str, Any]]:
    """Phases or moves, without blank rows."""
    table: list[dict[str, Any]] = []
    for k, row in enumerate(rows):
        if filled(row):
            entry: dict[str, Any] = {}
            table.append(entry)
            for name, text in row.items():
                _put(entry, symbols[name].path[-1:], symbols[name], text, FieldProblem(name, k, Sentence("")), problems)
    return table


def _put(
    document: dict[str, Any],
    path: tuple[str, ...],
    symbol: Symbol,
    text: str,
    place: FieldProblem,
    problems: list[FieldProblem],
) -> None:
    if not text.strip():
        return
    value = read_value(text, symbol.kind, mostly_whole=symbol.unit == "h")
    faults = [value] if isinstance(value, Sentence) else []
    if symbol.name == NAME.role:
        faults = list(faults_of(text, LONGEST_NAME))
    if faults:
        problems += (FieldProblem(place.name, place.index, fault) for fault in faults)
        return
    for step in path[:-1]:
        document = document.setdefault(step, {})
    document[path[-1]] = value


def _validated(
    document: dict[str, Any], rows: Sequence[Mapping[str, str]], known: Sequence[FieldProblem]
) -> tuple[Application | None, list[FieldProblem]]:
    kept = [k for k, row in enumerate(rows) if filled(row)] or [0]
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
        # Unreadable values are left out of the model, which then misses them, or the part that they belong to.
        consequence = known and error["type"] in ("no_motion", "no_load")
        refused_phases = error["type"] == "too_short" and any(map(filled, rows))
        if (name, index) not in places and not consequence and not refused_phases:
            problems.append(FieldProblem(name, index, refusal_of(error)))
    return None, problems


def place_of(location: Sequence[int | str], rows: Sequence[int] = ()) -> tuple[str, int | None]:
    """Query name and index of a location in the application model; `rows` are the rows that became phases."""
    path = tuple(step for step in location if isinstance(step, str))
    index = next((step for step in location if isinstance(step, int)), None)
    for table, by_leaf, first in _TABLES:
        if path[: len(table)] == table:
            symbol, k = by_leaf.get("".join(path[len(table) :][:1])), index or 0
            return symbol.name if symbol else first, rows[k] if k < len(rows) else k
    if path in BY_PATH:
        return BY_PATH[path].name, index
    return _PARTS.get(path, ".".join(path)), None

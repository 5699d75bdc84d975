"""Form: the content of a query, field by field, and the application that it describes."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from urllib.parse import urlencode

from hpn.application import Application
from hpn.links.labels import LABELS, query_of
from hpn.links.row_symbols import PHASE_SYMBOLS, move_symbols, table_columns
from hpn.links.rows import ROWS_IN_TABLE, TOLERANCE, WIDTHS, filled
from hpn.links.symbol import Symbol
from hpn.links.symbols import MECHANISM_SYMBOLS, mechanism_symbols, units_of
from hpn.physics.motion.mechanisms import TYPES
from hpn.tables import numbers
from hpn.tables.by_size import BySize
from hpn.tables.curve_text import CurveText
from hpn.tables.inputs import NAME
from hpn.web.form.helpers import BodyTable
from hpn.web.form.query import FieldProblem
from hpn.web.form.refusals import MISSING
from hpn.web.form.tolerance_fields import COLUMN, INPUT_OF, OF_ROW, OFFERED, ROW, entries_of, field_of
from hpn.web.form.ways import START
from hpn.words.reader import Reader
from hpn.words.titles import numbered
from hpn.words.wording import Sentence

WHEELS = ("rack_and_pinion", "belt")
"""Mechanisms whose pinion or pulley may sit on the gear's shaft."""

LONGEST_ASIDE = 8_000
"""Characters of inputs of other ways to give the cycle that still fit into an address."""


@dataclass(frozen=True)
class Form:
    """Content of a query, and the application that it describes, or the problems that keep it from describing one.

    A motion has its mechanism in `texts` and a row per move in `moves`; its moment of inertia may be calculated from
    `bodies`. `tolerances` are the tolerances of a link that have no field; with `is_exact` those in fields don't count.
    `asides` are the inputs of other ways to give the cycle.
    `sized` holds an input's numbers by size, in the reader's notation.
    `written` is the marker of the language and units in which a form was filled in; None for a link.
    """

    rows: tuple[Mapping[str, str], ...]
    texts: Mapping[str, str]
    lists: Mapping[str, tuple[str, ...]]
    moves: tuple[Mapping[str, str], ...] = ()
    has_motion: bool = False
    bodies: BodyTable = field(default_factory=BodyTable)
    tolerances: tuple[str, ...] = ()
    has_tolerances: bool = False
    is_exact: bool = False
    asides: tuple[str, ...] = ()
    groups: frozenset[str] = frozenset()
    gear: str = ""
    pins: tuple[str, ...] = ()
    focus: str | None = None
    problems: tuple[FieldProblem, ...] = ()
    application: Application | None = None
    written: str | None = None
    was: str = ""
    condition: Mapping[str, str] = field(default_factory=dict)
    typed: str | None = None
    labels: Mapping[str, str] = field(default_factory=lambda: dict.fromkeys(LABELS, ""))
    sized: Mapping[str, tuple[tuple[str, str], ...]] = field(default_factory=dict)

    @property
    def as_text(self) -> bool:
        """True if the duty cycle is edited as text instead of in a table."""
        return len(self.rows) > ROWS_IN_TABLE

    @property
    def long(self) -> bool:
        """True if the form is posted, as it may be too long for an address."""
        return self.as_text or self.moves_are_hidden or sum(map(len, self.asides)) > LONGEST_ASIDE

    @property
    def moves_are_hidden(self) -> bool:
        """True if there are more moves than the page has fields for."""
        return len(self.moves) > ROWS_IN_TABLE

    @property
    def has_both(self) -> bool:
        """True if both phases and a motion are given, which is an error."""
        return self.has_motion and any(map(filled, self.rows))

    @property
    def mechanism(self) -> str:
        """Type of the mechanism; the first of TYPES where the form has none."""
        code = self.texts.get("mech", "").strip()
        return code if code in TYPES else TYPES[0]

    @property
    def mechanism_symbols(self) -> tuple[Symbol, ...]:
        """Inputs of the mechanism, plus given inputs of other mechanisms: their errors are shown beside them."""
        own = mechanism_symbols(self.mechanism)
        names = {"mech", *(symbol.name for symbol in own)}
        return (*own, *(symbol for symbol in MECHANISM_SYMBOLS if symbol.name in self.texts.keys() - names))

    def shows(self, name: str) -> bool:
        """True for an input that the cycle leaves open, and for any given input: its error is shown beside it."""
        if name in self.texts or not self.has_motion:
            return name in self.texts or name != "fm"
        own = {"hx": "rack_and_pinion", "kb": "belt"}.get(name, self.mechanism)
        return name not in ("JL", "dt", "dd") and own == self.mechanism and not (name == "fm" and own not in WHEELS)

    @property
    def columns(self) -> list[Symbol]:
        """Columns of the table of phases."""
        return table_columns(PHASE_SYMBOLS, self.groups)

    @property
    def move_columns(self) -> list[Symbol]:
        """Columns of the table of moves."""
        return table_columns(move_symbols(self.mechanism), self.groups)

    def row(self, problem: FieldProblem) -> str:
        """Number of a problem's row, with the row's name if it has one."""
        at = problem.index or 0
        rows = self.moves if self.has_motion and not self.has_both else self.rows
        return numbered(at, rows[at].get(NAME.role, "").strip() if at < len(rows) else "")

    @property
    def text(self) -> str:
        """Duty cycle as text, one phase per line; as typed if it was typed as text."""
        columns = PHASE_SYMBOLS[: next((width for group, width in WIDTHS.items() if group in self.groups), 3)]
        lines = ("\t".join(row.get(symbol.name, "") for symbol in columns) for row in self.rows)
        return "\n".join(lines) if self.typed is None else self.typed

    @property
    def empty(self) -> bool:
        """True if no phase is filled in yet: neither an application nor a problem."""
        return self.application is None and not self.problems

    @property
    def only_lacks(self) -> bool:
        """True if missing inputs are the only problems."""
        return bool(self.problems) and all(problem.message.template == MISSING for problem in self.problems)

    def offers_tolerance(self, name: str) -> bool:
        """True for an input with a field for its tolerance."""
        return self.has_tolerances and not self.is_exact and (name in OFFERED or self.says_tolerance(name))

    @property
    def in_sheet(self) -> tuple[str, ...]:
        """Names of the table's fields outside its rows."""
        columns = self.move_columns if self.has_motion else self.columns
        return ("tp", f"{COLUMN}tp", *(f"{COLUMN}{symbol.name}" for symbol in columns))

    @staticmethod
    def tolerances_of(names: Sequence[str]) -> list[str]:
        """Names of the tolerance fields of a row's cells."""
        return [f"{ROW}{name}" for name in names if f"{ROW}{name}" in OF_ROW]

    @property
    def asks_of_worst(self) -> bool:
        """True if the form has a requirement for the worst case."""
        names = ("uw", "ot")
        return any(name in self.texts for name in names) or any(each.name in names for each in self.problems)

    def says_tolerance(self, name: str) -> bool:
        """True for an input that has a tolerance of its own or for all rows, valid or not."""
        field = f"{COLUMN}{name}"
        return field in self.texts or any(problem.name == field for problem in self.problems)

    def messages(self, name: str, index: int | None = None) -> list[Sentence]:
        """Messages for one input."""
        return [problem.message for problem in self.problems if (problem.name, problem.index) == (name, index)]


def address_of_empty(form: Form) -> str:
    """Address of a form without a phase but with its other inputs."""
    lists = [(name, text) for name, texts in form.lists.items() for text in texts]
    lists += [(TOLERANCE, text) for text in form.tolerances]
    entries = [(name, text) for name, text in (*form.texts.items(), *lists) if text.strip() and name != "mech"]
    start = START[form.mechanism if form.has_motion else "phases"]
    return "&".join(filter(None, (f"/?{start}", urlencode(entries)))) + query_of(form.labels)


def for_reader(form: Form, reader: Reader) -> Form:
    """Form with its texts in the reader's units and with their decimal mark."""
    units = units_of(form.texts.get("mech", "").strip())
    sized = {name: text for name, text in form.texts.items() if isinstance(text, BySize)}
    curves = {name: text for name, text in form.texts.items() if isinstance(text, CurveText)}
    single = {name: text for name, text in form.texts.items() if name not in (*sized, *curves)}
    tables = (*form.rows, *form.moves, *form.bodies.rows, single)
    cells = [(text, units[name]) for table in tables for name, text in table.items() if name in units]
    cells += [(part.number, units[name]) for name, text in sized.items() for part in text.parts]
    cells += [cell for text in curves.values() for cell in text.cells]
    parted = [pair for table in (*form.rows, *form.moves, single) for pair in table.items() if pair[0] in INPUT_OF]
    cells += [cell for name, text in parted for cell in entries_of(name, text, units)]
    entries = numbers.to_fields(cells, reader, form.written)
    texts = iter(entries.texts)
    rows, moves, bodies, (named,) = (
        tuple({name: next(texts) if name in units else text for name, text in table.items()} for table in part)
        for part in (form.rows, form.moves, form.bodies.rows, (single,))
    )
    by_size = {name: tuple((part.place, next(texts)) for part in text.parts) for name, text in sized.items()}
    named |= {name: text.for_field([number for _, number in by_size[name]], reader) for name, text in sized.items()}
    named |= {name: text.over(lambda *_: next(texts)).for_field for name, text in curves.items()}
    fields = iter([field_of(name, text, texts, units, reader) for name, text in parted])
    rows, moves, (named,) = (
        tuple({name: next(fields) if name in INPUT_OF else text for name, text in table.items()} for table in part)
        for part in (rows, moves, (named,))
    )
    return replace(
        form,
        rows=rows,
        moves=moves,
        bodies=replace(form.bodies, rows=bodies),
        texts=named,
        sized=by_size,
        written=reader.marker,
        was=entries.was,
    )

"""Pairs of a query, sorted into rows of phases, moves and bodies, single values, lists and parameters of the page."""

import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from hpn.application import MOST_WISHES
from hpn.application.motion import MAXIMUM_MOVES
from hpn.application.motor import MOST_POINTS
from hpn.application.shaft_centre import MOST_SIZES
from hpn.application.tolerances import MOST_TOLERANCES
from hpn.links.labels import LABELS
from hpn.links.row_symbols import BODY_BY_NAME, MOVE_BY_LEAF, MOVE_BY_NAME, PHASE_BY_NAME, PHASE_SYMBOLS, TURN_SYMBOLS
from hpn.links.rows import EVEN, OF_ANY_ROW, SHARED, TEXT, TOLERANCE, FormTable, cells_of, groups_of, shown_columns
from hpn.links.symbols import (
    BY_NAME,
    BY_SIZE,
    CURVES,
    MECHANISM_SYMBOLS,
    MERGED,
    SYMBOLS,
    mechanism_symbols,
    units_of,
)
from hpn.physics.motion.bodies import MOST_BODIES
from hpn.tables.by_size import BySize, by_size
from hpn.tables.curve_text import CurveText, curve_text
from hpn.tables.inputs import NAME
from hpn.tables.numbers import WAS, WRITTEN, Notation
from hpn.web.form.tolerance_fields import EXACT, INPUT_OF, OF_COLUMN, OF_ROW, ROW, input_of, place, symbol_in, typed
from hpn.words.fields import MAXIMUM_PHASES
from hpn.words.likeness import likeness
from hpn.words.titles import faults_of
from hpn.words.wording import N_, Sentence

Pairs = Sequence[tuple[str, str]]

ASIDE = "aside"
REST_FRICTION, REVERSES = "rf", "lr"
"""Inputs that phases need, for friction at rest and reversal of torque; a motion determines both."""

CYCLE_NAMES = {symbol.name for symbol in (*PHASE_SYMBOLS, *TURN_SYMBOLS, *MECHANISM_SYMBOLS)}
"""Names of a link's parameters for its duty cycle, as phases or as a motion."""

OF_ONE_WAY = {*CYCLE_NAMES, REST_FRICTION, REVERSES}
"""Names of parameters that belong to a single way to give a cycle."""


def is_of_one_way(name: str, text: str) -> bool:
    """True for an input that belongs to a single way to give a cycle, and for its tolerance."""
    return (symbol_in(text) if name == TOLERANCE else input_of(name)) in OF_ONE_WAY


_OF_MOTION = {symbol.name for symbol in (*TURN_SYMBOLS, *MECHANISM_SYMBOLS)}.difference(OF_ANY_ROW)
_OF_PEOPLE = {*LABELS, NAME.role}

FIRST_TOLERANCE = "tol_tp"
"""Field of a tolerance that every form has."""

CONDITION = ("at_n", "at_life", "at_fw")
"""Speed, life and load coefficient for the permitted load of a shaft, which a page shows when no load is given."""

PAGE_NAMES = ("gear", "pin", "unpin", "do", ASIDE, EXACT, WRITTEN, WAS, *CONDITION)
"""Parameters of the page itself: gear shown, pinned gears (repeated), one to unpin, pressed buttons in their order,
inputs of other ways (repeated), switch of tolerances, language and units of the form, and condition."""

REQUIRED = ("T", "n", "t")

_UNSEEN = re.compile("[\u00ad\u200b-\u200d\u2060\ufeff]")
"""Characters without width; documents break long links with them, and copied links contain them."""

_RATIO = re.compile(r"([0-9]{1,4}) ?: ?1")


def visible(text: str) -> str:
    """Text of a link without characters that have no width."""
    return text if text.isascii() else _UNSEEN.sub("", text)


@dataclass(frozen=True)
class FieldProblem:
    """Fault of one input: its query name, its index among the values of a repeated input, and the message."""

    name: str
    index: int | None
    message: Sentence

    @property
    def of_tolerance(self) -> bool:
        """True if the input is a field of a tolerance."""
        return self.name in INPUT_OF

    @property
    def of_phase(self) -> bool:
        """True if the input belongs to a phase, or is the tolerance of such an input."""
        return OF_ROW.get(self.name, self.name) in PHASE_BY_NAME

    @property
    def of_move(self) -> bool:
        """True if the input belongs to a move, or is the tolerance of such an input."""
        return OF_ROW.get(self.name, self.name) in MOVE_BY_NAME and not self.of_phase

    @property
    def of_row(self) -> bool:
        """True if the input is in a row of the duty table, of phases or of moves."""
        return self.of_phase or self.of_move

    @property
    def place(self) -> str:
        """Id of the input's element on the page."""
        is_one = self.of_row or self.name in BODY_BY_NAME or (self.name == TOLERANCE and self.index is not None)
        return f"{self.name}-{self.index or 0}" if is_one else f"f-{self.name}"


class SortedQuery:
    """Query sorted into rows of phases, moves and bodies, single values, lists and parameters of the page.

    Texts are in the wire's units and notation. `buttons.play` applies the pressed buttons afterwards.
    """

    def __init__(self, pairs: Pairs) -> None:
        self.notation = Notation({visible(name): text for name, text in reversed(pairs)})
        self.scalars: dict[str, str] = {}
        self.single: dict[str, list[str]] = {}
        self.lists: dict[str, list[str]] = {}
        self.labels: dict[str, list[str]] = {}
        self.page: dict[str, str] = {}
        self.presses: list[str] = []
        self.pins: list[str] = []
        self.unknown: list[tuple[str, str]] = []
        self.asides: list[str] = []
        self.tolerances: list[str] = []
        self.typed: str | None = None
        self.bodies = FormTable(BODY_BY_NAME, MOST_BODIES)
        self._begin(pairs)
        for name, text in pairs:
            self._write(visible(name), text)
        self.bodies.show(list(BODY_BY_NAME))
        self._show()
        self._place()

    def _begin(self, pairs: Pairs) -> None:
        """Create empty tables; names and loads of rows belong to moves if any input of a motion is given."""
        self.units = units_of(next((text.strip() for name, text in pairs if visible(name) == "mech"), ""))
        self.has_motion = any(text.strip() and visible(name) in _OF_MOTION for name, text in pairs)
        self.phases = FormTable((n for n in PHASE_BY_NAME if not (self.has_motion and n in OF_ANY_ROW)), MAXIMUM_PHASES)
        self.moves = FormTable(MOVE_BY_NAME, MAXIMUM_MOVES)

    # --- Sorting ------------------------------------------------------------------------------------------------------

    def _write(self, name: str, text: str) -> None:
        """Add one pair as typed; the form has a field for each size, such as `xc.20A`."""
        symbol, of_size, size = name.partition(".")
        if of_size and symbol in BY_SIZE:
            name, text = symbol, f"{size[:20]}: {text}" if text.strip() else ""
        if name == TEXT:
            self.typed = text.replace("\r\n", "\n")
            for column, cell in cells_of(text):
                self._write(column, cell)
        else:
            self.add(name, self.in_wire_units(name, text))

    def in_wire_units(self, name: str, text: str) -> str:
        """Text of a field in the wire's units and notation."""
        if name in _OF_PEOPLE:  # in their texts characters without width join emoji and letters
            return text
        text = visible(text)
        if name == "i" and (match := _RATIO.fullmatch(text.strip())):
            return match[1]
        if name in INPUT_OF:
            return typed(name, text, self.notation, self.units)
        if name in BY_SIZE:
            return BySize(part._replace(number=self._entry(name, part.number)) for part in by_size(text).parts)
        if name in CURVES:
            return curve_text(text).over(self.notation.entry)
        return self._entry(name, text)

    def _entry(self, name: str, text: str) -> str:
        return self.notation.entry(text, self.units[name]) if name in self.units else text

    def add(self, name: str, text: str) -> None:
        """Add one pair in the wire's notation."""
        if table := self.table_of(name):
            table.add(name, text)
        elif name == "do":
            self.presses.append(text)
        elif name == "pin":
            self.pins += [text.strip()] if text.strip() else []
        elif name == ASIDE:
            self.asides.append(text)
        elif name == TOLERANCE:  # one more than there may be is enough to refuse them
            self.tolerances += [text] if text.strip() and len(self.tolerances) <= MOST_TOLERANCES else []
        elif name in PAGE_NAMES:
            self.page[name] = text
        elif name in LABELS:
            self.labels.setdefault(name, []).append(text)
        elif name in OF_COLUMN:
            self._add_single(name, text)
        elif name not in BY_NAME:
            self.unknown.append((name, text))
        elif name in BY_SIZE:
            self._add_by_size(name, by_size(text))
        elif name in CURVES:
            self._add_points(name, curve_text(text))
        elif not BY_NAME[name].many:
            self._add_single(name, text)
        elif text.strip():
            texts = self.lists.setdefault(name, [])
            if len(texts) <= MOST_WISHES:  # one more than there may be is enough to refuse them
                texts.append(text)

    def _add_single(self, name: str, text: str) -> None:
        self.single.setdefault(name, []).append(text)
        if text.strip():  # the plain form submits blank fields, too; they count as absent
            self.scalars.setdefault(name, text)

    def _add_by_size(self, name: str, text: BySize) -> None:
        """Add numbers by size, which may be repeated; only one may have no size."""
        self.single.setdefault(name, []).extend(part.number for part in text.parts if not part.size)
        before = self.scalars.get(name)
        parts = (*(by_size(before).parts if before else ()), *text.parts)
        if parts:
            self.scalars[name] = BySize(parts[: MOST_SIZES + 1])  # one more than there may be is enough to refuse them

    def _add_points(self, name: str, text: CurveText) -> None:
        """Add points of a curve, which may be repeated."""
        self.single.setdefault(name, [])
        before = self.scalars.get(name)
        points = (*(curve_text(before).points if before else ()), *text.points)
        if points:
            self.scalars[name] = CurveText(points[: MOST_POINTS + 1])  # one more than there may be is enough

    def table_of(self, name: str) -> FormTable | None:
        """Table with a column of this name, or None."""
        name = OF_ROW.get(name, name)
        if name in PHASE_BY_NAME and not (self.has_motion and name in OF_ANY_ROW):
            return self.phases
        return self.moves if name in MOVE_BY_NAME else self.bodies if name in BODY_BY_NAME else None

    def _show(self) -> None:
        """Show the optional columns that are used."""
        self.groups = groups_of({**self.phases.counts, **self.moves.counts})
        if any(row[EVEN].strip() for row in self.moves.rows):
            self.groups.add(EVEN)
        self.show_columns()

    def show_columns(self) -> None:
        """Give the tables the columns of the shown groups."""
        apart = SHARED if self.has_motion else ()
        self.phases.show(self._with_tolerances(shown_columns(PHASE_BY_NAME, self.groups.difference(apart))))
        self.moves.show(self._with_tolerances(shown_columns(MOVE_BY_NAME, self.groups)))

    def _with_tolerances(self, columns: list[str]) -> list[str]:
        own = [f"{ROW}{name}" for name in columns if f"{ROW}{name}" in OF_ROW]
        return columns + own if self.has_tolerances else columns

    def _place(self) -> None:
        """Move the tolerances of a link into their fields."""
        if self.tolerances and len(self.tolerances) <= MOST_TOLERANCES:
            inputs = {*self.duty.names, *(symbol.name for symbol in SYMBOLS)}
            if self.has_motion:
                inputs.update(s.name for s in mechanism_symbols(self.scalars.get("mech", "").strip()))
            self.tolerances = place(self.tolerances, self.duty, inputs, self.scalars, self.single)
            self.show_columns()

    @property
    def has_tolerances(self) -> bool:
        """True if inputs have fields for their tolerances."""
        entries = (*self.single, *self.phases.counts, *self.moves.counts)
        return any(name in INPUT_OF for name in entries)

    @property
    def is_exact(self) -> bool:
        """True if tolerances are switched off."""
        return bool(self.page.get(EXACT, "").strip())

    # --- Actions of buttons -------------------------------------------------------------------------------------------

    def toggle(self, group: str) -> None:
        """Show or hide a group of optional columns."""
        self.groups ^= {group}
        self.show_columns()

    def toggle_tolerances(self) -> None:
        """Show the fields of tolerances, or hide them: filled ones stop counting, blank ones are removed."""
        if self.is_exact or not self.has_tolerances:
            self.page.pop(EXACT, None)
            self.single.setdefault(FIRST_TOLERANCE, [""])
        elif any(name in OF_COLUMN for name in self.scalars) or any(
            text.strip() for row in self.duty.rows for name, text in row.items() if name in OF_ROW
        ):
            self.page[EXACT] = "1"
        else:
            for names in (self.single, self.phases.counts, self.moves.counts):
                for name in INPUT_OF.keys() & names.keys():
                    del names[name]
        self.show_columns()

    def put(self, name: str, text: str) -> None:
        """Set the text of a single value."""
        self.single[name], self.scalars[name] = [text], text

    def cycle(self) -> list[tuple[str, str]]:
        """Pairs of the duty cycle and of the other inputs of its way."""
        single = [(name, text) for name in self.single if input_of(name) in OF_ONE_WAY for text in self.single[name]]
        single += [(TOLERANCE, text) for text in self.tolerances if is_of_one_way(TOLERANCE, text)]
        tables = (self.phases, self.moves)
        return single + [
            (name, row[name]) for table in tables for row in table.rows for name in table.counts if name in row
        ]

    def put_cycle(self, pairs: Pairs) -> None:
        """Replace the duty cycle and the other inputs of its way."""
        for name in [name for name in self.single if input_of(name) in OF_ONE_WAY]:
            self.single.pop(name, None)
            self.scalars.pop(name, None)
        self.typed = None
        self.tolerances = [text for text in self.tolerances if not is_of_one_way(TOLERANCE, text)]
        self._begin(pairs)
        for name, text in pairs:
            self.add(name, text)
        self._show()

    def keep_cycle(self) -> None:
        """Remove everything except duty cycle, labels and buttons."""
        for beside in (self.lists, self.page, self.pins, self.unknown, self.asides):
            beside.clear()
        for name in list(self.single):
            if input_of(name) not in CYCLE_NAMES:
                del self.single[name]
                self.scalars.pop(name, None)
        self.tolerances = [text for text in self.tolerances if is_of_one_way(TOLERANCE, text)]

    # --- Content ------------------------------------------------------------------------------------------------------

    @property
    def duty(self) -> FormTable:
        """Table of the duty cycle: moves of a motion, else phases."""
        return self.moves if self.has_motion else self.phases

    def pinned(self) -> tuple[str, ...]:
        """Pinned gears, without the one to unpin."""
        return tuple(pin for pin in self.pins if pin != self.page.get("unpin"))

    def beside(self) -> list[tuple[str, str]]:
        """Pairs of everything but rows and buttons; blank ones are left out."""
        texts = {**self.single, **self.lists, **self.labels, **{name: [self.scalars.get(name, "")] for name in MERGED}}
        named = [(name, text) for name in texts for text in texts[name]]
        page = [*self.page.items(), *(("pin", pin) for pin in self.pins), *((ASIDE, aside) for aside in self.asides)]
        page += [(TOLERANCE, text) for text in self.tolerances]
        pairs = (*named, *page, *self.unknown)
        return [(name, text) for name, text in pairs if text.strip() and name not in (WRITTEN, WAS, *CONDITION)]

    def problems(self) -> Iterable[FieldProblem]:
        """Yield problems of names that are unknown, wrongly repeated, or repeated less often than their table needs."""
        for name, _ in self.unknown[:20]:
            yield FieldProblem(name[:60], None, unknown_name(name))
        for name, texts in (*self.single.items(), *self.labels.items()):
            if len(texts) > 1:
                listed = ", ".join(text.strip()[:20] or '""' for text in texts[:5])
                yield FieldProblem(
                    name, None, Sentence(N_("must be a single value; given: {texts}"), {"texts": listed})
                )
        for name, texts in self.labels.items():
            yield from (FieldProblem(name, None, fault) for fault in faults_of(texts[0]))
        if self.phases.counts and not self.presses:
            yield from _unequal(self.phases, REQUIRED)
        if self.has_motion:
            yield from _unequal(self.moves, ("mv",))
            yield from _beside_motion(self.phases)


def _unequal(table: FormTable, required: Sequence[str]) -> Iterable[FieldProblem]:
    counts = {name: table.counts.get(name, 0) for name in (*required, *table.counts)}
    longest = max(counts, key=lambda name: counts[name])
    for name, count in counts.items():
        if count < counts[longest]:
            values = {"count": str(count), "name": name, "most": str(counts[longest]), "longest": longest}
            template = N_("missing: the link gives {count} × {name}, but {most} × {longest}")
            yield FieldProblem(name, min(count, table.most), Sentence(template, values))


def _beside_motion(phases: FormTable) -> Iterable[FieldProblem]:
    """Yield a problem for phases given beside a motion; blank ones, as a form submits them, count as absent."""
    for name in phases.counts:
        if filled_rows := [k for k, row in enumerate(phases.rows) if row.get(name, "").strip()]:
            yield FieldProblem(
                name, filled_rows[0], Sentence(N_("given beside a motion: give either phases or a motion"))
            )
            return


def unknown_name(name: str) -> Sentence:
    leaves = {s.path[-1].lower(): s.name for s in (*MOVE_BY_LEAF.values(), *SYMBOLS, *PHASE_SYMBOLS)}
    known = (TOLERANCE, *PHASE_BY_NAME, *BY_NAME, *MOVE_BY_NAME, *PAGE_NAMES, *LABELS)
    names = {each.lower(): each for each in known}
    bare = name[:60].strip().removesuffix("[]").strip()
    close = likeness(bare, leaves | names, 0.4)
    if bare not in known and close is None:
        return Sentence(N_("{name} is not a parameter of this page"), {"name": name[:60]})
    values = {"name": name[:60], "near": bare if bare in known else (leaves | names)[close or ""]}
    return Sentence(N_("{name} is not a parameter of this page; did you mean {near}?"), values)

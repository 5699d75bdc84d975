"""The pairs of a query sorted by what they belong to: rows of phases, moves, bodies, single values, lists, the page."""

import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

from hpn.application import MOST_WISHES
from hpn.application.motion import MAXIMUM_MOVES
from hpn.application.shaft_centre import MOST_SIZES
from hpn.physics.motion.bodies import MOST_BODIES
from hpn.tables.by_size import BySize, by_size
from hpn.tables.numbers import WAS, WRITTEN
from hpn.web.form.labels import LABELS
from hpn.web.form.rows import OF_ANY_ROW, OPTIONAL, SHARED, Rows, groups_of, shown_columns
from hpn.web.form.symbols import (
    BODY_BY_NAME,
    BY_NAME,
    BY_SIZE,
    MECHANISM_SYMBOLS,
    MOVE_BY_LEAF,
    MOVE_BY_NAME,
    PHASE_BY_NAME,
    PHASE_SYMBOLS,
    SYMBOLS,
)
from hpn.web.form.ways import ASIDE
from hpn.words.fields import MAXIMUM_PHASES
from hpn.words.likeness import likeness
from hpn.words.titles import faults_of
from hpn.words.wording import N_, Sentence

PAGE_NAMES = ("gear", "pin", "unpin", "do", ASIDE, WRITTEN, WAS)
"""Parameters of the page alone: the candidate looked at, those pinned beside it (repeated), one to take away, the
buttons that edit the rows, one after the other, and what was typed another way (repeated)."""

REQUIRED = ("T", "n", "t")


@dataclass(frozen=True)
class FieldProblem:
    """Fault of one input: its message, the query name and, for a repeated one, the place among its values."""

    name: str
    index: int | None
    message: Sentence

    @property
    def of_phase(self) -> bool:
        """True for an input of a phase."""
        return self.name in PHASE_BY_NAME

    @property
    def of_move(self) -> bool:
        """True for an input of a move."""
        return self.name in MOVE_BY_NAME and not self.of_phase

    @property
    def of_row(self) -> bool:
        """True for an input in a row of the duty table, of phases or of moves."""
        return self.of_phase or self.of_move

    @property
    def place(self) -> str:
        """Element of the page that takes this input."""
        return f"{self.name}-{self.index or 0}" if self.of_row or self.name in BODY_BY_NAME else f"f-{self.name}"


class Given:
    """A query sorted into phases, scalars, lists and what belongs to the page."""

    def __init__(self) -> None:
        self.columns: dict[str, list[str]] = {}
        self.scalars: dict[str, str] = {}
        self.single: dict[str, list[str]] = {}
        self.lists: dict[str, list[str]] = {}
        self.labels: dict[str, list[str]] = {}
        self.page: dict[str, str] = {}
        self.presses: list[str] = []
        self.pins: list[str] = []
        self.unknown: list[str] = []
        self.asides: list[str] = []
        self.shown = set[str]()

    def add(self, name: str, text: str) -> None:
        """Take one pair of the query."""
        if name in PHASE_BY_NAME or name in MOVE_BY_NAME or name in BODY_BY_NAME:
            self.columns.setdefault(name, []).append(text)
        elif name == "do":
            self.presses.append(text)
        elif name == "pin":
            self.pins += [text.strip()] if text.strip() else []
        elif name == ASIDE:
            self.asides.append(text)
        elif name in PAGE_NAMES:
            self.page[name] = text
        elif name in LABELS:
            self.labels.setdefault(name, []).append(text)
        elif name not in BY_NAME:
            self.unknown.append(name)
        elif name in BY_SIZE:
            self._add_by_size(name, by_size(text))
        elif not BY_NAME[name].many:
            self.single.setdefault(name, []).append(text)
            if text.strip():  # the plain form submits blank fields too: they count as absent
                self.scalars.setdefault(name, text)
        elif text.strip():
            texts = self.lists.setdefault(name, [])
            if len(texts) <= MOST_WISHES:  # one more than there may be is enough to refuse them
                texts.append(text)

    def _add_by_size(self, name: str, text: BySize) -> None:
        """Take numbers by size, which may be repeated; of those without a size there is one."""
        self.single.setdefault(name, []).extend(part.number for part in text.parts if not part.size)
        before = self.scalars.get(name)
        parts = (*(by_size(before).parts if before else ()), *text.parts)
        if parts:
            self.scalars[name] = BySize(parts[: MOST_SIZES + 1])  # one more than there may be is enough to refuse them

    @property
    def has_motion(self) -> bool:
        """True where anything of a motion is given: loads of rows are then those of its moves."""
        of_moves = (self.columns[name] for name in MOVE_BY_NAME if name in self.columns and name not in OF_ANY_ROW)
        return any(symbol.name in self.scalars for symbol in MECHANISM_SYMBOLS) or any(
            text.strip() for texts in of_moves for text in texts
        )

    def tables(self) -> tuple[Rows, Rows, Rows, str | None]:
        """Phases, moves and bodies after the buttons that were pressed, and the element to go on from."""
        self.shown = groups_of(self.columns)
        moving = self.has_motion
        phases = Rows(self._of_phases(), self._phase_columns(), MAXIMUM_PHASES)
        moves = Rows(self.columns if moving else {}, self._move_columns(), MAXIMUM_MOVES)
        bodies = Rows(self.columns, tuple(BODY_BY_NAME), MOST_BODIES)
        focus = None
        for press in self.presses[:50]:
            do, _, number = press.partition(":")
            k = int(number) - 1 if re.fullmatch(r"[0-9]{1,5}", number) else -1
            if do in OPTIONAL:
                self.shown ^= {do}
                phases.show(self._phase_columns())
                moves.show(self._move_columns())
                focus = do
            elif do == "one_way":
                self.scalars["lr"], focus = "0", "f-lr"
            elif do == "from_motion":
                self.scalars["fm"], focus = "1", "f-fm"
            elif do == "way":
                focus = f"way-{number}"
            elif do == "take":
                focus = number.partition(":")[0]
            elif do in ("inertia", "gravity"):
                focus = do
            elif do.endswith("_body"):
                focus = bodies.press(do.removesuffix("_body"), k)
            else:
                focus = (moves if moving else phases).press(do, k)
        return phases, moves, bodies, focus

    def _of_phases(self) -> Mapping[str, list[str]]:
        """Columns of the table of phases."""
        apart = OF_ANY_ROW if self.has_motion else ()
        return {name: texts for name, texts in self.columns.items() if name in PHASE_BY_NAME and name not in apart}

    def _phase_columns(self) -> list[str]:
        return shown_columns(PHASE_BY_NAME, self.shown - {*(SHARED if self.has_motion else ())})

    def _move_columns(self) -> list[str]:
        return shown_columns(MOVE_BY_NAME, self.shown)

    def pinned(self) -> tuple[str, ...]:
        """Pinned gears, without the one whose button takes it away."""
        return tuple(pin for pin in self.pins if pin != self.page.get("unpin"))

    def problems(self) -> Iterable[FieldProblem]:
        """Names that are unknown, repeated, or repeated unequally often."""
        for name in self.unknown[:20]:
            yield FieldProblem(name[:60], None, unknown_name(name))
        for name, texts in (*self.single.items(), *self.labels.items()):
            if len(texts) > 1:
                listed = ", ".join(text.strip()[:20] or '""' for text in texts[:5])
                yield FieldProblem(
                    name, None, Sentence(N_("must be a single value; given: {texts}"), {"texts": listed})
                )
        for name, texts in self.labels.items():
            yield from (FieldProblem(name, None, fault) for fault in faults_of(texts[0]))
        if (columns := self._of_phases()) and not self.presses:
            yield from _unequal(columns, REQUIRED, MAXIMUM_PHASES)
        if self.has_motion:
            of_moves = {name: texts for name, texts in self.columns.items() if name in MOVE_BY_NAME}
            yield from _unequal(of_moves, ("mv",), MAXIMUM_MOVES)
            yield from _beside_motion(columns)


def _unequal(columns: Mapping[str, list[str]], required: Sequence[str], most: int) -> Iterable[FieldProblem]:
    counts = {name: len(columns.get(name, [])) for name in (*required, *columns)}
    longest = max(counts, key=lambda name: counts[name])
    for name, count in counts.items():
        if count < counts[longest]:
            values = {"count": str(count), "name": name, "most": str(counts[longest]), "longest": longest}
            template = N_("missing: the link gives {count} × {name}, but {most} × {longest}")
            yield FieldProblem(name, min(count, most), Sentence(template, values))


def _beside_motion(columns: Mapping[str, list[str]]) -> Iterable[FieldProblem]:
    """Phases where a motion is given: blank ones, as a form submits them, count as absent."""
    for name, texts in columns.items():
        if filled := [k for k, text in enumerate(texts) if text.strip()]:
            yield FieldProblem(name, filled[0], Sentence(N_("given beside a motion: give either phases or a motion")))
            return


def unknown_name(name: str) -> Sentence:
    leaves = {s.path[-1].lower(): s.name for s in (*MOVE_BY_LEAF.values(), *SYMBOLS, *PHASE_SYMBOLS)}
    known = (*PHASE_BY_NAME, *BY_NAME, *MOVE_BY_NAME, *PAGE_NAMES, *LABELS)
    names = {each.lower(): each for each in known}
    bare = name[:60].strip().removesuffix("[]").strip()
    close = likeness(bare, leaves | names, 0.4)
    if bare not in known and close is None:
        return Sentence(N_("{name} is not a parameter of this page"), {"name": name[:60]})
    values = {"name": name[:60], "near": bare if bare in known else (leaves | names)[close or ""]}
    return Sentence(N_("{name} is not a parameter of this page; did you mean {near}?"), values)

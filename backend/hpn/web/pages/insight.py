"""What the page adds to a verdict: reserves, the remedy to try out, and gears side by side."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from urllib.parse import quote

from hpn.application import Application
from hpn.catalogue import Catalogue
from hpn.comparison import MOST_PINS, Column, RowGroup, groups_of, undominated
from hpn.remedy import Room, alternatives_of, rooms_of, tried
from hpn.selection import Candidate, Selection
from hpn.web.form.read import FieldProblem, Form
from hpn.web.form.write import to_link
from hpn.wording import N_, Sentence


@dataclass(frozen=True)
class Insight:
    """What belongs to the chosen gear; `pins` are the gears that the reader pinned beside it.

    `try_out` is the link that follows the first alternative of the chosen gear's remedy; None where it has none.
    """

    rooms: tuple[Room, ...]
    try_out: str | None
    pins: tuple[str, ...]
    columns: tuple[Column, ...]
    groups: tuple[RowGroup, ...]
    undominated: frozenset[str]

    def with_pin(self, designation: str) -> str:
        """Tail of a link that pins one more gear."""
        return tail_of((*self.pins, designation))

    def without_pin(self, designation: str) -> str:
        """Tail of a link that takes one away."""
        return tail_of([pin for pin in self.pins if pin != designation])

    @property
    def full(self) -> bool:
        """Whether no more can be pinned."""
        return len(self.pins) >= MOST_PINS


def tail_of(pins: Sequence[str]) -> str:
    """Query of some pins."""
    return "".join(f"&pin={quote(pin)}" for pin in pins)


def checked_pins(form: Form, catalogue: Catalogue) -> Form:
    """The form with its pins by their canonical names, each once; what can't be pinned becomes a problem."""
    problems = [
        FieldProblem("pin", None, Sentence(N_("{gear} is not a gear of the catalogue"), {"gear": pin[:40]}))
        for pin in form.pins[: MOST_PINS + 1]
        if catalogue.find(pin) is None
    ]
    known = tuple(dict.fromkeys(gear.designation for pin in form.pins if (gear := catalogue.find(pin)) is not None))
    if len(known) > MOST_PINS:
        text = N_("at most {most} gears can be pinned; the link gives {count}")
        problems.append(FieldProblem("pin", None, Sentence(text, {"most": MOST_PINS, "count": len(known)})))
    return replace(form, pins=known[:MOST_PINS], problems=(*form.problems, *problems))


def insight_of(
    application: Application,
    selection: Selection,
    everything: Mapping[str, Candidate],
    chosen: Candidate,
    lighter: Candidate | None,
    pins: tuple[str, ...],
    catalogue: Catalogue,
) -> Insight:
    """What belongs to the chosen gear; `everything` holds every gear of the catalogue by designation."""
    u = application.requirements.utilisation
    alternatives = alternatives_of(chosen, u)
    shown = [chosen, *(everything[pin] for pin in pins if pin != chosen.designation)]
    if not pins and (second := _second(selection, chosen, lighter)):
        shown.append(second)
    columns = tuple(Column(entry, catalogue.by_designation[entry.designation]) for entry in shown)
    titles = {code: definition.title for code, definition in selection.check_definitions.items()}
    return Insight(
        rooms=rooms_of(chosen, u),
        try_out=to_link(tried(application, alternatives[0])) if alternatives else None,
        pins=pins,
        columns=columns,
        groups=groups_of(columns, selection.duty.maximum_torque_Nm, titles),
        undominated=undominated(selection.candidates, catalogue),
    )


def _second(selection: Selection, chosen: Candidate, lighter: Candidate | None) -> Candidate | None:
    """The gear to compare with where none is pinned: the nearest smaller miss, else the next in line."""
    others = [lighter] if lighter else []
    others += [candidate for candidate in selection.candidates if candidate.status != "unrated"]
    if chosen.designation != selection.foremost.designation:
        others.insert(0, selection.foremost)
    return next((other for other in others if other.designation != chosen.designation), None)

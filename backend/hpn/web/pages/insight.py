"""What the page adds to a verdict: remedies, reserves, the calculation, and gears side by side."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any
from urllib.parse import quote

from hpn.calculation import Step, calculation_of
from hpn.candidates import Candidate, foremost
from hpn.catalogue import Catalogue
from hpn.comparison import MOST_PINS, Column, Group, groups_of, undominated
from hpn.remedy import Room, followed, remedy_of, rooms_of, ways_of
from hpn.selection import Selection
from hpn.web.form.messages import N_, Message
from hpn.web.form.read import Form, Problem
from hpn.web.form.write import to_link
from hpn.wording import Sentence


@dataclass(frozen=True)
class Insight:
    """Remedies by designation, and what belongs to the chosen gear; `pins` are the gears that the reader pinned.

    `try_out` is the link that follows the remedy of the chosen gear; None where it has none that changes the duty.
    """

    remedies: Mapping[str, Sentence | None]
    rooms: tuple[Room, ...]
    try_out: str | None
    steps: tuple[Step, ...]
    pins: tuple[str, ...]
    columns: tuple[Column, ...]
    groups: tuple[Group, ...]
    undominated: frozenset[str]

    @property
    def tail(self) -> str:
        """Query of the pins, to go on at the end of a link."""
        return tail_of(self.pins)

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
        Problem("pin", None, Message(N_("%(gear)s is not a gear of the catalogue"), {"gear": pin[:40]}))
        for pin in form.pins[: MOST_PINS + 1]
        if catalogue.find(pin) is None
    ]
    known = tuple(dict.fromkeys(gear.designation for pin in form.pins if (gear := catalogue.find(pin)) is not None))
    if len(known) > MOST_PINS:
        text = N_("at most %(most)s gears can be pinned; the link gives %(count)s")
        problems.append(Problem("pin", None, Message(text, {"most": str(MOST_PINS), "count": str(len(known))})))
    return replace(form, pins=known[:MOST_PINS], problems=(*form.problems, *problems))


def insight_of(
    selection: Selection,
    reply: Mapping[str, Any],
    landscape: Mapping[str, Candidate],
    chosen: Candidate,
    lighter: Candidate | None,
    pins: tuple[str, ...],
) -> Insight:
    """Everything about the chosen gear and the rejected ones; `landscape` holds every gear of the catalogue."""
    catalogue, application = selection.catalogue, selection.application
    u = application.requirements.utilisation
    gear = catalogue.by_designation[chosen["designation"]]
    listed = {candidate["designation"]: candidate for candidate in (*reply["candidates"], chosen)}
    duty = selection.evaluation.duty
    ways = ways_of(chosen, u) if chosen["status"] == "unsuitable" else ()
    shown = [chosen, *(landscape[pin] for pin in pins if pin != chosen["designation"])]
    if not pins and (second := _second(reply["candidates"], chosen, lighter)):
        shown.append(second)
    columns = tuple(Column(entry, catalogue.by_designation[entry["designation"]]) for entry in shown)
    titles = {code: definition["title"] for code, definition in reply["check_definitions"].items()}
    return Insight(
        remedies={name: remedy_of(entry, catalogue.by_designation[name], u) for name, entry in listed.items()},
        rooms=rooms_of(chosen, u),
        try_out=to_link(followed(application, ways[0])) if ways else None,
        steps=calculation_of(chosen, gear, duty, catalogue),
        pins=pins,
        columns=columns,
        groups=groups_of(columns, duty.maximum_torque_Nm.item(0), titles),
        undominated=undominated(reply["candidates"], catalogue),
    )


def _second(candidates: Sequence[Candidate], chosen: Candidate, lighter: Candidate | None) -> Candidate | None:
    """The gear to compare with where none is pinned: the nearest smaller miss, else the next in line."""
    others = [lighter] if lighter else []
    others += [candidate for candidate in candidates if candidate["status"] != "unrated"]
    if chosen["designation"] != foremost(candidates)["designation"]:
        others.insert(0, foremost(candidates))
    return next((other for other in others if other["designation"] != chosen["designation"]), None)

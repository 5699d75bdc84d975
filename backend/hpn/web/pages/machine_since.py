"""Changes of a machine since its latest revision, or another one, by the comparison of revisions.

For up to FEW_AXES axes they are part of the machine's page; for more they have their own page.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

from fastapi import APIRouter
from starlette.requests import Request
from starlette.responses import RedirectResponse, Response

from hpn.documents.revision import NOW, label_key
from hpn.files.machine.changes import DifferencesExport
from hpn.store import Machine, RevisionLine, SavedAxis
from hpn.web.door.access import admit
from hpn.web.door.pools import compute
from hpn.web.door.problems import needs
from hpn.web.door.visit import current
from hpn.web.machines import FEW_AXES, machine_of
from hpn.web.pages.machine_view import ADDRESS, REASON
from hpn.web.pages.rendering import or_reason, page
from hpn.web.pages.revisions_view import MOST_LINES, Compared, ComparedAxis, next_label
from hpn.web.states import State, catalogues_of, comparison, documents_of, states_of
from hpn.words.reader import Reader

MOST_SHOWN = 12
"""Maximum axes beside the table."""


class ChangeMark(NamedTuple):
    """Mark of a changed axis: the first revision with the change, and True if that is saved already.

    The label is blank if a common value has changed the axis, as that moment is not stored.
    """

    label: str
    is_saved: bool


@dataclass(frozen=True)
class Since:
    """Working copy beside a revision, `line`, of all `lines`; without `states` only the moments of changed axes are
    known."""

    machine: Machine
    line: RevisionLine
    lines: Sequence[RevisionLine]
    states: tuple[State, State] | None
    reader: Reader

    @property
    def label(self) -> str:
        """Label of the revision."""
        return self.line.label

    @property
    def place(self) -> str:
        """Address of the comparison, cell by cell."""
        return comparison(self.machine, (self.label, NOW))

    @cached_property
    def compared(self) -> Compared | None:
        """Comparison of revision and working copy; None if it is on its own page."""
        if self.states is None:
            return None
        labels = (self.label, NOW)
        export = DifferencesExport(labels, documents_of(*self.states), catalogues_of(*self.states), self.place)
        return Compared(export, self.reader)

    @cached_property
    def by_number(self) -> Mapping[int, ComparedAxis]:
        """Differing axes by their numbers, as far as they are shown."""
        return {row.number: row for row in self.compared.rows} if self.compared else {}

    @cached_property
    def changed_numbers(self) -> frozenset[int]:
        """Numbers of the axes that are new, or differ from the revision."""
        if self.compared is None:
            return frozenset(axis.number for axis in self.machine.items if axis.updated > self.line.created)
        return frozenset(axis.number for axis in self.compared.differences.axes if axis.change != "removed")

    def mark(self, axis: SavedAxis) -> ChangeMark | None:
        """Mark of an axis that differs from the revision, or was changed in the latest one; None for any other."""
        if axis.number not in self.changed_numbers:
            before = self.lines[1].created if len(self.lines) > 1 else None
            was_changed = before is not None and before < axis.updated <= self.lines[0].created
            return ChangeMark(self.lines[0].label, True) if was_changed else None
        if axis.updated > self.lines[0].created or self.line is self.lines[0]:
            return ChangeMark(next_label(self.lines), False)
        saved = [line.label for line in self.lines if line.created >= axis.updated > self.line.created]
        return ChangeMark(saved[-1] if saved else "", True)

    def mark_of(self, number: int) -> ChangeMark | None:
        """Mark of the axis with a number; None for a removed axis."""
        axis = next((each for each in self.machine.items if each.number == number), None)
        return None if axis is None else self.mark(axis)

    @cached_property
    def counts(self) -> Mapping[str, int]:
        """Numbers of axes that are new, removed or changed, that have another gear, and that lost theirs."""
        if self.compared is None:
            return {}
        axes = self.compared.differences.axes
        kinds = {name: sum(axis.change == name for axis in axes) for name in ("changed", "added", "removed")}
        return kinds | {"other": len(self.compared.other), "lost": len(self.compared.without_gear)}

    @cached_property
    def rows(self) -> Sequence[ComparedAxis]:
        """Axes beside the table: without a suitable gear first, then with another one, then by effect."""
        return [row for row in self.by_number.values() if row.after][:MOST_SHOWN]

    @property
    def left_out(self) -> int:
        """Number of changed axes that are not beside the table."""
        return len(self.changed_numbers) - len(self.rows)

    @property
    def removed_names(self) -> Sequence[str]:
        """Names of the axes that only the revision has."""
        compared = self.compared
        return [
            compared.names[axis.number]
            for axis in (compared.differences.axes if compared else ())
            if compared and axis.change == "removed"
        ]


async def since_of(
    request: Request, machine: Machine, lines: Sequence[RevisionLine], label: str = "", *, whole: bool = False
) -> Since | None:
    """Changes since the revision of a label, by default the latest; compared at once if axes are few or `whole` is set.

    None without a revision.
    """
    if not lines:
        return None
    line = next((each for each in lines if label_key(each.label) == label_key(label)), lines[0])
    compares = whole or max(line.axes, len(machine.items)) <= FEW_AXES
    states = await states_of(request, machine, line.label, NOW) if compares else None
    return Since(machine, line, lines[:MOST_LINES], states, current())


@or_reason(REASON)
async def show_since(request: Request) -> Response:
    """Page of changes of a machine of any size since a revision; without any redirects to the page of revisions."""
    machine = await machine_of(request, request.path_params["machine"], None, "machine")
    lines, label = await request.app.state.store.revisions(machine.id), request.query_params.get("since", "")
    since = await since_of(request, machine, lines, label, whole=True)
    if since is None:
        return RedirectResponse(f"{ADDRESS}/{machine.id}/revisions", 303)
    return await compute(request, "batches", page, request, "machine_since.html", saved=machine, since=since)


router = APIRouter(include_in_schema=False, dependencies=[needs("fleet")])
router.add_api_route(f"{ADDRESS}/{{machine}}/since", show_since, dependencies=[admit("reading")])

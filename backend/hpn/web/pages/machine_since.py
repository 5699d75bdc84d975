"""Changes of a machine since its latest revision, beside its page: by the comparison that its revisions have.

Up to FEW_AXES axes they stand on the page at once; those of more are asked for by themselves.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

from fastapi import APIRouter
from starlette.requests import Request
from starlette.responses import RedirectResponse, Response

from hpn.documents.revision import NOW
from hpn.files.machine.changes import DifferencesExport
from hpn.store import Machine, RevisionLine
from hpn.web.door.access import admit
from hpn.web.door.pools import compute
from hpn.web.door.problems import needs
from hpn.web.door.visit import current
from hpn.web.machines import FEW_AXES, found
from hpn.web.pages.machine_view import ADDRESS, REASON
from hpn.web.pages.rendering import or_reason, page
from hpn.web.pages.revisions_view import Compared, ComparedAxis
from hpn.web.states import State, catalogues_of, documents_of, states_of
from hpn.words.reader import Reader

MOST_SHOWN, MOST_CELLS = 12, 3
"""Axes and cells of each that stand beside the table."""


@dataclass(frozen=True)
class Since:
    """The working copy beside the latest revision; without its `states` only when an axis was changed is known."""

    machine: Machine
    line: RevisionLine
    states: tuple[State, State] | None
    reader: Reader

    @property
    def label(self) -> str:
        """Label of the revision."""
        return self.line.label

    @property
    def place(self) -> str:
        """Address of the comparison, cell by cell."""
        return f"{ADDRESS}/{self.machine.id}/revisions?from={self.label}&to={NOW}"

    @cached_property
    def compared(self) -> Compared | None:
        """Comparison of the two; None where it is asked for by itself."""
        if self.states is None:
            return None
        labels = (self.label, NOW)
        export = DifferencesExport(labels, documents_of(*self.states), catalogues_of(*self.states), self.place)
        return Compared(export, self.reader)

    @cached_property
    def by_number(self) -> Mapping[int, ComparedAxis]:
        """Axes that differ, by their numbers, as far as they are shown."""
        return {row.number: row for row in self.compared.rows} if self.compared else {}

    @cached_property
    def changed(self) -> frozenset[int]:
        """Numbers of the axes that are new, or differ from the revision."""
        if self.compared is None:
            return frozenset(axis.number for axis in self.machine.items if axis.updated > self.line.created)
        return frozenset(axis.number for axis in self.compared.found.axes if axis.change != "removed")

    @cached_property
    def counts(self) -> Mapping[str, int]:
        """Numbers of the axes that are new, were removed, or are changed, and of those by what became of their gear."""
        if self.compared is None:
            return {}
        axes = self.compared.found.axes
        kinds = {name: sum(axis.change == name for axis in axes) for name in ("changed", "added", "removed")}
        return kinds | {"other": len(self.compared.other), "lost": len(self.compared.lost)}

    @cached_property
    def rows(self) -> Sequence[ComparedAxis]:
        """Axes that stand beside the table: without a suitable gear first, then with another one, then by effect."""
        return [row for row in self.by_number.values() if row.after][:MOST_SHOWN]

    @property
    def left_out(self) -> int:
        """Number of those that do not."""
        return len(self.changed) - len(self.rows)

    @property
    def removed(self) -> Sequence[str]:
        """Names of the axes that the revision alone has."""
        compared = self.compared
        return [
            compared.names[axis.number]
            for axis in (compared.found.axes if compared else ())
            if compared and axis.change == "removed"
        ]


async def since_of(
    request: Request, machine: Machine, lines: Sequence[RevisionLine], *, whole: bool = False
) -> Since | None:
    """Changes since the latest revision, compared at once where axes are few or all of them are wanted; None without a
    revision.
    """
    if not lines:
        return None
    line = lines[0]
    compares = whole or max(line.axes, len(machine.items)) <= FEW_AXES
    states = await states_of(request, machine, line.label, NOW) if compares else None
    return Since(machine, line, states, current())


@or_reason(REASON)
async def show_since(request: Request) -> Response:
    """Changes of a machine of any size since its latest revision; one without leads to where the first is saved."""
    machine = await found(request, request.path_params["machine"], None, "machine")
    since = await since_of(request, machine, await request.app.state.store.revisions(machine.id), whole=True)
    if since is None:
        return RedirectResponse(f"{ADDRESS}/{machine.id}/revisions", 303)
    return await compute(request, "batches", page, request, "machine_since.html", saved=machine, since=since)


router = APIRouter(include_in_schema=False, dependencies=[needs("fleet")])
router.add_api_route(f"{ADDRESS}/{{machine}}/since", show_since, dependencies=[admit("reading")])

"""Page of the fewest kinds of gears of a machine: the curve, and the steps that are worth a decision."""

from collections.abc import Mapping
from typing import Any, NamedTuple
from xml.etree.ElementTree import Element

from fastapi import APIRouter
from starlette.requests import Request
from starlette.responses import Response

from hpn.catalogue import Catalogue
from hpn.documents.kinds import KindsStep, MachineKinds
from hpn.explain.drawings.kinds import kinds_curve
from hpn.store import Machine
from hpn.web.door.access import admit
from hpn.web.door.pools import compute
from hpn.web.door.problems import needs
from hpn.web.door.visit import current
from hpn.web.edits import kinds_in
from hpn.web.machines import machine_of
from hpn.web.pages.machine_view import ADDRESS, REASON
from hpn.web.pages.rendering import or_reason, page


class Decision(NamedTuple):
    """Step with fewer kinds than now, and its additional mass in kg, which may be 0."""

    step: KindsStep
    more_kg: float


class KindsView(NamedTuple):
    """Fewest kinds for the page."""

    fewest: MachineKinds
    decisions: list[Decision]
    drawing: Element | None
    names: Mapping[int, str]


@or_reason(REASON)
async def show_kinds(request: Request) -> Response:
    """Page of a machine's fewest kinds."""
    machine = await machine_of(request, request.path_params["machine"], None, "machine")
    return await compute(request, "batches", _page, request, machine)


def _page(request: Request, machine: Machine) -> Response:
    values: dict[str, Any] = {"saved": machine, "may_change": request.app.state.gate.may_change(request, machine.owner)}
    return page(request, "machine_kinds.html", kinds=view_of(machine, request.app.state.catalogue), **values)


def view_of(machine: Machine, catalogue: Catalogue) -> KindsView:
    """Fewest kinds, the steps worth a decision from the most kinds down, and their drawing."""
    kinds = kinds_in(machine, catalogue)
    names = {axis.number: axis.name or str(axis.number) for axis in machine.items}
    drawing = kinds_curve([(step.count, step.weight_kg) for step in kinds.kinds], current())
    return KindsView(kinds, _decisions(kinds), drawing, names)


def _decisions(kinds: MachineKinds) -> list[Decision]:
    """Steps below the first, except those that a step with fewer kinds matches without more mass."""
    if not kinds.kinds:
        return []
    now, *fewer = kinds.kinds
    return [
        Decision(step, step.weight_kg - now.weight_kg)
        for at, step in enumerate(fewer)
        if not any(less.weight_kg <= step.weight_kg for less in fewer[at + 1 :])
    ]


router = APIRouter(include_in_schema=False, dependencies=[needs("fleet")])
router.add_api_route(f"{ADDRESS}/{{machine}}/kinds", show_kinds, dependencies=[admit("reading")])

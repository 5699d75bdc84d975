"""Machines from tables: a table is uploaded, its columns are corrected, all its axes are sized, the result is stored.

`POST /machines` answers with the meaning of each column, or, once no question is open, redirects to the page of the
result (`machine.py`). Modules that need Arrow are imported within the requests that use them.
"""

import hashlib
from collections.abc import Awaitable, Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from types import MappingProxyType
from typing import Any, NamedTuple

from fastapi import APIRouter
from starlette.requests import Request
from starlette.responses import RedirectResponse, Response

from hpn import ENGINE_VERSION
from hpn.catalogue import Catalogue
from hpn.documents.axis import phases_of
from hpn.fleet.beside import read_machine
from hpn.fleet.faults import CellFault
from hpn.fleet.order import MOST_AXES, MOST_PHASES
from hpn.links.symbols import AXIS_INPUTS
from hpn.store import MachineDraft, NoRoomError, ShareSpentError, StoreUnavailableError
from hpn.store.machines import MOST_OF_CALLER
from hpn.tables.files import TableBounds
from hpn.tables.reading import Reading
from hpn.web.columns import drafts_of
from hpn.web.door.access import admit
from hpn.web.door.hosts import require_same_origin
from hpn.web.door.observation import note
from hpn.web.door.pools import compute, compute_beside
from hpn.web.door.problems import Problem, needs
from hpn.web.door.uploads import read_all_parts
from hpn.web.fleets import worked as worked_beside
from hpn.web.pages.machine_of_selections import axes_of
from hpn.web.pages.machine_view import ADDRESS
from hpn.web.pages.reading import work_of
from hpn.web.pages.table_upload import NOTHING, TableUpload, content_of, show_form
from hpn.words.wording import N_, Quantity, Sentence

NO_ROOM_SECONDS = 3600
UNAVAILABLE = N_("Machines are temporarily unavailable: try again in a few seconds.")
TOO_MANY = N_(
    "The table has {found} axes, and the limit of a page is {most}: size it with the command hpn fleet or POST "
    "/api/v1/fleet, which have no such limit."
)
TOO_LONG = N_(
    "The axes have {found} phases, and the limit of a page is {most}: size them with the command hpn fleet or POST "
    "/api/v1/fleet, which have no such limit."
)
LARGER = N_("For larger tables use the command hpn fleet or POST /api/v1/fleet, which have no such limit.")
SHARE_SPENT = N_(
    "Unsaved machines are kept for a day, and {most} of them are yours. Save or delete one on its page, then size "
    "this table again."
)
NO_ROOM = N_(
    "Unsaved machines are kept for a day, and the space for them is full. The command hpn fleet and POST "
    "/api/v1/fleet size this table; here there is space again as soon as others are saved or expire."
)

EXAMPLE_HEAD = "axis,torque_Nm,speed_rpm,duration_s,pause_s,emergency_stop.torque_Nm,output_load.radial_N"
EXAMPLE_AXES: Mapping[str, str] = {
    N_("Infeed belt"): '"[21,9]","[150,300]","[0.3,1.2]",0.4,40,400',
    N_("Indexing table"): '"[14,-12]","[120,120]","[0.25,0.25]",0.5,45,',
    N_("Tool arm"): '"[38,24,-20]","[60,180,60]","[0.8,0.6,0.4]",1,90,900',
    N_("Layer pusher"): '"[52,31]","[220,220]","[0.4,1.1]",1.5,160,600',
    N_("Lift"): '"[96,70,41]","[160,160,160]","[0.5,2,0.5]",3,260,1200',
}
"""Axes of an example machine: their names, and their cells after the name."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Upload(TableUpload):
    """Table of axes as read; `axes` is set once no question is left."""

    axes: "AxesToSize | None" = field(default=None, repr=False)


class AxesToSize(NamedTuple):
    """Axes to size, faults of their cells, and for each axis its rows in a table of cells."""

    rows: Sequence[Mapping[str, Any]]
    faults: Sequence[CellFault] = ()
    origins: Mapping[str, Sequence[int]] = MappingProxyType({})


# --- Uploading --------------------------------------------------------------------------------------------------------


async def upload(request: Request) -> Response:
    """Show how each column is read, or size the axes and redirect to their page; `new` begins an empty machine, or one
    of the marked saved selections.
    """
    draft, refusal = Upload(), None
    try:
        require_same_origin(request)
        all_parts = await read_all_parts(request, request.app.state.settings.maximum_batch_body_bytes)
        parts = dict(all_parts)
        if parts.get("new") == b"selections":
            marked = [part.decode(errors="replace") for name, part in all_parts if name == "id"]
            return RedirectResponse(f"{ADDRESS}/{await _store(request, partial(_of_selections, marked))}", 303)
        if parts.get("new"):
            return RedirectResponse(f"{ADDRESS}/{await _store_axes(request, AxesToSize(()))}?edit=common", 303)
        draft = Upload(text=parts.get("text", b"").decode(errors="replace"))
        draft = await _read(request, parts)
        if draft.axes:
            return RedirectResponse(f"{ADDRESS}/{await _store_axes(request, draft.axes)}", 303)
    except (Problem, StoreUnavailableError) as error:
        refusal = error
    return await show_form(request, "machine_upload.html", draft, refusal, UNAVAILABLE, **WORDS)


async def _read(request: Request, parts: Mapping[str, bytes]) -> Upload:
    """Uploaded or carried table, read beside the service; `axes` is set once no question is left."""
    content = await content_of(request, parts, parts.get("text", b""))
    if not content.strip():
        return Upload().refused(Sentence(NOTHING))
    bounds = await compute(request, "pages", _bounds)
    fields = {name: part.decode(errors="replace") for name, part in parts.items() if name not in ("file", "table")}
    table = await compute_beside(
        request, "files", await compute(request, "pages", work_of, read_machine, content, bounds, fields)
    )
    if table.refusal:
        raise Problem(422, Sentence("{text}", {"text": table.refusal}))
    _require_few(table.axes, table.phases)
    if table.reading.suffix:
        return Upload(text=fields.get("text", ""), axes=AxesToSize(table.rows, table.faults))
    return await compute(request, "pages", _draft_of, fields, content, table.reading)


def _require_few(axes: int, phases: int) -> None:
    """Raise Problem 413 for more axes or phases than a machine may have."""
    for template, count, most in ((TOO_MANY, axes, MOST_AXES), (TOO_LONG, phases, MOST_PHASES)):
        if count > most:
            values = {"found": Quantity(count, "", 12), "most": Quantity(most, "", 12)}
            raise Problem(413, Sentence(template, values))


def _bounds() -> TableBounds:
    from hpn.web import axis_tables

    return axis_tables.BOUNDS


def _draft_of(fields: Mapping[str, str], content: bytes | str, reading: Reading) -> Upload:
    table, problems = reading.table, tuple[Sentence, ...]()
    assert table is not None
    if table.problem:
        problems = (table.problem, *([Sentence(LARGER)] if "most" in table.problem.values else ()))
    axes = AxesToSize(table.axes, (), table.origins) if table.whole and "size" in fields else None
    return Upload(text=fields.get("text", ""), problems=problems, axes=axes).as_read(content, reading)


async def _store_axes(request: Request, axes: AxesToSize) -> str:
    """Id of the stored machine of a table; raises Problem, or StoreUnavailableError."""
    return await _store(request, partial(_draft_with_answers, axes))


async def _store(request: Request, make: Callable[[Request], Awaitable[MachineDraft]]) -> str:
    """Id of a stored machine, made once there is room; raises Problem, or StoreUnavailableError."""
    store, most_bytes = request.app.state.store, request.app.state.settings.maximum_unsaved_fleet_bytes
    caller = hashlib.sha256(request.state.caller.encode()).hexdigest()  # no address is stored in plain text
    try:
        await store.require_room(caller, most_bytes)
        draft = await make(request)
        id: str = await store.keep_machine(replace(draft, owner=request.state.api_key, caller=caller), most_bytes)
    except ShareSpentError:
        refusal = Sentence(SHARE_SPENT, {"most": str(MOST_OF_CALLER)})
        raise Problem.later(refusal, NO_ROOM_SECONDS, 429) from None
    except NoRoomError:
        raise Problem.later(Sentence(NO_ROOM), NO_ROOM_SECONDS) from None
    note(request, machine=id)
    return id


async def _of_selections(ids: Sequence[str], request: Request) -> MachineDraft:
    """Draft of a machine with an axis of each saved selection; raises Problem."""
    catalogue = request.app.state.catalogue
    axes = await axes_of(request, ids)
    _require_few(len(axes), sum(phases_of(axis.application) for axis in axes))
    drafts = await compute(request, "batches", drafts_of, axes, {}, catalogue)
    return MachineDraft(drafts, ENGINE_VERSION, catalogue.version)


async def _draft_with_answers(axes: AxesToSize, request: Request) -> MachineDraft:
    """Draft of a table's machine, sized beside the service; raises Problem."""
    catalogue = request.app.state.catalogue
    work = await compute(request, "pages", _work, axes, catalogue)
    return MachineDraft(await worked_beside(request, work), ENGINE_VERSION, catalogue.version)


def _work(axes: AxesToSize, catalogue: Catalogue) -> Callable[[], Any]:
    from hpn.web.axis_tables import drafts_in

    return partial(drafts_in, axes.rows, axes.faults, dict(axes.origins), catalogue)


WORDS: dict[str, Any] = {
    "roles": AXIS_INPUTS.by_role,
    "example_head": EXAMPLE_HEAD,
    "example_axes": EXAMPLE_AXES,
}
"""Texts of the form for a table, and of the example beside it."""

router = APIRouter(include_in_schema=False, dependencies=[needs("fleet")])
router.add_api_route(ADDRESS, upload, methods=["POST"], dependencies=[admit("batch")])

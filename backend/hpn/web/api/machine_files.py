"""Files of machines: report, gear list, axes as tables, one axis, and differences between two states."""

from collections.abc import Callable
from datetime import UTC, datetime
from functools import partial
from typing import Annotated, Any

from fastapi import APIRouter, Depends, Query
from starlette.requests import Request
from starlette.responses import Response

from hpn.catalogue import Catalogue
from hpn.documents.revision import NOW, TODAY, Frozen, label_key
from hpn.files.export import Export, ExportTitle
from hpn.files.formats import FileFormat
from hpn.files.machine.export import MachineExport, exports_of, pages_of
from hpn.store import Machine
from hpn.web.api import schemas
from hpn.web.api.axes import Number
from hpn.web.api.files import FILES, File, Lang, Options, answer_file, described
from hpn.web.api.machines import ADDRESS
from hpn.web.archive import no_revision
from hpn.web.door.access import admit
from hpn.web.door.problems import Problem, needs
from hpn.web.door.visit import absolute
from hpn.web.machines import machine_of, no_axis
from hpn.web.states import State, differences, document_of, state_of, states_of
from hpn.words.wording import N_, Sentence

XLSX = next(file.media_type for file in FILES if file.name.endswith(".xlsx"))
MOST_LIST = 2000
"""Maximum characters of a list of axes."""

NOT_KEPT = N_("the catalogue of that time is not kept, and without it there are no figures for the file")
OPEN = N_("axis {number} is open: it has no answer for a file")
OF_AN_AXIS = ("report.pdf", "submodel.aasx")

Axes = Annotated[
    str | None,
    Query(
        max_length=MOST_LIST,
        description="Axes with pages of their own: numbers and ranges, or none.",
        examples=["3,7-20"],
    ),
]
Full = Annotated[bool, Query(description="Adds the whole calculation of each axis, for at most 100 axes.")]
Revision = Annotated[str, Query(max_length=20, description="Label of a revision; now for the working copy.")]
Before = Annotated[str, Query(alias="from", max_length=20, description="Label of a revision, now or today.")]
After = Annotated[str, Query(alias="to", max_length=20, description="Label of a revision, now or today.")]


def _pages(axes: Axes = None, full: Full = False) -> Options:
    return {"axes": axes, "full": full}


REPORT = File(
    "report.pdf",
    "MachineReport",
    "application/pdf",
    "PDF report of a machine",
    FileFormat("hpn.files.machine.pdf:pdf", ("report",)),
    disposition="inline",
    options=_pages,
    stem="machine",
)
GEARS = File(
    "gears.xlsx",
    "GearList",
    XLSX,
    "Gear list of a machine as a workbook",
    FileFormat("hpn.files.machine.gears:gears", ("serve",)),
    stem="gears",
)
TABLES = (
    File(
        "axes.csv",
        "AxesAsCsv",
        "text/csv",
        "Axes of a machine as CSV",
        FileFormat("hpn.fleet.machine_axes:csv", ("fleet",), is_translated=False),
        stem="axes",
    ),
    File(
        "axes.parquet",
        "AxesAsParquet",
        "application/vnd.apache.parquet",
        "Axes of a machine as Parquet",
        FileFormat("hpn.fleet.machine_axes:parquet", ("fleet",), is_translated=False),
        stem="axes",
    ),
)
DIFFERENCES = (
    File(
        "differences.pdf",
        "DifferencesAsPdf",
        "application/pdf",
        "Differences of two states as PDF",
        FileFormat("hpn.files.machine.changes_pdf:pdf", ("report",)),
        disposition="inline",
        stem="differences",
    ),
    File(
        "differences.xlsx",
        "DifferencesAsWorkbook",
        XLSX,
        "Differences of two states as a workbook",
        FileFormat("hpn.files.machine.changes_workbook:workbook", ("serve",)),
        stem="differences",
    ),
)

router = APIRouter(prefix=f"{ADDRESS}/{{id}}", tags=["Files"], dependencies=[admit("reading")])


def _add(file: File, route: Callable[..., Any], source: str, path: str = "", noun: str = "") -> None:
    reader = ", in the reader’s language and units" if file.format.is_translated else ""
    router.add_api_route(
        f"{path}/{file.name}",
        route,
        operation_id=f"get{noun or file.noun}",
        response_class=Response,
        summary=file.summary,
        dependencies=[needs(file.format.extras[0])],
        description=f"{file.summary}. Made from {source}{reader}.",
        responses=described(file) | schemas.HAS_IT_ALREADY | schemas.problems(403, 404, 409, 422, 501),
    )


def _route(file: File) -> None:
    Chosen = Annotated[Options, Depends(file.options)]

    async def of_machine(
        request: Request, id: schemas.Id, chosen: Chosen, revision: Revision = NOW, lang: Lang = None
    ) -> Response:
        machine, state = await _state(request, id, revision)
        before = None if file in TABLES else await _before(request, machine, state)
        make = partial(_export_of, request, machine, state, before)
        if file in TABLES:
            return await answer_file(request, file, lang, chosen, lambda: make().document)
        if file is REPORT:
            return await answer_file(request, file, lang, chosen, lambda: _paged(make(), chosen))
        return await answer_file(request, file, lang, chosen, make)

    _add(file, of_machine, "the working copy or a revision")


def _route_of_axis(file: File) -> None:
    Chosen = Annotated[Options, Depends(file.options)]

    async def of_axis(
        request: Request,
        id: schemas.Id,
        number: Number,
        chosen: Chosen,
        revision: Revision = NOW,
        lang: Lang = None,
    ) -> Response:
        machine, state = await _state(request, id, revision)
        return await answer_file(
            request, file, lang, chosen, lambda: _axis(_export_of(request, machine, state, None), number)
        )

    _add(file, of_axis, "an axis of the working copy or of a revision", "/axes/{number}", f"Axis{file.noun}")


def _route_of_differences(file: File) -> None:
    async def of_differences(
        request: Request, id: schemas.Id, before: Before, after: After, lang: Lang = None
    ) -> Response:
        machine = await machine_of(request, id)
        states = await states_of(request, machine, before, after)
        return await answer_file(
            request, file, lang, {}, lambda: differences(request, machine, (before, after), states)
        )

    _add(file, of_differences, "two states, each a revision, the working copy or today’s answer")


for _file in (REPORT, GEARS, *TABLES):
    _route(_file)
for _file in FILES:
    if _file.name in OF_AN_AXIS:
        _route_of_axis(_file)
for _file in DIFFERENCES:
    _route_of_differences(_file)


# --- Content of a file ------------------------------------------------------------------------------------------------


async def _state(request: Request, id: str, revision: str) -> tuple[Machine, State]:
    machine = await machine_of(request, id)
    if label_key(revision) == TODAY:
        raise no_revision(f"/{machine.kind}s/{id}", revision, await request.app.state.store.revisions(id))
    return machine, await state_of(request, machine, revision)


async def _before(request: Request, machine: Machine, state: State) -> tuple[str, bytes] | None:
    """Label and content of the revision before a state; None for the first."""
    lines = await request.app.state.store.revisions(machine.id)
    older = [line for line in lines if state.line is None or line.number < state.line.number]
    latest = await request.app.state.store.revision(machine.id, older[0].label) if older else None
    return None if latest is None else (older[0].label, latest[1])


def _export_of(request: Request, machine: Machine, state: State, before: tuple[str, bytes] | None) -> MachineExport:
    document, line = _document(state), state.line
    label, author = (line.label, line.author) if line else ("", None)
    heading = ExportTitle(document.title or "", document.reference or "", author or document.author or "", label)
    earlier = document_of(before[1]) if before else None
    return MachineExport(
        document=document,
        catalogue=_catalogue(state),
        link=absolute(request, f"/machines/{machine.id}" + (f"?revision={label}" if label else "")),
        heading=heading,
        created=line.created if line else None,
        moment=datetime.now(UTC),
        before=(before[0], earlier) if before and earlier else None,
    )


def _document(state: State) -> Frozen:
    document = document_of(state.content)
    assert document is not None  # files of `today` are refused before
    return document


def _catalogue(state: State) -> Catalogue:
    if state.catalogue is None:
        raise Problem(409, Sentence(NOT_KEPT))
    return state.catalogue


def _paged(export: MachineExport, chosen: Options) -> MachineExport:
    """Export, after a check that its pages can be made; raises InputError as `pages_of` does."""
    pages_of(export.document, **chosen)
    return export


def _axis(export: MachineExport, number: int) -> Export:
    axis = next((axis for axis in export.document.axes if axis.number == number), None)
    if axis is None:
        raise no_axis(number)
    ((_, selection),) = exports_of(export, [axis])
    if selection is None:
        raise Problem(409, Sentence(OPEN, {"number": str(number)}))
    return selection

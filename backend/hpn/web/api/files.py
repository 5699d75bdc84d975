"""Files of selections: report, workbook and Asset Administration Shell of a saved, posted or linked application."""

from collections.abc import Callable
from dataclasses import dataclass, fields, replace
from datetime import UTC, datetime
from functools import cache, partial
from typing import Annotated, Any, Literal

import msgspec
from fastapi import APIRouter, Depends, Query
from pydantic import ValidationError
from starlette.requests import Request
from starlette.responses import Response

from hpn.application import Application
from hpn.catalogue import Catalogue
from hpn.catalogue.ordering import ordering_code
from hpn.engine.selection import select, with_gear
from hpn.files import formats
from hpn.files.aas import Metamodel
from hpn.files.export import DIGITS, Export, ExportTitle
from hpn.files.formats import FileFormat
from hpn.links.labels import query_of as query_of_labels
from hpn.links.writer import to_link
from hpn.store import SavedSelection
from hpn.web.api import schemas
from hpn.web.archive import answer_of, url_of, with_catalogue
from hpn.web.door.access import admit
from hpn.web.door.bodies import parsed, read_body
from hpn.web.door.conditions import etag_of, has_already
from hpn.web.door.pools import pool_of, while_present
from hpn.web.door.problems import Problem, needs
from hpn.web.door.visit import absolute
from hpn.web.form.linked import linked, query_of
from hpn.words.reader import Reader

SCHEMA_TYPE = "application/schema+json"

Lang = Annotated[Literal["en", "de"] | None, Query(description="Language; by default the browser’s.")]
Make = Callable[[], Any]
"""Function that makes a file's subject: the export of a selection or machine, or a document."""


Options = dict[str, Any]
"""Options of a kind of file beside its language, by parameters of the function that makes it."""


def _nothing() -> Options:
    return {}


def _metamodel(
    aas: Annotated[
        Metamodel, Query(description="Version of the AAS metamodel whose namespace the package uses.")
    ] = "3.0",
) -> Options:
    return {"metamodel": aas}


@dataclass(frozen=True, slots=True)
class File:
    """Kind of file: file name, noun in operation ids, media type, summary, format (made beside the service), options,
    and the `stem` of its name, blank for files named after a gear.
    """

    name: str
    noun: str
    media_type: str
    summary: str
    format: FileFormat
    disposition: str = "attachment"
    options: Callable[..., Options] = _nothing
    stem: str = ""

    def named(self, export: Any) -> str:
        """File name for a download; always ASCII."""
        return f"{self.stem or export.candidate.designation}.{self.name.rpartition('.')[2]}"

    def content(self, export: Any, reader: Reader, chosen: Options) -> "partial[bytes]":
        """Call that makes the file, for a process that imports nothing of the web."""
        return partial(self.format.content, export, reader, **chosen)


FILES = (
    File("report.pdf", "Report", "application/pdf", "PDF report", formats.PDF, "inline"),
    File(
        "report.xlsx",
        "Workbook",
        "application/vnd.openxmlformats-officedocument.spreadsheetml.sheet",
        "Workbook of numbers, the handbook’s equations live on one sheet",
        formats.WORKBOOK,
    ),
    File(
        "submodel.aasx",
        "Submodel",
        "application/asset-administration-shell-package",
        "Asset Administration Shell: technical data and selection",
        formats.PACKAGE,
        options=_metamodel,
    ),
)

saved_files = APIRouter(prefix="/api/v1/selections/{id}", tags=["Files"], dependencies=[admit("reading")])
posted_files = APIRouter(prefix="/api/v1", tags=["Files"], dependencies=[admit("calculator")])
linked_files = APIRouter(include_in_schema=False, dependencies=[admit("calculator")])


def described(file: File) -> dict[int | str, dict[str, Any]]:
    """OpenAPI entry of the answer with a file."""
    return {
        200: {
            "description": "The file.",
            "content": {file.media_type: {"schema": {"type": "string", "format": "binary"}}},
            "headers": schemas.headers("ETag", "Content-Disposition", "Content-Language"),
        }
    }


def _route(file: File) -> None:
    content = described(file)
    Chosen = Annotated[Options, Depends(file.options)]

    async def of_saved(
        request: Request, id: schemas.Id, chosen: Chosen, lang: Lang = None, revision: schemas.Revision = None
    ) -> Response:
        saved, catalogue = await with_catalogue(request.app.state, id, revision)
        return await answer_file(request, file, lang, chosen, lambda: _of_saved(saved, catalogue, request))

    async def of_posted(request: Request, chosen: Chosen, lang: Lang = None) -> Response:
        body = await read_body(request)
        return await answer_file(request, file, lang, chosen, lambda: _computed(parsed(Application, body), request))

    async def of_link(request: Request, chosen: Chosen, lang: Lang = None) -> Response:
        query = await query_of(request)
        return await answer_file(request, file, lang, chosen, lambda: _linked(query, request))

    shared: dict[str, Any] = {
        "response_class": Response,
        "summary": file.summary,
        "dependencies": [needs(file.format.extras[0])],
    }
    saved_files.add_api_route(
        f"/{file.name}",
        of_saved,
        operation_id=f"getSelection{file.noun}",
        **shared,
        description=f"{file.summary}. Made from a saved selection, as it was saved.",
        responses=content | schemas.HAS_IT_ALREADY | schemas.problems(404, 409, 422, 501),
    )
    posted_files.add_api_route(
        f"/{file.name}",
        of_posted,
        operation_id=f"make{file.noun}",
        methods=["POST"],
        description=f"{file.summary}. Made from an application, computed now; nothing is saved.",
        openapi_extra=schemas.request_body(Application),
        responses=content | schemas.problems(400, 408, 413, 415, 422, 501),
        **shared,
    )
    linked_files.add_api_route(f"/{file.name}", of_link, methods=["GET", "POST"], **shared)


for _file in FILES:
    _route(_file)


@posted_files.get(
    "/application.schema.json",
    operation_id="getApplicationSchema",
    summary="JSON Schema of an application",
    responses=schemas.problems(422)
    | {200: {"description": "The schema.", "content": {SCHEMA_TYPE: {"schema": {"type": "object"}}}}},
    response_class=Response,
)
async def application_schema() -> Response:
    """JSON Schema of an application, with the unit of every field."""
    return Response(_schema(), media_type=SCHEMA_TYPE)


@cache
def _schema() -> bytes:
    schema = {"$schema": "https://json-schema.org/draft/2020-12/schema", "$id": "application.schema.json"}
    return msgspec.json.encode(schema | Application.model_json_schema())


# --- Content of a file ------------------------------------------------------------------------------------------------


def _of_saved(saved: SavedSelection, catalogue: Catalogue | None, request: Request) -> Export:
    """Export of a saved selection as saved; computes nothing again."""
    try:
        application = Application.model_validate_json(saved.application)
    except ValidationError:
        raise Problem(409, "the saved input does not fit this version’s model any more") from None
    return Export(
        application=application,
        selection=answer_of(saved),
        link=absolute(request, url_of(saved.id)),
        heading=ExportTitle(*(getattr(saved, part.name) or "" for part in fields(ExportTitle))),
        created=saved.created,
        catalogue=catalogue,
        reply=saved.result,
        chosen=saved.designation or "",
    )


def _computed(application: Application, request: Request) -> Export:
    catalogue, link = request.app.state.catalogue, to_link(application)
    selection = select(application, catalogue, to_link)
    gear = catalogue.by_designation[selection.foremost.designation]
    return Export(
        application=application,
        selection=selection,
        link=absolute(request, link),
        heading=ExportTitle(ordering_code=ordering_code(catalogue, gear).text),
        moment=datetime.now(UTC),
        catalogue=catalogue,
    )


def _linked(query: str, request: Request) -> Export:
    """Export of a link with its labels and chosen gear, as the live page shows them."""
    link, catalogue = linked(query, "lang", "aas"), request.app.state.catalogue
    export = _computed(link.application, request)
    if link.gear and catalogue.find(link.gear) is None:
        raise Problem(422, f"gear {link.gear[:40]!r} is not in the catalogue", [(("gear",), "is not in the catalogue")])
    if link.gear:
        export = _of_gear(export, catalogue.find(link.gear).designation)
    labels, gear = link.labels, catalogue.by_designation[export.candidate.designation]
    code = ordering_code(catalogue, gear, labels["order_output"], labels["order_motor"])
    heading = ExportTitle(labels["title"], labels["ref"], labels["author"], labels["rev"], code.text)
    return replace(export, heading=heading, link=export.link + query_of_labels({**labels, **code.labels}))


def _of_gear(export: Export, designation: str) -> Export:
    """Export with a chosen gear; a gear outside the required sizes and ratios comes last."""
    assert export.catalogue is not None
    selection = with_gear(export.selection, export.application, export.catalogue, designation)
    return replace(export, selection=selection, link=f"{export.link}&gear={designation}", chosen=designation)


# --- Making it --------------------------------------------------------------------------------------------------------


async def answer_file(request: Request, file: File, lang: str | None, chosen: Options, make: Make) -> Response:
    """Response with a file, made beside the service; 304 if the caller has it already."""
    reader = file_reader(request, lang)

    pool = pool_of(request, "exports")

    async def work() -> tuple[bytes, str]:
        async with pool.turn:
            export = await pool.run(make)
            return await pool.run_beside(file.content(export, reader, chosen)), file.named(export)

    with pool.place():
        content, name = await while_present(request, work())
    headers = {"ETag": etag_of(content), "Cache-Control": "no-cache", "Vary": "Accept-Language, Cookie"}
    if request.method == "GET" and has_already(request, headers["ETag"]):
        return Response(status_code=304, headers=headers)
    headers |= {"Content-Language": reader.language, "Content-Disposition": f'{file.disposition}; filename="{name}"'}
    return Response(content, headers=headers, media_type=file.media_type)


def file_reader(request: Request, lang: str | None) -> Reader:
    """Reader of a file: the requested language, else the reader's own, and the reader's units."""
    reader: Reader = request.state.reader
    return replace(reader, language=lang or reader.language, digits=DIGITS)

"""`POST /api/v1/fleet`: a table of axes as a file, answered by a table as a file of the same format."""

import os
from collections.abc import Callable, Iterable, Iterator
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Annotated, BinaryIO
from urllib.parse import quote

from fastapi import APIRouter, Query
from starlette.datastructures import State
from starlette.requests import Request
from starlette.responses import Response, StreamingResponse
from starlette.types import Receive, Scope, Send

from hpn.fleet.order import LINES_GONE, TWO_GONE
from hpn.web.api import schemas
from hpn.web.door.access import admit
from hpn.web.door.bodies import NDJSON, content_type_of, pass_body, wrong_type
from hpn.web.door.disk import SpoolShare
from hpn.web.door.pools import pool_of
from hpn.web.door.problems import Problem, needs
from hpn.web.door.uploads import MULTIPART
from hpn.web.fleets import Kind, Tables, size_fleet, workplace
from hpn.web.settings import Settings

MEDIA_TYPES = {
    ".parquet": "application/vnd.apache.parquet",
    ".arrow": "application/vnd.apache.arrow.file",
    ".csv": "text/csv",
}
"""Formats of tables by suffix."""

READ_TYPES = {".arrows": "application/vnd.apache.arrow.stream", ".csv.gz": "application/gzip"}
"""Formats that are only read."""

SUFFIXES = {media_type: suffix for suffix, media_type in (MEDIA_TYPES | READ_TYPES).items()}
IGNORED = "HPN-Ignored-Columns"
"""Header with the names of pandas' index columns, each in quotes and percent-encoded."""

GONE = {MULTIPART: f"a form with two tables {TWO_GONE}"} | dict.fromkeys(NDJSON, LINES_GONE)
"""Content types that are no longer accepted, and texts that name the replacement."""

READ_BYTES = 64 * 1024
MOST_IGNORED, MOST_NAME = 100, 200
"""Maximum columns that a request can leave out, and characters of a column's name."""

router = APIRouter(prefix="/api/v1", tags=["Selection"], dependencies=[admit("batch"), needs("fleet")])


@router.post(
    "/fleet",
    operation_id="sizeFleet",
    summary="Select gears for a table of axes",
    openapi_extra=schemas.fleet_body((*MEDIA_TYPES.values(), *READ_TYPES.values())),
    responses=schemas.fleet_answers(MEDIA_TYPES.values(), 400, 408, 413, 415, 422, 501),
    response_class=Response,
)
async def size(
    request: Request,
    give: Annotated[
        Kind,
        Query(
            description="Table to return: the answers, a row for each axis; the rejected, a row for each fault of an "
            "axis; or the candidates, a row for each gear that an axis allows."
        ),
    ] = "answers",
    ignore: Annotated[
        list[Annotated[str, Query(max_length=MOST_NAME)]],
        Query(description="Columns to ignore because they are not part of an application.", max_length=MOST_IGNORED),
    ] = [],  # noqa: B006
) -> Response:
    """Returns one row per axis, in the order of the input; an error in one axis never affects the others.

    A row of the input is an axis or a phase. The answer is a table in the format of the input (Arrow’s file format for
    an Arrow stream, CSV for gzipped CSV), sent when it is complete. Index columns written by pandas are ignored and
    named in `HPN-Ignored-Columns`.
    """
    state: State = request.app.state
    with state.disk.share() as share:
        async with workplace(request) as folder:
            tables = replace(await _receive(request, folder, share), ignored=tuple(ignore))
            files = await size_fleet(request, tables, candidates=give == "candidates")
            return TableFile(files.by_kind[give], files.ignored)


class TableFile(StreamingResponse):
    """Table read from its file; the file may be removed from its folder before it is sent."""

    def __init__(self, path: Path, ignored: Iterable[str]) -> None:
        self._file: BinaryIO = path.open("rb")
        pieces: Iterator[bytes] = iter(partial(self._file.read, READ_BYTES), b"")
        headers = {
            "Content-Length": str(os.fstat(self._file.fileno()).st_size),
            "Content-Disposition": f'attachment; filename="{path.name}"',
            "Cache-Control": "no-store",
        }
        if names := [f'"{quote(name)}"' for name in ignored]:
            headers[IGNORED] = ", ".join(names)
        super().__init__(pieces, headers=headers, media_type=MEDIA_TYPES[path.suffix])

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Send the table and close its file."""
        with self._file:
            await super().__call__(scope, receive, send)


# --- Receiving the table ----------------------------------------------------------------------------------------------


async def _receive(request: Request, folder: Path, share: SpoolShare) -> Tables:
    """Table of a request in a file; raises Problem as `pass_body` does, 415 for any other, 400 for a type in GONE."""
    content_type = content_type_of(request)
    if content_type in GONE:
        raise Problem(400, GONE[content_type])
    if content_type not in SUFFIXES:
        raise wrong_type(request, ", ".join((*MEDIA_TYPES.values(), *READ_TYPES.values())))
    path = folder / f"input{SUFFIXES[content_type]}"
    with path.open("wb") as file:
        await _pass_on(request, share, file.write)
    return Tables(path)


async def _pass_on(request: Request, share: SpoolShare, write: Callable[[bytes], object]) -> None:
    settings: Settings = request.app.state.settings
    pool = pool_of(request, "fleets")

    async def take(piece: bytes) -> None:
        share.take(len(piece))
        await pool.run(write, piece)  # a slow disk delays no other request

    await pass_body(
        request,
        take,
        maximum_bytes=settings.maximum_fleet_bytes,
        pause_seconds=settings.body_seconds,
        seconds=settings.fleet_seconds,
    )

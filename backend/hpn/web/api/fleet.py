"""`POST /api/v1/fleet`: a table of axes in a file, answered by a table in a file of the same format."""

import os
from collections.abc import Iterable, Iterator
from contextlib import ExitStack
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

from hpn.fleet.order import ANSWERED_IN, suffix_of
from hpn.web.api import schemas
from hpn.web.door.access import admit
from hpn.web.door.bodies import NDJSON, content_type_of, pass_body, wrong_type
from hpn.web.door.disk import Share
from hpn.web.door.hosts import require_same_origin
from hpn.web.door.pools import pool_of
from hpn.web.door.problems import Problem, needs
from hpn.web.door.uploads import MULTIPART, FormSplitter, PartHead, Write
from hpn.web.fleets import Kind, Tables, size_fleet, workplace
from hpn.web.settings import Settings

MEDIA_TYPES = {
    ".parquet": "application/vnd.apache.parquet",
    ".arrow": "application/vnd.apache.arrow.file",
    ".csv": "text/csv",
    ".ndjson": NDJSON[0],
}
"""Formats of tables by suffix."""

READ_TYPES = {".arrows": "application/vnd.apache.arrow.stream", ".csv.gz": "application/gzip"}
"""Formats that are read and not written."""

SUFFIXES = {media_type: suffix for suffix, media_type in (MEDIA_TYPES | READ_TYPES).items()} | dict.fromkeys(
    NDJSON, ".ndjson"
)
IGNORED = "HPN-Ignored-Columns"
"""Header with the names of index columns that pandas wrote, each in quotes and percent-encoded."""

PARTS = ("input", "axes")
READ_BYTES = 64 * 1024
MOST_IGNORED, MOST_NAME = 100, 200
"""Columns that are left out by their names, and characters of a name."""

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
        Query(description="Columns to leave out, since no application has them.", max_length=MOST_IGNORED),
    ] = [],  # noqa: B006
) -> Response:
    """A row for each axis, in its order; an error in one never affects the others.

    As one table with a row for each axis, or as a form with a table of phases and one of the other inputs of each
    axis. The answer is a table in the format of the input (Arrow’s file format for a stream, CSV for CSV in gzip), and
    comes when it is complete. Index columns that pandas wrote are ignored, and named in `HPN-Ignored-Columns`.
    """
    state: State = request.app.state
    if content_type_of(request) == MULTIPART:  # which a page of any site may send without asking
        require_same_origin(request, *state.settings.cors_origins)
    with state.disk.share() as share:
        async with workplace(request) as folder:
            tables = replace(await _received(request, folder, share), ignored=tuple(ignore))
            files = await size_fleet(request, tables, candidates=give == "candidates")
            return TableFile(files.by_kind[give], files.ignored)


class TableFile(StreamingResponse):
    """A table, read from its file, which may lose its name before it is sent."""

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
        """Send it."""
        with self._file:
            await super().__call__(scope, receive, send)


# --- What arrives -----------------------------------------------------------------------------------------------------


async def _received(request: Request, folder: Path, share: Share) -> Tables:
    """The tables of a request, in files; raises Problem as `pass_body` does, 415 for what is no table."""
    content_type = content_type_of(request)
    with ExitStack() as stack:
        if content_type == MULTIPART:
            form = _Form(folder, stack)
            splitter = FormSplitter(request.headers["content-type"], form.begin)
            await _pass_on(request, share, splitter.feed)
            if not splitter.ended:
                raise Problem(400, "the form has no end, or its Content-Type names no boundary")
            return form.tables()
        if content_type not in SUFFIXES:
            raise wrong_type(request, f"{', '.join((*MEDIA_TYPES.values(), *READ_TYPES.values()))} or {MULTIPART}")
        path = folder / f"input{SUFFIXES[content_type]}"
        await _pass_on(request, share, stack.enter_context(path.open("wb")).write)
    return Tables(path)


async def _pass_on(request: Request, share: Share, write: Write) -> None:
    settings: Settings = request.app.state.settings
    pool = pool_of(request, "fleets")

    async def take(piece: bytes) -> None:
        share.take(len(piece))
        await pool.run(write, piece)  # a slow disk holds up nobody else

    await pass_body(
        request,
        take,
        maximum_bytes=settings.maximum_fleet_bytes,
        pause_seconds=settings.body_seconds,
        seconds=settings.fleet_seconds,
    )


class _Form:
    """Files of a form's parts in a folder."""

    def __init__(self, folder: Path, stack: ExitStack) -> None:
        self._folder, self._stack = folder, stack
        self._paths: dict[str, Path] = {}

    def begin(self, head: PartHead) -> Write:
        """Open the file of a part."""
        if head.name not in PARTS or head.name in self._paths:
            raise Problem(422, f"the form may have one part input and one part axes; {head.name[:40]!r} is one more")
        suffix = suffix_of(Path(head.file_name.lower())) or SUFFIXES.get(head.content_type, "")
        if not suffix:
            text = f"needs a file name that ends in one of {', '.join(ANSWERED_IN)}, or a content type of those"
            raise Problem(415, f"the part {head.name} {text}")
        self._paths[head.name] = path = self._folder / f"{head.name}{suffix}"
        return self._stack.enter_context(path.open("wb")).write

    def tables(self) -> Tables:
        """The tables; Problem 422 where there is none of phases."""
        if "input" not in self._paths:
            raise Problem(422, "the form needs a part input, the table of phases or axes")
        return Tables(self._paths["input"], self._paths.get("axes"))

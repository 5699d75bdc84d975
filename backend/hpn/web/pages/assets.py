"""Static files under content-hashed names, compressed by the build, cached by browsers for ever."""

import gzip
import json
import mimetypes
from dataclasses import dataclass, field
from pathlib import Path

import brotli
from fastapi import APIRouter
from starlette.concurrency import run_in_threadpool
from starlette.datastructures import State
from starlette.exceptions import HTTPException
from starlette.requests import Request
from starlette.responses import FileResponse, Response

from hpn.installed import data_folder
from hpn.web.door.access import OPEN, admit
from hpn.web.door.codings import accepted_codings

DIST = data_folder("frontend/dist")
PACKED = ".br"
"""Suffix of texts, which are stored compressed."""

CODINGS = ("br", "gzip")
"""Content codings in order of preference."""

# Some systems' tables lack these.
mimetypes.add_type("text/javascript", ".js")
mimetypes.add_type("text/javascript", ".mjs")
mimetypes.add_type("font/woff2", ".woff2")
mimetypes.add_type("image/svg+xml", ".svg")
mimetypes.add_type("application/manifest+json", ".webmanifest")


@dataclass(frozen=True)
class Assets:
    """Files of the build by their logical names, which templates use."""

    folder: Path
    manifest: dict[str, str]
    unpacked: dict[tuple[str, str], bytes] = field(default_factory=dict)
    """Texts by file and coding, for clients without brotli; bounded by the number of files."""

    @classmethod
    def load(cls, folder: Path = DIST) -> "Assets":
        """Read the manifest; FileNotFoundError tells how to build a missing one."""
        path = folder / "manifest.json"
        try:
            return cls(folder, json.loads(path.read_text(encoding="utf-8")))
        except FileNotFoundError:
            raise FileNotFoundError(f"{path} is missing: build the assets with `make assets`") from None

    def url(self, name: str) -> str:
        """Address of a file, such as `/static/app.3f2a9c1b.css` for `app.css`; KeyError for an unknown name."""
        return f"/static/{self.manifest[name]}"

    def file(self, hashed_name: str) -> Path | None:
        """File of a hashed name; None for a file that the manifest does not list."""
        return self.folder / hashed_name if hashed_name in self.manifest.values() else None

    def text(self, path: Path, coding: str = "") -> bytes:
        """Content of a text, plain or compressed with gzip."""
        key = path.name, coding
        if key not in self.unpacked:
            plain = brotli.decompress(path.with_name(path.name + PACKED).read_bytes())
            self.unpacked[key] = gzip.compress(plain, mtime=0) if coding else plain
        return self.unpacked[key]


def assets_of(state: State) -> Assets:
    """Assets of an application, read once."""
    if not hasattr(state, "assets"):
        state.assets = Assets.load()
    assets: Assets = state.assets
    return assets


async def serve(request: Request) -> Response:
    """Send a file in the best coding that the client accepts."""
    assets = assets_of(request.app.state)
    path = assets.file(request.path_params["name"])
    if path is None:
        raise HTTPException(404)
    headers = {"Cache-Control": "public, max-age=31536000, immutable"}
    media_type = mimetypes.guess_type(path.name)[0] or "application/octet-stream"
    packed = path.with_name(path.name + PACKED)
    if not packed.exists():
        return FileResponse(path, headers=headers, media_type=media_type)
    headers["Vary"] = "Accept-Encoding"
    coding = next(iter(accepted_codings(request.headers.get("accept-encoding", ""), CODINGS)), "")
    if coding:
        headers["Content-Encoding"] = coding
    if coding == "br":
        return FileResponse(packed, headers=headers, media_type=media_type)
    return Response(await run_in_threadpool(assets.text, path, coding), headers=headers, media_type=media_type)


router = APIRouter(include_in_schema=False, dependencies=[OPEN])
router.add_api_route("/static/{name:path}", serve)

docs_router = APIRouter(include_in_schema=False, dependencies=[admit("calculator")])

DOCS = """<!doctype html>
<html lang="en">
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>REST: HPN Select</title>
<link rel="icon" href="{icon}">
<link rel="stylesheet" href="{style}">
<main id="docs"></main>
<script src="{library}"></script>
<script src="{start}"></script>
</html>
"""


@docs_router.get("/docs")
async def docs(request: Request) -> Response:
    """Page of the OpenAPI document that sends requests: Swagger UI from the service's own files."""
    url = assets_of(request.app.state).url
    page = DOCS.format(
        icon=url("favicon.svg"), style=url("swagger-ui.css"), library=url("swagger-ui-bundle.js"), start=url("docs.js")
    )
    return Response(page, media_type="text/html", headers={"Cache-Control": "no-cache"})

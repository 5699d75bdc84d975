"""Static files under content-hashed names, precompressed when they were built, kept by browsers for ever."""

import json
import mimetypes
from dataclasses import dataclass
from pathlib import Path

from fastapi import APIRouter
from starlette.datastructures import State
from starlette.exceptions import HTTPException
from starlette.requests import Request
from starlette.responses import FileResponse, Response

from hpn.installed import data_folder
from hpn.web.door.access import OPEN, admit
from hpn.web.door.codings import accepted_codings

DIST = data_folder("frontend/dist")
ENCODINGS = {"br": ".br", "gzip": ".gz"}
"""Content codings in order of preference, and the suffix of the file that holds each."""

# Not every system's table knows these.
mimetypes.add_type("text/javascript", ".js")
mimetypes.add_type("text/javascript", ".mjs")
mimetypes.add_type("font/woff2", ".woff2")
mimetypes.add_type("image/svg+xml", ".svg")
mimetypes.add_type("application/manifest+json", ".webmanifest")


@dataclass(frozen=True)
class Assets:
    """Files that the build wrote, by the logical name that a template asks for."""

    folder: Path
    manifest: dict[str, str]

    @classmethod
    def load(cls, folder: Path = DIST) -> "Assets":
        """Read the manifest; FileNotFoundError says how to make one."""
        path = folder / "manifest.json"
        try:
            return cls(folder, json.loads(path.read_text(encoding="utf-8")))
        except FileNotFoundError:
            raise FileNotFoundError(f"{path} is missing: build the assets with `make assets`") from None

    def url(self, name: str) -> str:
        """Address of a file, such as `/static/app.3f2a9c1b.css` for `app.css`; KeyError for an unknown name."""
        return f"/static/{self.manifest[name]}"

    def file(self, hashed_name: str) -> Path | None:
        """File of a hashed name, or None: only what the manifest lists is ever served."""
        return self.folder / hashed_name if hashed_name in self.manifest.values() else None


def assets_of(state: State) -> Assets:
    """Assets of an application, read once."""
    if not hasattr(state, "assets"):
        state.assets = Assets.load()
    assets: Assets = state.assets
    return assets


async def serve(request: Request) -> Response:
    """Send a file in the best coding that the client accepts."""
    path = assets_of(request.app.state).file(request.path_params["name"])
    if path is None:
        raise HTTPException(404)
    headers = {"Cache-Control": "public, max-age=31536000, immutable"}
    media_type = mimetypes.guess_type(path.name)[0] or "application/octet-stream"
    for coding in accepted_codings(request.headers.get("accept-encoding", ""), ENCODINGS):
        packed = path.with_name(path.name + ENCODINGS[coding])
        if packed.exists():
            headers |= {"Content-Encoding": coding, "Vary": "Accept-Encoding"}
            return FileResponse(packed, headers=headers, media_type=media_type)
    return FileResponse(path, headers=headers, media_type=media_type)


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
    """The OpenAPI document as a page that sends requests: Swagger UI from the service's own files."""
    url = assets_of(request.app.state).url
    page = DOCS.format(
        icon=url("favicon.svg"), style=url("swagger-ui.css"), library=url("swagger-ui-bundle.js"), start=url("docs.js")
    )
    return Response(page, media_type="text/html", headers={"Cache-Control": "no-cache"})

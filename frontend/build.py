"""Write the page's assets to frontend/dist under content-hashed names, each text file with its compressed forms, and
the fonts of the PDF to frontend/dist/noto.

A name changes exactly when its content does, so the service may let browsers keep every file for ever.
`manifest.json` maps the logical name a template asks for ("app.css") to the hashed one ("app.3f2a9c1b.css").
"""

import gzip
import hashlib
import json
import re
import shutil
from pathlib import Path

import brotli

FRONTEND = Path(__file__).parent
STATIC = FRONTEND / "static"
DIST = FRONTEND / "dist"
PACKAGES = {
    "htmx.min.js": FRONTEND / "node_modules/htmx.org/dist/htmx.min.js",
    "plotly-basic.min.js": FRONTEND / "node_modules/plotly.js-basic-dist-min/plotly-basic.min.js",
}
NOTO = FRONTEND / "node_modules/@expo-google-fonts"
"""Packages of Noto fonts, one for each script: as Google publishes them, in nine weights."""

TEXT_SUFFIXES = {".css", ".html", ".js", ".json", ".map", ".mjs", ".svg", ".txt", ".webmanifest", ".xml"}


def sources() -> dict[str, Path]:
    """Logical name, with forward slashes, to file."""
    static = {path.relative_to(STATIC).as_posix(): path for path in sorted(STATIC.rglob("*")) if path.is_file()}
    return static | PACKAGES


COMMENTS = {
    ".css": re.compile(rb"/\*.*?\*/\s*", re.DOTALL),
    ".js": re.compile(rb"^ *//.*\n", re.MULTILINE),
}
"""Comments of our own files by suffix: in scripts those on lines of their own."""


def sent(path: Path) -> bytes:
    """Content of a file without the comments that only its authors read; packages keep theirs, with their licences."""
    content = path.read_bytes()
    comment = COMMENTS.get(path.suffix) if path.is_relative_to(STATIC) else None
    return comment.sub(b"", content) if comment else content


def hashed_name(name: str, content: bytes) -> str:
    stem, dot, suffix = name.rpartition(".")
    return f"{stem}.{hashlib.sha256(content).hexdigest()[:8]}{dot}{suffix}"


def write(target: Path, content: bytes) -> None:
    target.parent.mkdir(parents=True, exist_ok=True)
    target.write_bytes(content)
    if target.suffix in TEXT_SUFFIXES:
        target.with_name(target.name + ".br").write_bytes(brotli.compress(content))
        target.with_name(target.name + ".gz").write_bytes(gzip.compress(content, mtime=0))


def copy_fonts() -> None:
    """Copy the regular weight of each Noto font, with the licence that goes along with it."""
    (DIST / "noto").mkdir(parents=True)
    for font in sorted(NOTO.glob("noto-*/400Regular/*.ttf")):
        name = font.name.replace("_400Regular", "")
        shutil.copyfile(font, DIST / "noto" / name)
        shutil.copyfile(font.parents[1] / "LICENSE_FONT", DIST / "noto" / f"{name}.OFL.txt")


def main() -> None:
    if DIST.exists():
        shutil.rmtree(DIST)
    copy_fonts()
    manifest: dict[str, str] = {}
    for name, path in sources().items():
        content = sent(path)
        manifest[name] = hashed_name(name, content)
        write(DIST / manifest[name], content)
    # Last, so that make sees an interrupted build as not done.
    (DIST / "manifest.json").write_text(json.dumps(manifest, indent=2, sort_keys=True) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()

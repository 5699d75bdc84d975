"""Write the page's assets to frontend/dist under content-hashed names, text files compressed with brotli alone, and the
fonts of the PDF to frontend/dist/paper.

A name changes exactly when its content does, so the service may let browsers keep every file for ever.
`manifest.json` maps the logical name a template asks for ("page.css") to the hashed one ("page.3f2a9c1b.css").
"""

import hashlib
import json
import re
import shutil
import subprocess
from pathlib import Path

import brotli
import fonts

FRONTEND = Path(__file__).parent
STATIC = FRONTEND / "static"
DIST = FRONTEND / "dist"
ESBUILD = FRONTEND / "node_modules/.bin/esbuild"
HTMX = FRONTEND / "node_modules/htmx.org/dist/htmx.min.js"
SWAGGER = FRONTEND / "node_modules/swagger-ui-dist"
TYPEFACE = FRONTEND / "node_modules/@ibm/plex-sans-variable"
PLOTLY = FRONTEND / "node_modules/plotly.js-basic-dist-min/plotly-basic.min.js"
DRAWN = ("../../backend/hpn/explain/drawings/drawings", "plots")
"""Style sheets of drawings, which the report uses too, and of plots."""

COMMON = ("fonts", "tokens", "app", "form", "tools", "import", "commands")
RESULT = ("insight", "tabs", *DRAWN)
STYLES = {
    "page.css": (*COMMON, "workbench", *RESULT, "scale", "verdict", "sheet", "phone", "print"),
    "site.css": (
        *COMMON,
        "catalogue",
        "saved",
        "selection",
        "trail",
        *RESULT,
        "machine-axes",
        "machine",
        "revisions",
        "chain",
        "scale",
        "verdict",
        "phone",
        "print",
        "paper",
    ),
    **{f"{part}.css": (part,) for part in ("motion", "reading", "tolerance")},
    "pairs.css": ("sheet", "pairs"),
    "axis.css": ("trail", "chain", "axis"),
    "saved.css": ("selection", "trail", "revisions", "chain", "read-only", "paper"),
    "report.css": ("tokens", "app", "tools", "machine-axes", "scale", "phone", "print"),
}
"""Style sheets of the form with its result, of all other pages, of parts that come later and bring their own, and of a
fleet’s report, which holds its own."""

OF_FORM = ("form", "replacing", "undo", "messages", "requests", "rows", "answer")
SCRIPTS = (*OF_FORM, "sections", "connection", "insight", "plots", "tools")
"""Modules of the form's page."""

ALONE = ("axis.js", "copying.js", "docs.js", "favicon.svg", "fleet-report.js", "machine.js", "plots.js")
"""Files that a page asks for by themselves; a fleet’s report holds its script."""

NOTO = FRONTEND / "node_modules/@expo-google-fonts"
"""Packages of Noto fonts, one for each script: as Google publishes them, in nine weights."""

TEXT_SUFFIXES = {".css", ".html", ".js", ".json", ".map", ".mjs", ".svg", ".txt", ".webmanifest", ".xml"}


def minified(source: bytes, loader: str, *options: str) -> bytes:
    """Script or style sheet of ours without what only its authors read, by esbuild."""
    command = [str(ESBUILD), f"--loader={loader}", "--minify", "--legal-comments=none", "--log-level=warning", *options]
    return subprocess.run(command, input=source, cwd=STATIC, check=True, capture_output=True).stdout.strip()


def script(*names: str) -> bytes:
    """htmx, and modules of ours after it in one file."""
    return HTMX.read_bytes() + b"\n" + bundle(*names)


def bundle(*names: str) -> bytes:
    """Modules of ours in one file."""
    entry = "".join(f'import "./{name}.js";' for name in names).encode()
    return minified(entry, "js", "--bundle", "--format=iife") + b"\n"


def style(faces: dict[str, bytes], *names: str) -> bytes:
    """Style sheets of ours as one, which ask for the faces by their hashed names."""
    text = minified(b"".join((STATIC / f"{name}.css").read_bytes() for name in names), "css").decode()
    return re.sub(r"url\((hpn-[\w.-]+)\)", lambda url: f"url({hashed_name(url[1], faces[url[1]])})", text).encode()


def alone(name: str) -> bytes:
    """Content of a file that is asked for by itself."""
    content = (STATIC / name).read_bytes()
    return minified(content, "js") if name.endswith(".js") else content


def files() -> dict[str, bytes]:
    """Content of each file by its logical name; packages keep their comments, with their licences."""
    texts = [*FRONTEND.glob("templates/*.html"), *FRONTEND.parent.glob("backend/hpn/**/*.po")]
    faces = fonts.faces(TYPEFACE, texts)
    return {
        **faces,
        "plotly-basic.min.js": PLOTLY.read_bytes() + b"\n" + alone("names.js"),
        **{name: (SWAGGER / name).read_bytes() for name in ("swagger-ui.css", "swagger-ui-bundle.js")},
        "page.js": script(*SCRIPTS),
        "gear.js": script("form", "tools"),
        "saved.js": bundle("shown", "copying"),
        **{name: style(faces, *parts) for name, parts in STYLES.items()},
        **{name: alone(name) for name in ALONE},
    }


def hashed_name(name: str, content: bytes) -> str:
    stem, dot, suffix = name.rpartition(".")
    return f"{stem}.{hashlib.sha256(content).hexdigest()[:8]}{dot}{suffix}"


def write(target: Path, content: bytes) -> None:
    """Write a file; of a text the compressed form, which the service unpacks for who takes no brotli."""
    target.parent.mkdir(parents=True, exist_ok=True)
    if target.suffix in TEXT_SUFFIXES:
        target.with_name(target.name + ".br").write_bytes(brotli.compress(content))
    else:
        target.write_bytes(content)


def copy_fonts() -> None:
    """Write the faces of the PDF and the regular weight of each Noto font, each with the licence that goes along.

    The Korean one is without what the Chinese one has, which is asked before it: half of it.
    """
    (DIST / "paper").mkdir(parents=True)
    for name, content in fonts.paper_faces(TYPEFACE).items():
        (DIST / "paper" / name).write_bytes(content)
    for font in sorted(NOTO.glob("noto-*/400Regular/*.ttf")):
        name = font.name.replace("_400Regular", "")
        shutil.copyfile(font, DIST / "paper" / name)
        shutil.copyfile(font.parents[1] / "LICENSE_FONT", DIST / "paper" / f"{name}.OFL.txt")
    chinese, korean = (DIST / "paper" / f"NotoSans{name}.ttf" for name in ("SC", "KR"))
    korean.write_bytes(fonts.saved(fonts.beyond(korean, chinese)))


def main() -> None:
    if DIST.exists():
        shutil.rmtree(DIST)
    copy_fonts()
    manifest: dict[str, str] = {}
    for name, content in files().items():
        manifest[name] = hashed_name(name, content)
        write(DIST / manifest[name], content)
    # Last, so that make sees an interrupted build as not done.
    (DIST / "manifest.json").write_text(json.dumps(manifest, indent=2, sort_keys=True) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()

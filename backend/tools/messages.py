"""Texts that users may see, collected from code, templates and catalogue.

`python -m tools.messages` updates the catalogues of translations and lists the texts left to translate.
"""

import ast
import csv
import sys
from collections.abc import Iterator
from pathlib import Path

from babel.messages.catalog import Catalog
from babel.messages.pofile import write_po
from jinja2.ext import babel_extract

from hpn.words.reader import LANGUAGES, catalogue, path_of

ROOT = Path(__file__).parents[2]
BACKEND, TEMPLATES, FIGURES = ROOT / "backend/hpn", ROOT / "frontend/templates", ROOT / "catalogue"

MARKS = {
    "N_": (0,),
    "P": (0, 1),
    "Sentence": (0,),
    "_notice": (1,),
    "RefusedError": (0,),
    "PydanticCustomError": (1,),
}
"""Calls that mark a text, and the places of their arguments that are texts."""

COLUMNS = {
    "sizes.csv": ("note",),
    "facts.csv": ("topic", "text"),
    "sources.csv": ("title",),
    "versions.csv": ("position", "description"),
}
"""Texts of the catalogue of gears."""

Text = str | tuple[str, str]
Found = tuple[Text, str]


def texts() -> Catalog:
    """Marked texts, each with the files that contain it."""
    template = Catalog()
    places: dict[Text, set[str]] = {}
    for text, place in (*_of_code(), *_of_templates(), *_of_figures()):
        places.setdefault(text, set()).add(place)
    for text, files in sorted(places.items(), key=lambda entry: (sorted(entry[1])[0], str(entry[0]))):
        template.add(text, locations=[(file, 0) for file in sorted(files)])
    return template


def _of_code() -> Iterator[Found]:
    for path in sorted(BACKEND.rglob("*.py")):
        for node in ast.walk(ast.parse(path.read_text())):
            if isinstance(node, ast.Call):
                name = getattr(node.func, "id", getattr(node.func, "attr", ""))
                found = [_constant(node.args[k]) for k in MARKS.get(name, ()) if k < len(node.args)]
                if name == "P" and all(found) and len(found) == 2:
                    yield (str(found[0]), str(found[1])), _name(path)
                elif found and found[0]:
                    yield found[0], _name(path)


def _constant(node: ast.expr) -> str | None:
    return node.value if isinstance(node, ast.Constant) and isinstance(node.value, str) else None


def _of_templates() -> Iterator[Found]:
    options = {"trim_blocks": "true", "lstrip_blocks": "true", "silent": "false", "newstyle_gettext": "true"}
    for path in sorted(TEMPLATES.rglob("*.html")):
        with path.open("rb") as file:
            for _, name, message, _ in babel_extract(file, ("_", "gettext", "ngettext"), (), options):
                texts = [str(text) for text in message] if isinstance(message, tuple) else [str(message)]
                yield ((texts[0], texts[1]) if name == "ngettext" else texts[0]), _name(path)


def _of_figures() -> Iterator[Found]:
    for name, columns in COLUMNS.items():
        with (FIGURES / name).open(newline="") as file:
            for row in csv.DictReader(file):
                yield from ((row[column], f"catalogue/{name}") for column in columns if row.get(column))


def _name(path: Path) -> str:
    return path.relative_to(ROOT).as_posix()


def missing(code: str) -> list[str]:
    """Texts that a language lacks, that are only guessed, or that nothing shows any more."""
    own, wanted = catalogue(code), texts()
    problems = []
    for message in wanted:
        there = own.get(message.id) if message.id else None
        if message.id and (there is None or not _complete(there.string) or there.fuzzy):
            problems.append(f"missing: {message.id!r}")
    unused = (message.id for message in own if message.id and wanted.get(message.id) is None)
    return problems + [f"no longer used: {text!r}" for text in unused]


def _complete(string: object) -> bool:
    return all(string) if isinstance(string, tuple | list) else bool(string)


def update(code: str) -> list[str]:
    """Update a language's catalogue; returns the texts left to translate in it."""
    own = catalogue(code)
    own.update(texts(), no_fuzzy_matching=True, update_creation_date=False)
    own.obsolete.clear()
    with path_of(code).open("wb") as file:
        write_po(file, own, width=120, omit_header=False, include_lineno=False, ignore_obsolete=True)
    return missing(code)


if __name__ == "__main__":
    left = [f"{code}: {problem}" for code in LANGUAGES if code != "en" for problem in update(code)]
    print("\n".join(left) or "every text is translated")
    sys.exit(bool(left))

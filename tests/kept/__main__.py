"""Writes a small database of the version at hand as SQL text: `python -m tests.kept NAME [HPN]`.

Everything in it is saved by the doors of that version, its REST interface and its page, which `hpn serve` opens here.
HPN is the command of another installed checkout; what an older version refuses is named and left out.
"""

import argparse
import csv
import io
import json
import sqlite3
import tempfile
from collections.abc import Iterable, Sequence
from pathlib import Path

import httpx

from tests.build import Json
from tests.kept.content import DELETED, FLEETS, PAGES, RENAMED, SELECTIONS
from tests.operations.service import HPN, serving

DATABASES = Path(__file__).parent / "databases"
FIRST = "/api/v1/selections"


def save(client: httpx.Client) -> Iterable[str]:
    """Save by REST what the version takes; the names of what it refuses."""
    for name, body in SELECTIONS.items():
        headers = {"Idempotency-Key": name.replace(" ", "-")}
        answer = client.post(FIRST, json=body, headers=headers)
        if answer.status_code == 422:  # a version without all of the labels
            bare = {field: body[field] for field in ("application", "title", "reference") if field in body}
            answer = client.post(FIRST, json=bare, headers=headers)
        if answer.status_code != 201:
            yield name
            continue
        address = answer.headers["location"]
        if name == RENAMED and client.patch(address, json={"title": "Renamed", "reference": None}).is_error:
            yield f"{name}: its new name"
        elif name != DELETED:
            continue
        client.delete(address).raise_for_status()


def save_by_page(client: httpx.Client) -> Iterable[str]:
    """Save by the form of the page; the names of what it refuses."""
    page = client.get("/").text
    for name, application in PAGES.items():
        response = client.post("/api/v1/select", json=application)
        if response.is_error:
            yield name
            continue
        fields = {"link": response.json()["link"], "title": name}
        fields["ref" if 'name="ref"' in page else "reference"] = "P-7"
        if 'name="once"' in page:
            fields["once"] = "0123456789abcdefABCDEF"
        if client.post("/selections", data=fields).status_code != 303:
            yield name


def size(client: httpx.Client) -> Iterable[str]:
    """Size and save fleets by the page; the names of those that the version refuses."""
    door = next((path for path in ("/machines", "/fleets") if client.get(path).status_code == 200), None)
    for name, axes in FLEETS.items():
        answer = client.post(door, files={"file": ("axes.csv", table_of(axes))}) if door else None
        if answer is None or answer.status_code != 303:
            yield name
        else:
            fields = {"title": name, "ref": "P-7", "author": "M. Muster", "rev": "B"}
            assert client.post(answer.headers["location"], data=fields).status_code == 303


def table_of(axes: Sequence[Json]) -> bytes:
    """Axes as CSV in list form."""
    text = io.StringIO()
    writer = csv.DictWriter(text, list(dict.fromkeys(name for axis in axes for name in axis)))
    writer.writeheader()
    writer.writerows({k: json.dumps(v) if isinstance(v, list) else v for k, v in axis.items()} for axis in axes)
    return text.getvalue().encode()


def dumped(file: Path) -> str:
    """A database as SQL text, a statement on each line."""
    with sqlite3.connect(file) as connection:
        return "".join(f"{line}\n" for line in connection.iterdump())


def main() -> None:
    """Write the database."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("name", help="version, or number of its last migration")
    parser.add_argument("hpn", nargs="?", type=Path, default=HPN, help="command of an installed checkout")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        with serving(Path(folder), program=(str(options.hpn), "serve")) as service:
            for way in (save, save_by_page, size):
                for refused in way(service.client):
                    print(f"not known to this version: {refused}")
        target = DATABASES / f"{options.name}.sql"
        target.write_text(dumped(Path(folder) / "store.sqlite3"), encoding="utf-8")
    print(f"{target.name}: {target.stat().st_size / 1000:.0f} kB")


main()

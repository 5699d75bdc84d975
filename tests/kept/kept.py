"""Databases of earlier versions, loaded and opened."""

import sqlite3
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import msgspec
from starlette.testclient import TestClient

from hpn.store.saved import unpacked
from hpn.web.app import create_app
from hpn.web.settings import Settings

FILES = sorted((Path(__file__).parent / "databases").glob("*.sql"))
VERSIONS = [file.stem for file in FILES]


def loaded(version: str, folder: Path) -> Path:
    """SQLite file with the database of a version."""
    file = folder / "store.sqlite3"
    sql = next(one for one in FILES if one.stem == version).read_text(encoding="utf-8")
    with sqlite3.connect(file) as connection:
        connection.executescript(sql)
    connection.close()
    return file


@contextmanager
def opened(file: Path) -> Iterator[TestClient]:
    """Client of today's service on a database, which it brings up to date."""
    settings = Settings(database_url=f"sqlite:///{file}", log_level="error")
    with TestClient(create_app(settings), follow_redirects=False) as client:
        yield client


def replies(file: Path) -> dict[str, dict[str, Any]]:
    """Answers in a database by the ids of their selections, as its version packed them."""
    with sqlite3.connect(file) as connection:
        names = [row[1] for row in connection.execute("PRAGMA table_info(selections)")]
        packed = next(name for name in names if name.startswith("result_"))
        rows = connection.execute(f"SELECT id, {packed} FROM selections").fetchall()
    connection.close()
    return {id: msgspec.json.decode(unpacked(content)) for id, content in rows}

"""The files of a catalogue folder: each is read once, within a bound; what can't be a table is refused by its name."""

import os
import stat
from collections.abc import Collection
from pathlib import Path, PurePath

from hpn.words.mendable import MendableError

MAXIMUM_FILE_BYTES = 4_000_000

SHEETS = (".csv", ".tsv", ".txt", ".xls", ".xlsx", ".ods")
"""Endings of files that people keep tables in."""

KINDS = {
    stat.S_IFDIR: "a folder",
    stat.S_IFIFO: "a pipe",
    stat.S_IFSOCK: "a socket",
    stat.S_IFCHR: "a device",
    stat.S_IFBLK: "a device",
}


class CatalogueError(MendableError, ValueError):
    """A catalogue or supplement file that can't be used; the text names file, line and column."""

    def __init__(self, file: Path | str, line: int | None, column: str | None, detail: str) -> None:
        where = f"{file}" + (f", line {line}" if line else "") + (f", column {column}" if column else "")
        super().__init__(f"{where}: {detail}")


def read_folder(folder: Path, tables: Collection[str]) -> dict[str, bytes]:
    """Content of those of the tables that a folder has, by their names.

    Raises CatalogueError for a folder or a table that can't be read, and for a file that seems to be a table, but has
    the name of none: whoever put it there believes that it counts.
    """
    try:
        found = sorted(os.listdir(folder))
    except (FileNotFoundError, NotADirectoryError):
        raise CatalogueError(folder, None, None, "is not a folder") from None
    except OSError as error:
        raise CatalogueError(folder, None, None, f"can’t be read: {error.strerror}") from None
    for name in found:
        if name not in tables and _is_meant(name, tables):
            detail = f"is not a table of the catalogue; there are {', '.join(sorted(tables))}"
            if name.lower() in tables:
                detail = f"is not a table of the catalogue: its name is {name.lower()}, in small letters"
            raise CatalogueError(folder / name, None, None, detail)
    return {name: _content(folder / name) for name in found if name in tables}


def _is_meant(name: str, tables: Collection[str]) -> bool:
    """True for a file that seems to be a table: a CSV file of any name, or a sheet such as `ratings.xlsx`."""
    ending = PurePath(name.lower()).suffix
    return ending == ".csv" or (ending in SHEETS and f"{name.lower().partition('.')[0]}.csv" in tables)


def _content(path: Path) -> bytes:
    try:
        target, kind = path.resolve(strict=True), stat.S_IFMT(path.stat().st_mode)
        if not target.is_relative_to(path.parent.resolve()):
            raise CatalogueError(path, None, None, f"is a link out of its folder, to {target}")
        if kind != stat.S_IFREG:
            raise CatalogueError(path, None, None, f"is {KINDS.get(kind, 'something else')}, where a file belongs")
        with path.open("rb") as file:
            content = file.read(MAXIMUM_FILE_BYTES + 1)
    except FileNotFoundError:
        raise CatalogueError(path, None, None, "is a link that leads nowhere") from None
    except (OSError, RuntimeError) as error:  # RuntimeError: a link to itself
        raise CatalogueError(path, None, None, f"can’t be read: {getattr(error, 'strerror', None) or error}") from None
    if len(content) > MAXIMUM_FILE_BYTES:
        raise CatalogueError(path, None, None, f"is larger than {MAXIMUM_FILE_BYTES} bytes")
    return content

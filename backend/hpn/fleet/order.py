"""Order of a fleet: the table to read and the files to write, and checks of their paths.

This module imports nothing of Arrow: a service makes orders, and a separate process carries them out.
"""

import codecs
import os
import stat
from dataclasses import dataclass
from pathlib import Path

from hpn.words.wording import MendableError

ANSWERED_IN = {
    ".parquet": ".parquet",
    ".arrow": ".arrow",
    ".csv": ".csv",
    ".arrows": ".arrow",
    ".feather": ".arrow",
    ".csv.gz": ".csv",
}
"""Suffixes of tables to read, each with the suffix of its answers; the latter are the suffixes of files to write."""

LINES = (".ndjson", ".jsonl")
LINES_GONE = (
    "tables in lines of JSON are gone: use Parquet, Arrow or CSV; POST /api/v1/select/batch takes applications in lines"
)
TWO_GONE = "is gone: one table has all columns, in long form in the first row of an axis or the same in all of its rows"
MOST_AXES, MOST_PHASES = 10_000, 200_000
"""Most axes of a machine, and most phases of all of them."""

UTF16_MARKS = (codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)
UNREADABLE = "this user may not read it; see its permissions"


class FleetError(MendableError):
    """Error of input that is unusable as a whole; the text names the file and the accepted form."""


@dataclass(frozen=True)
class Order:
    """Table to read, and files to write."""

    axes: Path
    answers: Path
    candidates: Path | None = None
    rejected: Path | None = None
    ignored: tuple[str, ...] = ()
    """Columns to leave out, with any content."""

    @property
    def targets(self) -> dict[str, Path]:
        """Files to write, by kind; the answers get their name last."""
        named = {"candidates": self.candidates, "rejected": self.rejected, "answers": self.answers}
        return {kind: path for kind, path in named.items() if path is not None}

    def require_usable(self) -> None:
        """Raise FleetError where a file would be overwritten, or could not be read or written."""
        if status_of(self.axes) is not None and not os.access(self.axes, os.R_OK, effective_ids=True):
            raise FleetError(f"{self.axes}: {UNREADABLE}")
        written = list(self.targets.values())
        for place, path in enumerate(written):
            format_of(path)
            require_writable(path)
            if path.resolve() in [other.resolve() for other in (self.axes, *written[:place])]:
                raise FleetError(f"{path}: is named twice")


def suffix_of(path: Path) -> str | None:
    """Suffix of a table to read, or None; raises FleetError for lines of JSON."""
    if path.name.endswith(LINES):
        raise FleetError(f"{path}: {LINES_GONE}")
    return next((suffix for suffix in ANSWERED_IN if path.name.endswith(suffix)), None)


def format_of(path: Path) -> str:
    """Suffix of a file to write, which names its format; raises FleetError for any other."""
    suffix = suffix_of(path)
    if suffix is None or ANSWERED_IN[suffix] != suffix:
        raise FleetError(f"{path}: the suffix must be one of {', '.join(dict.fromkeys(ANSWERED_IN.values()))}")
    return suffix


def status_of(path: Path) -> os.stat_result | None:
    """Status of the file or folder at a path, None where there is none; raises FleetError where this user may
    not look."""
    try:
        return path.stat()
    except (FileNotFoundError, NotADirectoryError):
        return None
    except PermissionError:
        raise FleetError(f"{path}: {UNREADABLE}") from None


def require_writable(path: Path) -> None:
    """Raise FleetError where no file can be written at a path."""
    folder = status_of(path.parent)
    if folder is None or not stat.S_ISDIR(folder.st_mode):
        raise FleetError(f"{path}: there is no folder {path.parent}")
    if not os.access(path.parent, os.W_OK | os.X_OK, effective_ids=True):
        raise FleetError(f"{path}: this user may not write into {path.parent}")
    status = status_of(path)
    if status is not None and stat.S_ISDIR(status.st_mode):
        raise FleetError(f"{path}: is a folder, where a file belongs")


def wrong_encoding(head: bytes) -> str | None:
    """Error text for a CSV table that begins with the mark of UTF-16; None for any other."""
    if not head.startswith(UTF16_MARKS):
        return None
    return "is UTF-16, where UTF-8 belongs: in Excel “CSV UTF-8”; the page /machines reads such files as they are"

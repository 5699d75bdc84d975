"""`hpn verify`: figures of a file beside newly calculated ones."""

import argparse
import errno
import json
import sys
from collections.abc import Iterator
from pathlib import Path

import msgspec

from hpn import ENGINE_VERSION
from hpn.application import Application
from hpn.verify.shown import FileSubject, UnreadableFileError
from hpn.verify.verdict import Finding, Verdict
from hpn.verify.verify import verify
from hpn.web.settings import Settings

MAXIMUM_FILE_BYTES = 128_000_000
DIFFERS = 3
"""Exit code for a file that differs."""


def run(options: argparse.Namespace) -> int:
    """Print the number of equal figures, the differences with reasons, and the unchecked lines; returns 0 or
    DIFFERS."""
    catalogue = Settings().catalogue()
    question = _application_in(options.application) if options.application else None
    try:
        verdict = verify(_content(options.file), catalogue, question)
    except UnreadableFileError as error:
        raise UnreadableFileError(f"{options.file}: {error}") from None
    if options.json:
        sys.stdout.write(msgspec.json.encode(verdict).decode() + "\n")
    else:
        print("\n".join(_lines(verdict, catalogue.version)))
    return DIFFERS if verdict.differs else 0


def _application_in(path: Path) -> FileSubject:
    """Content of a JSON file: an application, or a saved selection with the gear of its files."""
    try:
        value = json.loads(_content(path))
    except (ValueError, RecursionError):
        raise UnreadableFileError(f"{path}: is no JSON") from None
    if not isinstance(value, dict) or "application" not in value:
        return FileSubject(Application.model_validate(value))
    return FileSubject(Application.model_validate(value["application"]), str(value.get("designation") or ""))


def _content(path: Path) -> bytes:
    with path.open("rb") as file:
        content = file.read(MAXIMUM_FILE_BYTES + 1)
    if len(content) > MAXIMUM_FILE_BYTES:
        raise OSError(errno.EFBIG, f"is larger than {MAXIMUM_FILE_BYTES} bytes", str(path))
    return content


def _lines(verdict: Verdict, catalogue: str) -> Iterator[str]:
    versions = verdict.versions
    yield f"{verdict.file}: {_version('engine', versions.engine, ENGINE_VERSION)}, " + _version(
        "catalogue", versions.catalogue, catalogue
    )
    yield f"{verdict.same} shown figures are the same to 1e-12, or to the digits that are shown"
    for finding in verdict.differs:
        yield f"differs: {_sentence(finding)}"
    for text in verdict.unchecked:
        yield f"can’t be checked: {text}"


def _version(name: str, printed: str | None, here: str) -> str:
    if printed is None:
        return f"{name} not said, here {here}"
    return f"{name} {printed}" + (", as here" if printed == here else f", here {here}")


REASONS = {
    "file": "the file was altered",
    "engine": "another version of the engine",
    "catalogue": "another version of the catalogue",
}


def _sentence(finding: Finding) -> str:
    reasons = " or ".join(REASONS[reason] for reason in finding.reasons)
    figure, calculated = (f"“{text}”" if text else "nothing" for text in (finding.shown, finding.calculated))
    return f"{finding.place}: shows {figure}, calculated {calculated}: {reasons}"

"""Files of an answer: `hpn.report`."""

from datetime import UTC, datetime
from typing import Literal

from hpn.files import formats
from hpn.files.export import DIGITS, Export, ExportTitle
from hpn.installed import require
from hpn.python.answer import Answer
from hpn.python.faults import ApplicationError
from hpn.words.reader import Reader

Suffix = Literal["pdf", "xlsx", "aasx"]
FORMATS = {"pdf": formats.PDF, "xlsx": formats.WORKBOOK, "aasx": formats.PACKAGE}


def report(
    answer: Answer,
    format: Suffix = "pdf",
    *,
    title: str = "",
    reference: str = "",
    author: str = "",
    revision: str = "",
    gear: str = "",
    language: Literal["en", "de"] = "en",
    service: str = "",
) -> bytes:
    """Report on an answer as PDF, workbook of its numbers (xlsx), or Asset Administration Shell (aasx).

        Path("report.pdf").write_bytes(hpn.report(hpn.select(application), title="Axis 7"))

    `gear` is the candidate to report on, by default the selected one; `service` is the address of the service for the
    printed link. Raises ExtraMissingError without the extras `serve` and `report` or `aas`.
    """
    if format not in FORMATS:
        raise ApplicationError(f"format: must be pdf, xlsx or aasx, not {format!r}")
    for extra in FORMATS[format].extras:
        require(extra)
    export = Export(
        application=answer.application,
        selection=answer.selection,
        link=service.rstrip("/") + answer.link,
        heading=ExportTitle(title, reference, author, revision),
        moment=datetime.now(UTC),
        catalogue=answer.gears.catalogue,
        chosen=answer.candidate(gear).designation if gear else "",
    )
    return FORMATS[format].content(export, Reader(language, digits=DIGITS))

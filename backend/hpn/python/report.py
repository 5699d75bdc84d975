"""Files of an answer: `hpn.report`."""

from datetime import UTC, datetime
from typing import Literal

from hpn.files.export import DIGITS, Export, ExportTitle, made_by
from hpn.installed import require
from hpn.python.answer import Answer
from hpn.python.faults import ApplicationError
from hpn.words.reader import Reader

FileFormat = Literal["pdf", "xlsx", "aasx"]

MAKERS: dict[str, tuple[str, tuple[str, ...]]] = {
    "pdf": ("hpn.files.report.pdf:pdf", ("serve", "report")),
    "xlsx": ("hpn.files.workbook.workbook:workbook", ("serve",)),
    "aasx": ("hpn.files.aas.submodel:package", ("serve", "aas")),
}
"""Functions that make the formats, and the extras that they need."""


def report(
    answer: Answer,
    format: FileFormat = "pdf",
    *,
    title: str = "",
    reference: str = "",
    author: str = "",
    revision: str = "",
    gear: str = "",
    language: Literal["en", "de"] = "en",
    service: str = "",
) -> bytes:
    """The report on an answer as PDF, the workbook of its numbers (xlsx), or its Asset Administration Shell (aasx).

        Path("report.pdf").write_bytes(hpn.report(hpn.select(application), title="Axis 7"))

    `gear` is the candidate to report on, by default the selected one; `service` is the address of a service that the
    printed link leads to. Raises ExtraMissingError without the extras `serve` and `report` or `aas`.
    """
    if format not in MAKERS:
        raise ApplicationError(f"format: must be pdf, xlsx or aasx, not {format!r}")
    maker, extras = MAKERS[format]
    for extra in extras:
        require(extra)
    export = Export(
        application=answer.application,
        selection=answer.selection,
        link=service.rstrip("/") + answer.link,
        heading=ExportTitle(title, reference, author, revision),
        made=datetime.now(UTC),
        catalogue=answer.gears.catalogue,
        chosen=answer.candidate(gear).designation if gear else "",
    )
    return made_by(maker, export, *([] if format == "aasx" else [Reader(language, digits=DIGITS)]))

"""Numbers and bounds of a check in words, alike in the report and in the workbook."""

from typing import Literal

from hpn.engine.checks import allowed
from hpn.files.export import Export
from hpn.words.reader import GROUP, Reader
from hpn.words.wording import N_, Sentence

Paper = Literal["a4", "us-letter"]


def bound_of(export: Export, code: str | None) -> float:
    """Largest utilisation at which a check passes."""
    return allowed(code, export.application.requirements.utilisation)


def title_of(export: Export, code: str, reader: Reader) -> str:
    """Title of a check in the selection."""
    return reader.text(export.selection.check_definitions[code].title)


def exact_percent(share: float, reader: Reader) -> str:
    """Share as it was given, in percent."""
    return f"{reader.exact(100 * share)}{GROUP}%"


def utilisation_text(export: Export, code: str | None, utilisation: float | None, reader: Reader) -> str:
    """Utilisation inside a sentence, with the allowed one where that is below 1."""
    bound = bound_of(export, code)
    share = reader.percent(utilisation, bound)
    if bound == 1 or utilisation is None:
        return share
    return reader.sentence(
        Sentence(N_("{used} (at most {allowed})"), {"used": share, "allowed": exact_percent(bound, reader)})
    )


def quantity_text(value: float | None, unit: str, reader: Reader, beside: float | None = None) -> str:
    """Computed number with its unit (suffix or symbol), with enough digits to differ from the number beside it."""
    return reader.with_unit(reader.figure(value, unit, beside), unit)


def paper(reader: Reader) -> Paper:
    """Paper of a reader: US letter for US units, else A4."""
    return "us-letter" if reader.preset == "US" else "a4"


def catalogue_version(export: Export, reader: Reader) -> str:
    """Version of the catalogue, with a note where the catalogue is not at hand and its figures are missing."""
    version = export.selection.catalogue_version
    missing = reader.text(N_("not kept: published figures appear only where the result gives them"))
    return version if export.figures else f"{version} ({missing})"

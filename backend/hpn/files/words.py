"""Numbers and places of a check in words, alike in the report and in the workbook."""

from typing import Literal

from hpn.engine.checks import allowed
from hpn.files.export import Export
from hpn.words.reader import GROUP, Reader
from hpn.words.wording import N_, Sentence

Paper = Literal["a4", "us-letter"]


def bound_of(export: Export, code: str | None) -> float:
    """Largest utilisation with which a check passes."""
    return allowed(code, export.application.requirements.utilisation)


def title_of(export: Export, code: str, reader: Reader) -> str:
    """Title of a check as the selection has it."""
    return reader.text(export.selection.check_definitions[code].title)


def exact_percent(share: float, reader: Reader) -> str:
    """A share that was given, in percent."""
    return f"{reader.exact(100 * share)}{GROUP}%"


def used(export: Export, code: str | None, utilisation: float | None, reader: Reader) -> str:
    """A utilisation inside a sentence, with what is allowed where that is less than the limit."""
    bound = bound_of(export, code)
    share = reader.percent(utilisation, bound)
    if bound == 1 or utilisation is None:
        return share
    return reader.told(
        Sentence(N_("{used} (at most {allowed})"), {"used": share, "allowed": exact_percent(bound, reader)})
    )


def measured(value: float | None, unit: str, reader: Reader, beside: float | None = None) -> str:
    """A computed number with its unit, given as suffix or symbol, told apart from the number beside it."""
    return reader.with_unit(reader.figure(value, unit, beside), unit)


def paper(reader: Reader) -> Paper:
    """Paper of a reader: that of the country whose units they read."""
    return "us-letter" if reader.preset == "US" else "a4"


def catalogue_version(export: Export, reader: Reader) -> str:
    """Version of the catalogue, and that its own figures are missing where it is not at hand."""
    version = export.selection.catalogue_version
    missing = reader.text(N_("not kept: published figures appear only where the result gives them"))
    return version if export.figures else f"{version} ({missing})"

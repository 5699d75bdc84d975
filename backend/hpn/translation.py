"""Texts in other languages: the one catalogue behind the page and every file, compiled in memory when first needed."""

from collections.abc import Mapping
from functools import cache
from gettext import GNUTranslations, NullTranslations
from io import BytesIO
from pathlib import Path

from babel.messages.catalog import Catalog
from babel.messages.mofile import write_mo
from babel.messages.pofile import read_po

FOLDER = Path(__file__).parent / "locale"
LANGUAGES = ("en", "de")
"""English is the language of the texts themselves and needs no catalogue."""


def path_of(code: str) -> Path:
    """Catalogue of a language."""
    return FOLDER / code / "LC_MESSAGES/hpn.po"


def catalogue(code: str) -> Catalog:
    """Catalogue of a language as it stands in its file."""
    with path_of(code).open("rb") as file:
        return read_po(file, locale=code, domain="hpn")


@cache
def translations(code: str) -> NullTranslations:
    """Translations of one of LANGUAGES for gettext; raises KeyError for another."""
    if code not in LANGUAGES:
        raise KeyError(code)
    if code == "en":
        return NullTranslations()
    compiled = BytesIO()
    write_mo(compiled, catalogue(code))
    compiled.seek(0)
    return GNUTranslations(compiled)


@cache
def texts(code: str) -> Mapping[str, str]:
    """English text -> text in one of LANGUAGES, without those that have a plural; raises KeyError for another."""
    if code not in LANGUAGES:
        raise KeyError(code)
    if code == "en":
        return {}
    return {str(m.id): str(m.string) for m in catalogue(code) if m.id and m.string and not m.pluralizable}

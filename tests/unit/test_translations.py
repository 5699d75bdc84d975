"""Every text has its translation, with the same places to fill, and nothing on the pages is left out of it."""

import re
from string import Formatter

import pytest

from hpn.words.reader import LANGUAGES, catalogue, translations
from tools.messages import missing

OTHERS = [code for code in LANGUAGES if code != "en"]


@pytest.mark.parametrize("code", OTHERS)
def test_catalogue_has_every_text_and_no_other(code: str) -> None:
    assert missing(code) == []  # `make messages` brings it up to date


@pytest.mark.parametrize("code", OTHERS)
def test_translations_fill_the_same_places(code: str) -> None:
    for message in catalogue(code):
        originals, translated = _listed(message.id), _listed(message.string)
        expected = _places(originals[-1]) if originals and originals[-1] else set()
        for text in translated if expected else ():
            # A singular may spell its number out.
            assert _places(text) | {"num"} == expected | {"num"}, (originals, text)


@pytest.mark.parametrize("code", OTHERS)
def test_percent_signs_are_doubled_exactly_where_the_original_doubles_them(code: str) -> None:
    for message in catalogue(code):
        for original, text in zip(_listed(message.id), _listed(message.string), strict=True):
            assert ("%%" in original) == ("%%" in text), original


def test_language_without_a_catalogue_is_refused() -> None:
    with pytest.raises(KeyError):
        translations("fr")


def _listed(text: object) -> list[str]:
    return [str(part) for part in text] if isinstance(text, tuple | list) else [str(text)]


def _places(template: str) -> set[str]:
    percent = set(re.findall(r"%\(([a-z]+)\)s", template))
    return percent or {name for _, name, _, _ in Formatter().parse(template) if name}

"""Texts and numbers of the files in English and German."""

import re

import pytest

from hpn.account.inputs import LOADS, REQUIREMENTS
from hpn.catalogue import Catalogue
from hpn.files.report.content import content
from hpn.files.workbook.workbook import workbook
from hpn.words import reader as readers
from hpn.words.reader import LANGUAGES, Reader
from hpn.words.reader import catalogue as translated_texts
from tests.report.cases import CASES, language, typed_export_of

ENGLISH, GERMAN = language("en"), language("de")


@pytest.mark.parametrize("case", CASES)
def test_every_text_of_the_files_is_translated(
    case: str, catalogue: Catalogue, monkeypatch: pytest.MonkeyPatch
) -> None:
    known, lacking = {message.id for message in translated_texts("de")}, set()
    original = Reader.text

    def noting(reader: Reader, english: str) -> str:
        if english and english not in known and re.search("[a-z]{2}", re.sub(r"{\w+}", "", english)):
            lacking.add(english)
        return original(reader, english)

    monkeypatch.setattr(Reader, "text", noting)
    export = typed_export_of(CASES[case], catalogue)
    content(export, GERMAN)
    workbook(export, GERMAN)
    assert lacking <= UNTRANSLATED


UNTRANSLATED = {"Nm", "Nm/rad", "kg", "kg·m²", "mm", "arcmin"}
"""Symbols of units that every language writes alike."""


def test_sources_are_told_in_the_language_of_the_file() -> None:
    assert GERMAN.source("table 12.1, page 12") == "Tab. 12.1, S.\u202f12"
    assert GERMAN.source("section 3.2") == "Abschn. 3.2"
    assert GERMAN.source("supplied by the user: my.csv") == "vom Benutzer geliefert: my.csv"
    assert GERMAN.source("your input") == "Eingabe"
    assert GERMAN.source("a text of {somebody} else") == "a text of {somebody} else"


@pytest.mark.parametrize(
    ("value", "english", "german"),
    [
        (32.0210136, "32.02", "32,02"),
        (9.3, "9.3", "9,3"),
        (-0.5, "−0.5", "−0,5"),
        (999.96, "1 000", "1.000"),
        (1167275.9, "1 167 276", "1.167.276"),
        (0, "0", "0"),
        (1.5e12, "1.500·10¹²", "1,500·10¹²"),
        (2e-7, "2.000·10⁻⁷", "2,000·10⁻⁷"),
        (None, "–", "–"),
    ],
)
def test_computed_numbers(value: float | None, english: str, german: str) -> None:
    assert ENGLISH.figure(value).replace("\u202f", " ") == english
    assert GERMAN.figure(value).replace("\u202f", " ") == german


@pytest.mark.parametrize(
    ("share", "text"),
    [(0.781, "78.1 %"), (1.0, "100.0 %"), (1.0000001, "100.00001 %"), (0.99999, "99.999 %"), (0.00033, "0.0 %"),
     (0, "0.0 %"), (64.29, "6 429 %"), (123456.0, "1.235·10⁷ %"), (None, "–")],
)  # fmt: skip
def test_a_percentage_is_never_rounded_to_the_limit(share: float | None, text: str) -> None:
    assert ENGLISH.percent(share).replace("\u202f", " ") == text


@pytest.mark.parametrize("value", [40.0, 0.3, 1e-5, 123456.789, 2.5e11, -1.25e-13, 10**15])
def test_an_input_is_written_as_it_was_given(value: float) -> None:
    written = ENGLISH.exact(value).replace("\u202f", "").replace("−", "-")
    mantissa, _, exponent = written.partition("·10")
    power = int(exponent.translate(str.maketrans("⁻⁰¹²³⁴⁵⁶⁷⁸⁹", "-0123456789")) or 0)
    assert float(mantissa) * 10**power == pytest.approx(value, rel=1e-12)


@pytest.mark.parametrize(
    ("value", "text"),
    [(0, "0"), (0.30000000000000004, "0.3"), (250000, "250 000"), (2.5e6, "2.5·10⁶"), (-5e-4, "−5·10⁻⁴")],
)
def test_a_round_number_on_an_axis(value: float, text: str) -> None:
    assert ENGLISH.tick(value).replace("\u202f", " ") == text


def test_every_language_has_its_marks_and_its_dates() -> None:
    assert tuple(readers.LANGUAGE_NAMES) == LANGUAGES
    assert all(Reader(code).decimal != Reader(code).group for code in LANGUAGES)


def test_every_input_of_the_model_is_shown(catalogue: Catalogue) -> None:
    application = typed_export_of(CASES["everything"], catalogue).application
    for part in ("output_load", "requirements", "emergency_stop"):
        for name, _ in getattr(application, part):
            assert any(path.startswith(f"{part}.{name}") for path in (*LOADS, *REQUIREMENTS)), (part, name)
    assert {"application_area", "rank_by", "duty_cycle.pause_s"} <= {*LOADS, *REQUIREMENTS}

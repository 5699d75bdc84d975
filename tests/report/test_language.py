"""Texts and numbers of the files in English and German."""

import re
from dataclasses import dataclass, field
from string import Formatter

import pytest

from hpn.catalogue import Catalogue
from hpn.explanations import EXPLANATIONS
from hpn.report.content import content
from hpn.report.inputs import LOADS, REQUIREMENTS
from hpn.report.language import Language, language
from hpn.report.standings import STANDINGS
from hpn.report.workbook import workbook
from tests.report.cases import CASES, export_of

ENGLISH, GERMAN = language("en"), language("de")


@dataclass(frozen=True)
class Watching(Language):
    """German that remembers which texts it lacks."""

    lacking: set[str] = field(default_factory=set, compare=False)

    def text(self, english: str) -> str:
        """The text; a lacking one is noted."""
        if english and english not in self.messages:
            self.lacking.add(english)
        return super().text(english)

    def filled(self, english: str) -> str:
        """The filled text; one of unknown pattern is noted."""
        german = super().filled(english)
        if german == english not in self.messages and re.search("[a-z]", english):
            self.lacking.add(english)
        return german


@pytest.mark.parametrize("case", CASES)
def test_every_text_of_the_files_is_translated(case: str, catalogue: Catalogue) -> None:
    export = export_of(CASES[case], catalogue)
    german = Watching("de", GERMAN.messages)
    content(export, german)
    workbook(export, german)
    assert german.lacking == set()


def test_translations_have_the_same_places_to_fill() -> None:
    for english, german in GERMAN.messages.items():
        assert _places(english) == _places(german), english


def _places(template: str) -> set[str]:
    return {name for _, name, _, _ in Formatter().parse(template) if name}


def test_a_filled_sentence_is_translated_with_its_values() -> None:
    sentence = "Motor torques use the efficiency of 92.5 % that you assume."
    assert GERMAN.filled(sentence) == "Motormomente sind mit dem angenommenen Wirkungsgrad von 92,5 % gerechnet."
    assert GERMAN.filled("table 12.1, page 12") == "Tabelle 12.1, Seite 12"
    area = "Use in this area (vacuum) needs a risk assessment and the maker's approval (handbook 2.4)."
    assert "(Vakuum)" in GERMAN.filled(area)
    assert GERMAN.filled("a text of somebody's supplement") == "a text of somebody's supplement"


@pytest.mark.parametrize(
    ("value", "english", "german"),
    [
        (32.0210136, "32.02", "32,02"),
        (9.3, "9.3", "9,3"),
        (-0.5, "−0.5", "−0,5"),
        (1167275.9, "1 167 276", "1 167 276"),
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
    [(0.781, "78.1 %"), (1.0, "100.0 %"), (1.0000001, "100.00001 %"), (0.99999, "99.999 %"), (0.00033, "0.033 %"),
     (0, "0.0 %"), (64.29, "6429 %"), (None, "–")],
)  # fmt: skip
def test_a_percentage_is_never_rounded_to_the_limit(share: float | None, text: str) -> None:
    assert ENGLISH.percent(share).replace("\u202f", "").replace("\xa0", " ") == text


@pytest.mark.parametrize("value", [40.0, 0.3, 1e-5, 123456.789, 2.5e11])
def test_an_input_is_written_as_it_was_given(value: float) -> None:
    written = ENGLISH.exact(value).replace("\u202f", "")
    mantissa, _, exponent = written.partition("·10")
    power = int(exponent.translate(str.maketrans("⁻⁰¹²³⁴⁵⁶⁷⁸⁹", "-0123456789")) or 0)
    assert float(mantissa) * 10**power == pytest.approx(value, rel=1e-12)


def test_every_check_has_its_relation() -> None:
    assert STANDINGS.keys() == EXPLANATIONS.keys()


def test_every_input_of_the_model_is_shown(catalogue: Catalogue) -> None:
    application = export_of(CASES["everything"], catalogue).application
    given = {entry.path for entry in (*LOADS, *REQUIREMENTS)}
    for part in ("output_load", "requirements", "emergency_stop"):
        for name, value in getattr(application, part):
            path = ("loads" if part == "output_load" else part, name)
            assert any(known[:2] == path for known in given), (path, value)
    assert {("application_area",), ("rank_by",), ("duty_cycle", "pause_s")} <= given

"""Texts are in the field's terms: none says what the lists of words replace, and all have one apostrophe."""

import ast
import re
from collections.abc import Iterator
from pathlib import Path

import pytest
from babel.messages.catalog import Catalog

from hpn.account.lines import WORDS
from hpn.application import Application
from hpn.catalogue import Catalogue as Gears
from hpn.engine.selection import select
from hpn.explain.calculation import calculation_of
from hpn.explain.drawings import Subject
from hpn.explain.drawings.bearing import bearing_figure
from hpn.explain.drawings.envelope import envelope_scene
from hpn.explain.drawings.picture import bearing_picture
from hpn.links.symbols import BY_NAME
from hpn.words.reader import Reader, catalogue
from tests.build import cycle, phase
from tools.messages import BACKEND, TEMPLATES, texts

ENGLISH = (
    r"\bof these and T_k\b|times$",
    r"How far each may go|all else as given",
    r"of what a constant load may be",
    r"bearing decides, not",
    r"\b[Ss]tanding\b",
    r"\b[Ww]ish(es)?\b|^Prefer$",
    r"half reach it|nine of ten|^which is$",
    r"Limits and surroundings",
    r"^What to turn|^Otherwise$|^Tests$",
    r"so hard that|not even one stop|not one is allowed",
    r"can’t be taken|^Take these phases|^Add them to mine",
    r"out of reach|leads nowhere",
    r"[Bb]est compromise|^Keys$|adaption",
)
"""Patterns of the left column of the English list."""

GERMAN = (
    r"\b[Ll]astfaktor",
    r"^Stand:?$",
    r"^Bedarf$|^besteht( nicht)?$|Wünsche|nichts gewählt",
    r"[Uu]ntere Schranke|Not-Halte\b|^Tasten$",
    r"\b[Ss]icher(n|t|ung)\b|gesichert\b|Gesichert\b",
    r"-Fache[n]? betragen|höchstens das .*-Fache",
)

SYMBOLS = r"\bN_k max|n_out_(av|max)|n_in_(av|max)|n_in (av|max)| dyn\(max\)|\bK3\b|\bL max\b"
"""Second spellings of symbols that `quantities.py` writes in one way."""

STRAIGHT = re.compile(r"[A-Za-zäöüß]'(?:s|t|re|ve|ll|d)\b")


def strings(messages: Catalog, translated: bool) -> list[str]:
    """Texts of a catalogue, or their translations."""
    values = [message.string if translated else message.id for message in messages if message.id]
    return [str(text) for one in values for text in (one if isinstance(one, list | tuple) else [one])]


@pytest.fixture(scope="module")
def english() -> list[str]:
    """Texts of code and templates."""
    return strings(texts(), translated=False)


@pytest.mark.parametrize("pattern", [*ENGLISH, SYMBOLS])
def test_no_english_text_says_it_the_old_way(pattern: str, english: list[str]) -> None:
    assert [text for text in english if re.search(pattern, text)] == []


@pytest.mark.parametrize("pattern", [*GERMAN, SYMBOLS])
def test_no_german_text_says_it_the_old_way(pattern: str) -> None:
    assert [text for text in strings(catalogue("de"), translated=True) if re.search(pattern, text)] == []


def constants(path: Path) -> Iterator[str]:
    """String constants of a module that are no docstrings."""
    tree = ast.parse(path.read_text())
    statements = {id(node.value) for node in ast.walk(tree) if isinstance(node, ast.Expr)}
    for node in ast.walk(tree):
        if isinstance(node, ast.Constant) and isinstance(node.value, str) and id(node) not in statements:
            yield node.value


def test_there_is_one_apostrophe() -> None:
    code = [text for path in sorted(BACKEND.rglob("*.py")) for text in constants(path)]
    pages = [re.sub(r"\{#.*?#\}", "", path.read_text(), flags=re.DOTALL) for path in sorted(TEMPLATES.glob("*.html"))]
    german = strings(catalogue("de"), translated=True)
    assert [result[0] for text in (*code, *pages, *german) if (result := STRAIGHT.search(text))] == []


@pytest.mark.parametrize("name", ["bm", "Lbb"])
def test_the_form_and_the_report_have_one_word_for_a_choice(name: str) -> None:
    choices = BY_NAME[name].choices
    assert choices and {code: WORDS[code] for code in choices} == choices


@pytest.mark.parametrize("model", ["linear", "iso281"])
def test_the_plot_and_the_calculation_state_one_basis(model: str, catalogue: Gears) -> None:
    document = cycle(phase(40, 250), output_load={"radial_N": 500.0, "model": model})
    application = Application.model_validate(document)
    selection = select(application, catalogue)
    candidate = selection.foremost
    gear = catalogue.by_designation[candidate.designation]
    picture = bearing_picture(Subject(application, gear, catalogue), candidate.check("output_bearing_life"))
    assert picture is not None

    drawn = str(bearing_figure(envelope_scene(picture), picture, Reader()))
    steps = calculation_of(candidate, selection.duty, gear, application, catalogue)
    notes = [note.text for step in steps for note in step.notes]

    assert sum(note in drawn for note in notes) == 1

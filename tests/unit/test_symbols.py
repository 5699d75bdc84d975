"""A symbol has the same letter and index wherever it is set: on a page, in a drawing, in a plot, in the report."""

import re
from collections.abc import Callable
from xml.etree.ElementTree import Element

import pytest

from hpn.engine.checks import CHECKS
from hpn.explain.drawings import svg
from hpn.explain.drawings.words import text_of
from hpn.web.pages.templates import as_formula, with_symbols
from hpn.words import symbols
from hpn.words.quantities import QUANTITIES
from hpn.words.reader import Reader
from hpn.words.symbols import sentence
from hpn.words.wording import Sentence

Set = list[tuple[str, str]]

PAGE = re.compile(r'<var class="symbol">([^<]*)(?:<sub>([^<]*)</sub>)?</var>')
PLOT = re.compile(r"(\w)<sub>([^<]*)</sub>")

SYMBOLS = sorted({named.symbol for named in QUANTITIES.values() if "_" in named.symbol} | {"T_in,max", "T_in,rms"})
RELATIONS = sorted({check.relation for check in CHECKS if "_" in check.relation})


def on_page(text: str) -> Set:
    return PAGE.findall(with_symbols(text))


def in_drawing(text: str) -> Set:
    runs = [(run.get("class", ""), run.text or "") for run in svg.text(Element("svg"), "name", (0, 0), text)]
    return [
        (letter, index if kind == "index" else "")
        for (is_letter, letter), (kind, index) in zip(runs, [*runs[1:], ("", "")], strict=True)
        if is_letter == "letter"
    ]


def in_plot(text: str) -> Set:
    return PLOT.findall(text_of(Sentence(text), Reader()))


def in_report(text: str) -> Set:
    return [part for part in symbols.sentence(text) if not isinstance(part, str)]


SETTERS = (on_page, in_drawing, in_plot, in_report)


@pytest.mark.parametrize("setter", SETTERS)
@pytest.mark.parametrize("symbol", [symbol for symbol in SYMBOLS if "/" not in symbol])
def test_a_symbol_of_the_tables_has_all_of_its_index_everywhere(symbol: str, setter: Callable[[str], Set]) -> None:
    letter, _, index = symbol.partition("_")
    assert setter(f"at most {symbol}, as printed") == [(letter, index)]


@pytest.mark.parametrize("text", [*RELATIONS, *SYMBOLS, "n_out_av"])
def test_a_relation_is_set_with_the_same_symbols_everywhere(text: str) -> None:
    first, *others = [setter(text) for setter in SETTERS]
    assert len(first) == text.replace("n_out_av", "n_out").count("_")
    assert others == [first] * len(others)


@pytest.mark.parametrize("symbol", sorted({named.symbol for named in QUANTITIES.values()}))
def test_page_and_report_set_a_symbol_that_stands_alone_alike(symbol: str) -> None:
    parts = [part for part in symbols.formula(symbol) if not isinstance(part, str)]
    assert PAGE.findall(as_formula(symbol)) == parts
    assert bool(parts) == bool(symbol)


def test_characters_around_a_symbol_are_text() -> None:
    assert with_symbols("<b> T_k & η_m") == (
        '&lt;b&gt; <var class="symbol">T<sub>k</sub></var> &amp; <var class="symbol">η<sub>m</sub></var>'
    )


def test_a_ratio_that_divides_a_symbol_is_one_and_no_other_i_of_a_sentence() -> None:
    assert sentence("n_av(max)/i 750, i of them") == [("n", "av(max)"), "/", ("i", ""), " 750, i of them"]

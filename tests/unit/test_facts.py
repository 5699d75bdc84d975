"""Facts of the handbook in words: each has its page, and is shown with the gear or check that it is about."""

import csv
import re
from html import unescape

import pytest
from starlette.testclient import TestClient

from hpn.catalogue import HANDBOOK_FOLDER, Catalogue
from hpn.engine.checks import BY_CODE
from hpn.web.app import create_app


def test_every_fact_has_a_page_and_names_a_check_that_there_is(catalogue: Catalogue) -> None:
    assert len(catalogue.facts) > 20
    for fact in catalogue.facts:
        assert ", page " in fact.source, fact
        assert fact.check is None or fact.check in BY_CODE, fact


def test_a_table_or_equation_is_on_the_page_that_its_number_begins_with() -> None:
    with (HANDBOOK_FOLDER / "sources.csv").open(newline="", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    numbered = [
        (row["page"], page)
        for row in rows
        for page in re.findall(r"(?:table|equation) (\d+)\.\d+", f"{row['source']} {row['title']}")
    ]

    assert len(numbered) > 10
    assert [pair for pair in numbered if pair[0] != pair[1]] == []


@pytest.mark.parametrize(
    "message",
    [
        "PYRONOC UNIVERSAL 00",
        "No additional lubrication is necessary",
        "quality 12.9",
        "spring washers",
        "degrease",
        "lacquered aluminium",
        "half key",
        "additional shaft seal",
        "first the housing to the machine, then the load",
        "robotics and handling",
        "Repeatability: half the largest difference",
        "Transmission accuracy: sum of the largest",
        "Backlash: the value B–B’",
        "for short periods",
        "−20 °C … 60 °C",
        "80 °C",
    ],
)
def test_the_page_of_a_gear_says_it_with_its_source(message: str) -> None:
    with TestClient(create_app()) as client:
        page = client.get("/catalogue/HPN-20A-5").text
    handbook = page[page.index('id="handbook"') :]
    plain = unescape(re.sub(r"<[^>]*>", "", handbook)).replace("\u202f", " ")
    assert message in plain
    assert "section 4.3, p. 24" in plain


def test_a_fact_that_bears_on_a_check_stands_beside_it() -> None:
    with TestClient(create_app()) as client:
        speed, ambient = client.get("/checks/maximum_input_speed").text, client.get("/checks/ambient_temperature").text
    assert "for short periods, as often as desired" in speed
    assert "section 7, p.\u202f28" in speed
    assert "-10 °C to +40 °C" in ambient

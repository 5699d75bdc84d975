"""Changed figures of a saved selection under today's catalogue, on its page and by REST, though the verdict stays."""

import html
import re
from collections.abc import Callable
from pathlib import Path

import pytest
from starlette.testclient import TestClient

from hpn.web.app import create_app
from hpn.web.settings import Settings
from tests.build import Json, worked_example
from tests.property.test_varying_remedy import MOTORS

ONE_RATIO = worked_example(requirements={"ratios": [5]})
WITH_MOTOR = worked_example(requirements={"sizes": ["20A"], "ratios": [5], "motor": {"designation": "M 8"}})
CODE = "HPN-20A-5-J6-BH-AF1"

Edit = Callable[[str], str]


@pytest.fixture
def changed(folder: Path, tmp_path: Path) -> Callable[..., tuple[Json, str]]:
    """Answers of REST and the page on a selection saved before a file of the catalogue was edited."""
    (supplement := tmp_path / "supplement").mkdir()
    (supplement / "motors.csv").write_text(MOTORS, encoding="utf-8")
    settings = Settings(
        database_url=f"sqlite:///{tmp_path}/store.sqlite3",
        catalogue_folder=folder,
        catalogue_supplement=supplement,
    )

    def reopened(application: Json, edits: dict[str, Edit], language: str = "en", **labels: str) -> tuple[Json, str]:
        with TestClient(create_app(settings)) as client:
            saved = client.post("/api/v1/selections", json={"application": application, **labels})
            assert saved.status_code == 201, saved.text
            address = saved.headers["location"]
        for name, edit in edits.items():
            file = (supplement if name == "motors.csv" else folder) / name
            before = file.read_text(encoding="utf-8")
            assert edit(before) != before
            file.write_text(edit(before), encoding="utf-8")
        with TestClient(create_app(settings), cookies={"hpn_language": language}) as client:
            today = client.get(address).json()["today"]
            page = client.get(address.removeprefix("/api/v1")).text
        return today, page[page.index('id="today"') : page.index('id="inputs-heading"')]

    return reopened


def rows(panel: str, table: str) -> list[list[str]]:
    """Cells of a table of the panel, without their marks."""
    match = re.search(rf'<table id="{table}">.*?<tbody>(.*?)</tbody>', panel, re.DOTALL)
    cells = (
        re.findall(r"<t[dh][^>]*>(.*?)</t[dh]>", row, re.DOTALL) for row in (match[1] if match else "").split("</tr>")
    )
    return [[_text(cell) for cell in row] for row in cells if row]


def _text(markup: str) -> str:
    return " ".join(html.unescape(re.sub(r"<[^>]+>", "", markup)).split())


GEAR, BOLTS = ("HPN-20A-5", None), "4 × M6, Ø 100 mm, {} Nm"

FIGURES: dict[str, tuple[Json, str, tuple[str, str], tuple[str | None, str | None], list[str]]] = {
    "clamp_bolts": (
        *(ONE_RATIO, "clamp_bolts.csv", ("20A,M4,4.6", "20A,M4,5.1"), GEAR),
        ["HPN-20A-5", "Motor coupling bolt", "M4 4.6 Nm", "M4 5.1 Nm"],
    ),
    "housing_bolts": (
        *(ONE_RATIO, "housing_bolts.csv", ("20A,4,M6,100,10.1", "20A,4,M6,100,11"), GEAR),
        ["HPN-20A-5", "Housing bolts", BOLTS.format("10.1"), BOLTS.format("11")],
    ),
    "inertia_kgm2": (
        *(WITH_MOTOR, "motors.csv", ("0.0005", "0.0004"), (None, "M 8")),
        ["M 8", "Inertia of the motor kg·m²", "0.0005", "0.0004"],
    ),
}
"""By figure what is saved, what is edited in which file, the gear or motor it is of, and the row of the page."""


@pytest.mark.parametrize("name", FIGURES)
def test_a_figure_that_no_check_depends_on_is_told_with_both_values(
    name: str, changed: Callable[..., tuple[Json, str]]
) -> None:
    application, file, (old, new), owner, row = FIGURES[name]
    today, panel = changed(application, {file: lambda text: text.replace(old, new)})

    # The motor's inertia gives one figure that no check looks at.
    assert {d["field"] for d in today["differences"]} == ({"end_stop_speed_rpm"} if name == "inertia_kgm2" else set())
    [results] = [d for d in today["figure_differences"] if d["field"] == name]
    assert (results["candidate"], results["motor"]) == owner
    assert results["saved"] != results["today"]
    assert ("Today the result is the same" in panel) == (name != "inertia_kgm2")
    assert rows(panel, "figure-differences") == [row]


def test_figures_that_are_the_same_are_not_told(changed: Callable[..., tuple[Json, str]]) -> None:
    today, panel = changed(WITH_MOTOR, {"motors.csv": lambda text: text.replace("M 1,3000", "M 1,2900")})
    assert today["figure_differences"] == []
    assert "figure-differences" not in panel


@pytest.mark.parametrize(
    ("language", "gone", "code", "none"),
    [
        (
            "en",
            "Today’s catalogue no longer has HPN-20A-5.",
            "The ordering code HPN-20A-5-J6-BH-AF1 is not",
            "no candidate",
        ),
        (
            "de",
            "Der heutige Katalog hat HPN-20A-5 nicht mehr.",
            "Der Bestellschlüssel HPN-20A-5-J6-BH-AF1",
            "kein Kandidat",
        ),
    ],
)
def test_a_gear_that_is_gone_is_told_as_that(
    language: str, gone: str, code: str, none: str, changed: Callable[..., tuple[Json, str]]
) -> None:
    def without(text: str) -> str:
        return re.sub(r"(?m)^20A,5,.*\n", "", text)

    _, panel = changed(ONE_RATIO, {"gears.csv": without, "ratings.csv": without}, language, ordering_code=CODE)
    message = _text(panel)

    assert gone in message and code in message
    [[_, _, _, today]] = [row for row in rows(panel, "differences") if row[0] == "HPN-20A-5"]
    assert today == none
    assert "publishes other figures" not in message and "andere Werte" not in message


def test_an_output_version_that_is_gone_is_told(changed: Callable[..., tuple[Json, str]]) -> None:
    def without(text: str) -> str:
        return re.sub(r"(?m)^output,J6,.*\n", "", text)

    _, panel = changed(ONE_RATIO, {"versions.csv": without}, ordering_code=CODE)
    assert f"The ordering code {CODE} is not in today’s catalogue" in _text(panel)


def test_utilisations_and_reserves_are_percentages(changed: Callable[..., tuple[Json, str]]) -> None:
    """T_N of 50 Nm for 80: 32.02 Nm are 64 % for 40 %; by hand."""
    _, panel = changed(ONE_RATIO, {"ratings.csv": lambda text: text.replace("20A,5,149,80,", "20A,5,149,50,")})
    by_name = {row[1]: row[2:] for row in rows(panel, "differences")}
    assert by_name["Load limit 1: average torque: Utilisation %"] == ["40.0", "64.0"]
    assert by_name["All duty torques %"] == ["250", "156"]


def test_many_gears_with_other_figures_are_counted(changed: Callable[..., tuple[Json, str]]) -> None:
    """One bolt of a size belongs to all of its 13 ratios."""
    _, panel = changed(worked_example(), {"clamp_bolts.csv": lambda text: text.replace("20A,M4,4.6", "20A,M4,5.1")})
    assert "HPN-20A-3, HPN-20A-4, " in (message := _text(panel))
    assert "HPN-20A-45 and 1 more." in message

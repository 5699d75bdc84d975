"""Sheet of a motor list: its cells are read as a table is, refused at their rows, and never lost."""

from html import unescape

import pytest
from starlette.testclient import TestClient

from hpn.application import CurvePoint, MotorEntry
from hpn.tables.motor_inputs import MOTORS
from hpn.tables.reading import reading_of
from hpn.web.app import create_app
from hpn.web.motor_cells import COLUMNS, answers, rows_of, table_of
from hpn.web.motor_tables import motors_in
from hpn.web.pages.reading import choices_of
from hpn.web.settings import Settings
from hpn.words.reader import Reader
from tests.web.sheets import cells, problems, rows, typed
from tests.web.test_motor_list_pages import kept

CURVE = "0 : 2.8 : 7.2\n3000 : 2.4 : 7.2"


def motors(client: TestClient, place: str) -> list[dict[str, object]]:
    listed: list[dict[str, object]] = client.get(f"/api/v1{place}").json()["motors"]
    return listed


@pytest.mark.parametrize("language", ["en", "de"])
@pytest.mark.parametrize("torque", [0.64, 1.234, 12.345, 1234.5, 1e-5, 123456.789012])
def test_a_sheet_that_is_sent_as_it_is_shown_is_the_same_list(language: str, torque: float) -> None:
    """12.345 is no 12,345: in either language no figure of a sheet has two readings."""
    curve = (
        CurvePoint(speed_rpm=0, continuous_Nm=torque, peak_Nm=torque),
        CurvePoint(speed_rpm=1.234, continuous_Nm=torque, peak_Nm=torque),
    )
    own = [
        MotorEntry(designation='A "2"', rated_torque_Nm=torque, inertia_kgm2=torque, maximum_speed_rpm=1234),
        MotorEntry(designation="B", stall_torque_Nm=torque, weight_kg=1.234, curve=curve),
    ]
    reader = Reader(language)

    sheet = table_of(rows_of(own, reader.decimal), reader)
    table = reading_of(sheet.text, sheet.bounds, choices_of(answers())).table

    assert table is not None and table.whole, table
    assert motors_in(table) == (own, [])
    assert [table.origins[motor.designation] for motor in own] == [(1,), (2,)]


def test_a_sheet_has_every_figure_of_a_motor() -> None:
    places = {COLUMNS[role].place for role in COLUMNS}
    assert places | {"curve"} == set(MotorEntry.model_fields)
    assert set(COLUMNS) <= set(MOTORS.by_role)


def test_cells_are_changed_and_a_motor_is_typed_into_the_empty_last_row(keeping: TestClient) -> None:
    place = kept(keeping, "Cells")
    page = keeping.get(place).text
    assert [row[0] for row in rows(page)] == ["S40-0.6", "S60-1.3", ""]

    changes = {(1, "Tmn"): "0.7 Nm", (3, "mot"): "S80", (3, "Tmn"): "2.39", (3, "Jm"): "1.14", (3, "mcv"): CURVE}
    assert typed(keeping, cells(page, changes), f"{place}/save").status_code == 303

    first, _, third = motors(keeping, place)
    assert first["rated_torque_Nm"] == 0.7
    assert third["inertia_kgm2"] == 1.14e-4  # kg·cm² are 10⁻⁴ kg·m²
    assert third["curve"] == [
        {"speed_rpm": 0, "continuous_Nm": 2.8, "peak_Nm": 7.2},
        {"speed_rpm": 3000, "continuous_Nm": 2.4, "peak_Nm": 7.2},
    ]


@pytest.mark.parametrize(
    ("cell", "text", "sentence"),
    [
        ("Tmn", "nonsense", "Not saved: correct these rows, or remove them: 2."),
        ("Tmn", "1.27 kg", "Not saved: correct these rows, or remove them: 2."),
        ("Tmn", "-1", "Not saved: correct these rows, or remove them: 2."),
        ("Tmn", "9", "Row 2, S60-1.3, is left out: rated_torque_Nm is above peak_torque_Nm."),
        ("Tmn", "1e400", "Not saved: correct these rows, or remove them: 2."),
        ("Tmn", "=1+1", "Not saved: correct these rows, or remove them: 2."),
        ("Tmn", "0", "Cells that are 0, first in row 2 of “Rated motor torque [Nm]”. What do they mean?"),
        ("Jm", "0,41", "Motors with a cell that is no number above 0 are left out (1): row 2."),
        ("mot", "", "Rows without a name: 2."),
        ("mot", "S40-0.6", "Motors that stand there twice with other figures: S40-0.6. Which one counts?"),
        ("mcv", "0 : 1", "Incomplete points of a torque curve, first in row 2: Peak torque at this speed is missing."),
        ("mcv", "0 : 1 : 2 : 3\n5 : 1 : 2", "Not saved: correct these rows, or remove them: 2."),
        ("mcv", "0 : 1 : 2\n0 : 1 : 2", "Not saved: correct these rows, or remove them: 2."),
    ],
)
def test_a_cell_that_is_no_figure_is_refused_at_its_row_and_stays_as_typed(
    keeping: TestClient, cell: str, text: str, sentence: str
) -> None:
    place = kept(keeping, f"Refused {cell} {text}"[:60].replace("\n", " "))
    before = motors(keeping, place)
    fields = cells(keeping.get(place).text, {(2, cell): text, (1, "Tmn"): "0.66"})

    page = typed(keeping, fields, f"{place}/save")

    assert page.status_code == 422
    assert sentence in unescape("\n".join(problems(page.text)))
    assert cells(page.text) == fields
    assert motors(keeping, place) == before


def test_an_answer_to_a_question_about_cells_is_taken(keeping: TestClient) -> None:
    place = kept(keeping, "Answered")
    asked = typed(keeping, cells(keeping.get(place).text, {(2, "Tmn"): "0", (3, "mot"): "Third"}), f"{place}/save")
    assert 'name="zeros"' in asked.text

    answered = [*cells(asked.text, {(3, "Tmn"): "3"}), ("zeros", "unknown")]
    assert typed(keeping, answered, f"{place}/save").status_code == 303
    assert motors(keeping, place)[1]["rated_torque_Nm"] is None


def test_points_under_a_name_that_stands_there_twice_are_never_mixed(keeping: TestClient) -> None:
    """In a table a row below may be a further point of the same motor; in a sheet every row is a motor."""
    place = kept(keeping, "Twice")
    changes = {(1, "mcv"): CURVE, (3, "mot"): "S40-0.6", (3, "mcv"): "6000 : 1 : 2"}
    page = typed(keeping, cells(keeping.get(place).text, changes), f"{place}/save")

    assert page.status_code == 422
    assert (
        unescape(problems(page.text)[0]) == "Rows with one name, S40-0.6, of which one has torque-speed points: 1, 3."
    )


def test_rows_are_added_and_removed_by_buttons_and_nothing_is_saved_by_them(keeping: TestClient) -> None:
    place = kept(keeping, "Rows")
    page = keeping.get(place).text

    added = typed(keeping, cells(page, {(3, "mot"): "New", (3, "Tmn"): "not yet a number"}), f"{place}/save", do="add")
    assert added.status_code == 200
    assert [row[0] for row in rows(added.text)] == ["S40-0.6", "S60-1.3", "New", ""]
    removed = typed(keeping, cells(added.text), f"{place}/save", do="remove:1")
    assert [row[0] for row in rows(removed.text)] == ["S60-1.3", "New", ""]
    assert len(motors(keeping, place)) == 2
    assert typed(keeping, cells(removed.text, {(2, "Tmn"): "2"}), f"{place}/save").status_code == 303
    assert [motor["designation"] for motor in motors(keeping, place)] == ["S60-1.3", "New"]


def test_a_new_list_is_typed_into_an_empty_sheet(keeping: TestClient) -> None:
    empty = keeping.post("/motor-lists", data={"do": "add"})
    assert rows(empty.text) == [[""] * 9]

    fields = cells(empty.text, {(1, "mot"): "A", (1, "Tmn"): "1,5", (1, "name"): "Typed"})
    answer = typed(keeping, fields, "/motor-lists")
    assert answer.status_code == 303
    assert motors(keeping, answer.headers["location"])[0]["rated_torque_Nm"] == 1.5
    blank = typed(keeping, cells(empty.text, {(1, "name"): "Blank"}), "/motor-lists")
    assert (blank.status_code, problems(blank.text)) == (422, ["Type a motor into the sheet."])


def test_a_list_that_somebody_else_has_saved_is_replaced_only_on_request(keeping: TestClient) -> None:
    place = kept(keeping, "Two tabs")
    page = keeping.get(place).text
    theirs, own = cells(page, {(1, "Tmn"): "0.7"}), cells(page, {(2, "Tmn"): "1.3", (3, "mot"): "C", (3, "Tmn"): "2"})
    assert typed(keeping, theirs, f"{place}/save").status_code == 303

    refused = typed(keeping, own, f"{place}/save")

    assert refused.status_code == 412
    said = "Somebody else has saved this list since you opened it. Different from yours: S40-0.6, S60-1.3, C."
    assert problems(refused.text) == [said]
    assert [motor["rated_torque_Nm"] for motor in motors(keeping, place)] == [0.7, 1.27]
    assert typed(keeping, cells(refused.text), f"{place}/save", over="2").status_code == 303
    assert [motor["rated_torque_Nm"] for motor in motors(keeping, place)] == [0.64, 1.3, 2]
    assert typed(keeping, cells(refused.text), f"{place}/save", over="2").status_code == 412


def test_a_sheet_stays_as_typed_while_the_store_is_away(keeping: TestClient) -> None:
    kept_before = kept(keeping, "Before")
    settings = Settings(database_url="postgresql://nobody@127.0.0.1:9/none", database_seconds=2, log_level="error")
    with TestClient(create_app(settings)) as client:
        fields = [("mot", "A"), ("Tmn", "1.5"), ("name", "Away"), ("version", "1")]
        for place in ("/motor-lists", f"{kept_before}/save"):
            page = typed(client, fields, place)
            assert page.status_code == 503 and page.headers["retry-after"]
            assert rows(page.text)[0][:2] == ["A", "1.5"]
            assert ("name", "Away") in cells(page.text)


def test_a_german_sheet_is_written_and_read_with_a_comma(keeping: TestClient) -> None:
    place = kept(keeping, "Komma")
    page = keeping.get(place, headers={"accept-language": "de"}).text
    assert rows(page)[0][1] == "0,64"

    fields = cells(page, {(2, "Jm"): "0,42"})
    keeping.headers["accept-language"] = "de"
    answer = typed(keeping, fields, f"{place}/save")
    del keeping.headers["accept-language"]
    assert answer.status_code == 303
    assert motors(keeping, place)[1]["inertia_kgm2"] == 4.2e-5
    assert motors(keeping, place)[0]["rated_torque_Nm"] == 0.64


@pytest.mark.parametrize(
    "fields",
    [
        [("mot", "A")] * 302,
        [("mot", "A"), *[("Tmn", "1")] * 80_000],
        [("mot", "x" * 200_000)],
        [("mot", "A"), ("Tmn", "9" * 200_000)],
        [("mot", "A"), ("mcv", ";" * 100_000)],
        [("mot", "A"), ("mcv", ":" * 100_000)],
        [("mot", "A"), ("mcv", "\n".join(f"{k}:1:2" for k in range(30_000)))],
        [("mot", '"><script>alert(1)</script>'), ("Tmn", "<b>")],
        [("mot", '"A'), ("Tmn", '"'), ("mot", "B"), ("Tmn", "2")],
        [("mot", "Motor"), ("Tmn", "Nm"), ("mot", "rpm")],
        [("mot", "A"), ("Tmn", "1"), ("do", "remove:x"), ("of", "*")],
        [("mot", "A"), ("do", "remove:" + "9" * 5000)],
        [("mot", "A"), ("do", "x"), ("r1", "skip"), ("u1", "kg")],
    ],
)
def test_nothing_typed_into_a_sheet_breaks_the_page(keeping: TestClient, fields: list[tuple[str, str]]) -> None:
    before = len(keeping.get("/api/v1/motor-lists").json()["lists"])
    page = typed(keeping, [*fields, ("name", "Broken")], "/motor-lists")

    assert page.status_code in (200, 413, 422)
    assert len(page.content) < 3_000_000 and "<script>alert" not in page.text
    assert len(keeping.get("/api/v1/motor-lists").json()["lists"]) == before

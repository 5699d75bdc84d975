"""Motor lists on the pages: a data sheet is pasted, open questions are asked, the list is stored, edited, deleted."""

import re
from html import unescape

import pytest
from httpx2 import Response
from starlette.testclient import TestClient

from hpn.tables.columns import Choices
from hpn.tables.motor_inputs import MOTORS
from hpn.tables.motors import read_motors
from hpn.tables.sheets import grids_of
from hpn.tables.table import Table
from hpn.web.app import create_app
from hpn.web.motor_tables import as_text, motors_in
from hpn.web.settings import Settings
from tests.web.sheets import cells, typed

SHEET = """Motor;M_N [Nm];M_max [Nm];n_N [rpm];n_max [rpm];J_m [kg·cm²];m [kg]
S40-0.6;0.64;1.9;3000;6000;0.17;0.9
S60-1.3;1.27;3.8;3000;6000;0.41;1.4
"""
WIRE = ("Nm", "rpm", "kgm2", "kg", "kW")


def table_of(text: str, **answers: str) -> Table:
    """Reading of a table of motors; a column without a unit is in the wire's unit."""
    return read_motors(grids_of(text)[0], MOTORS, Choices(**answers), WIRE)  # type: ignore[arg-type]


def questions(table: Table) -> list[str]:
    return [question.text for question in table.questions]


def test_a_data_sheet_is_read_by_its_names_and_units() -> None:
    table = table_of(SHEET)

    assert questions(table) == []
    assert table.motors[1] == {
        "designation": "S60-1.3",
        "rated_torque_Nm": 1.27,
        "peak_torque_Nm": 3.8,
        "rated_speed_rpm": 3000,
        "maximum_speed_rpm": 6000,
        "inertia_kgm2": 4.1e-5,
        "weight_kg": 1.4,
    }


@pytest.mark.parametrize(
    ("heading", "figure", "value"),
    [
        ("Rotor inertia [10⁻⁴ kg·m²]", "inertia_kgm2", 2e-4),
        ("Rotor inertia (x10-4 kg·m2)", "inertia_kgm2", 2e-4),
        ("Trägheitsmoment [kg·cm²]", "inertia_kgm2", 2e-4),
        ("Trägheitsmoment [10^-6 kgm²]", "inertia_kgm2", 2e-6),
        ("Peak torque [oz-in]", "peak_torque_Nm", 0.0141231036285),  # twice 28.349523125 g · 9.80665 m/s² · 25.4 mm
        ("Spitzendrehmoment [Ncm]", "peak_torque_Nm", 0.02),
        ("Continuous stall torque [Nm]", "stall_torque_Nm", 2),
        ("M0 [Nm]", "stall_torque_Nm", 2),
        ("Dauerdrehmoment [Nm]", "rated_torque_Nm", 2),
        ("Max. speed [rad/s]", "maximum_speed_rpm", 19.0985931710),  # 60 / π
        ("Nenndrehzahl [1/min]", "rated_speed_rpm", 2),
        ("Masse [g]", "weight_kg", 0.002),
    ],
)
def test_units_of_data_sheets_are_converted(heading: str, figure: str, value: float) -> None:
    (motor,) = table_of(f"Typ;{heading}\nA;2").motors

    assert motor[figure] == pytest.approx(value, rel=1e-11)  # converted numbers have twelve digits


@pytest.mark.parametrize(
    ("heading", "figure"),
    [
        ("Rotor moment of inertia J [kg·cm²]", "inertia_kgm2"),
        ("Massenträgheitsmoment J_M [kgcm²]", "inertia_kgm2"),
        ("Rated torque M_N [Nm]", "rated_torque_Nm"),
        ("Stillstandsdrehmoment M0 [Nm]", "stall_torque_Nm"),
        ("Max. torque M_max [Nm]", "peak_torque_Nm"),
        ("Nenndrehzahl n_N [min⁻¹]", "rated_speed_rpm"),
    ],
)
def test_a_symbol_behind_its_name_is_part_of_the_heading(heading: str, figure: str) -> None:
    (motor,) = table_of(f"Typ;{heading}\nA;2").motors
    assert motor[figure] == pytest.approx(2e-4 if figure == "inertia_kgm2" else 2, rel=1e-11)


def test_a_symbol_of_another_figure_behind_a_name_is_asked() -> None:
    assert questions(table_of("Typ;Rated torque M0 [Nm]\nA;2")) == ["What is column “Rated torque M0 [Nm]”?"]


def test_symbols_above_a_row_of_units_name_the_figures() -> None:
    """The N of M_N is no newton."""
    (motor,) = table_of("Motor;M_N;M_max;n_N;J\n;Nm;Nm;min⁻¹;kg cm²\nA;1;3;3000;0.5").motors
    assert motor == {
        "designation": "A",
        "rated_torque_Nm": 1,
        "peak_torque_Nm": 3,
        "rated_speed_rpm": 3000,
        "inertia_kgm2": 5e-5,
    }


@pytest.mark.parametrize("corner", ["Motor", "Typ"])
@pytest.mark.parametrize("units", [False, True])
def test_a_data_sheet_with_a_column_for_each_motor_is_turned(corner: str, units: bool) -> None:
    heads = [("Nennmoment", "Nm"), ("Nenndrehzahl", "1/min"), ("Trägheitsmoment", "kg·cm²")]
    cells = [("1,2", "2,4", "4,1"), ("3000", "3000", "2000"), ("0,2", "0,3", "0,4")]
    rows = [
        [name, unit, *row] if units else [f"{name} [{unit}]", *row]
        for (name, unit), row in zip(heads, cells, strict=True)
    ]
    text = "\n".join("\t".join(row) for row in [[corner, *([""] if units else []), "M 1", "M 2", "M 3"], *rows])
    motors = table_of(text).motors
    assert [motor["designation"] for motor in motors] == ["M 1", "M 2", "M 3"]
    assert motors[2] == {
        "designation": "M 3",
        "rated_torque_Nm": 4.1,
        "rated_speed_rpm": 2000,
        "inertia_kgm2": 4e-5,
    }


@pytest.mark.parametrize(
    "header", ["Motor;M_N [Nm];J [kg·m²];n_N [rpm]", "Motor;n_N [rpm];J [kg·cm²];M_N [Nm]", "Typ;M_N;J;n_N"]
)
def test_a_second_table_below_the_first_is_never_read_by_the_header_of_the_first(header: str) -> None:
    table = table_of(f"Motor;M_N [Nm];J [kg·cm²];n_N [rpm]\nA;1;0.5;3000\n\n{header}\nB;2;0.9;3000")
    assert table.problem is not None
    assert table.problem.text == "row 4 is another header: paste one table at a time"
    assert table.motors == ()


@pytest.mark.parametrize(
    ("heading", "role"),
    [
        *(("J (kg·m²) x 10^-4", "Jm"), ("Rotor inertia ×10⁻⁴ [kg·m²]", "Jm"), ("Inertia (10^-5 kgm2)", "Jm")),
        *(("Rotor inertia 1e-4 kg·m²", "Jm"), ("Peak torque [10⁻² Nm]", "Tm"), ("Peak torque Nm x 0.01", "Tm")),
        *(("Rated speed [x1000 rpm]", "nmr"), ("Inertia g·m²", "Jm"), ("Peak torque g·cm", "Tm")),
    ],
)
def test_a_factor_or_a_unit_that_is_not_known_is_never_left_out_of_a_figure(heading: str, role: str) -> None:
    """The column's meaning is asked, and then its unit, even if units of other columns are assumed."""
    text = f"Motor;{heading}\nA;2"

    assert questions(table_of(text)) == [f"What is column “{heading}”?"]
    named = read_motors(grids_of(text)[0], MOTORS, Choices(roles={1: role}), WIRE)
    assert [asked.startswith("Which unit is column") for asked in questions(named)] == [True]
    assert named.motors == ()
    said = read_motors(grids_of(text)[0], MOTORS, Choices(roles={1: role}, units={1: "kg_cm2"}), WIRE)
    assert role != "Jm" or said.motors[0]["inertia_kgm2"] == 2e-4


@pytest.mark.parametrize(
    "rows",
    [
        ";Nm;kg·m²\n;;×10⁻⁴",
        ";Nm;kg·m²\n;;10^-4",
        ";;×10⁻⁴\n;Nm;kg·m²",
        "Unit;Nm;10⁻⁵ kg·m²",
        ";Nm;kg·m²\nFactor;;(x 10-4)",
    ],
)
def test_a_factor_in_a_row_of_its_own_below_the_headings_is_asked(rows: str) -> None:
    table = table_of(f"Motor;Peak torque;Inertia\n{rows}\nA;3;0.4\nB;6;0.8")

    assert [asked.startswith("Which unit is column “Inertia") for asked in questions(table)] == [True]


@pytest.mark.parametrize("row", [";;0.0001", ";;1e-4", "Factor;1;1e-4"])
def test_a_row_of_numbers_that_may_be_factors_is_no_motor(row: str) -> None:
    table = table_of(f"Motor;Peak torque [Nm];Inertia [kg·m²]\n{row}\nA;3;0.4", blanks="unknown")

    assert table.problem is not None and table.problem.text.startswith("row 2 may have factors: ")


@pytest.mark.parametrize(
    ("heading", "role"),
    [("Peak torque Nm (lb-in)", "Tm"), ("Inertia kg·cm² / lb·in²", "Jm"), ("Weight kg (lb)", "mmo")],
)
def test_a_heading_with_two_units_is_asked_which_one_the_numbers_are_in(heading: str, role: str) -> None:
    text = f"Motor;{heading}\nA;2\nB;3"

    named = read_motors(grids_of(text)[0], MOTORS, Choices(roles={1: role}), WIRE)
    assert questions(named) == [f"Which unit is column “{heading}” in?"]


def test_a_sheet_with_its_figures_down_the_side_and_units_beside_them_is_read() -> None:
    rows = ("Motor;Unit;A;B", "Rated torque;Nm;1;2", "Peak torque;lb-in;3;6", "Max speed;rpm;6000;5000")
    table = table_of("\n".join((*rows, "Inertia;10⁻⁴ kg·m²;0.4;0.8")))

    assert questions(table) == []
    assert [motor["inertia_kgm2"] for motor in table.motors] == [4e-5, 8e-5]
    assert table.motors[1]["peak_torque_Nm"] == pytest.approx(0.677908974165, rel=1e-11)  # 6 · 4.4482216152605 · 0.0254


@pytest.mark.parametrize("row", ["A;1.3;3000-6000", "A;1.3*;6000*", "A;on request;on request", "A;#N/A;01.02.2024"])
def test_a_row_with_a_cell_that_is_no_number_is_never_lost_without_a_note(keeping: TestClient, row: str) -> None:
    """A range such as 3000-6000 leaves one number beside the name: no heading, and no motor."""
    text = f"Motor;Rated torque [Nm];Max speed [rpm]\n{row}\nB;2.4;5000"
    table = table_of(text)

    assert [motor["designation"] for motor in table.motors] == ["B"]
    said = ["Motors with a cell that is no number above 0 are left out (1): row 2."]
    assert [note.text for note in table.notes] == said
    answer = keeping.post(
        "/api/v1/motor-lists", params={"name": row}, content=text, headers={"Content-Type": "text/csv"}
    )
    assert (answer.status_code, answer.json()["detail"]) == (422, said[0])


def test_cells_with_units_of_their_own_are_rows_of_motors_and_not_of_the_header() -> None:
    table = table_of("Motor;Rated torque;Rotor inertia\nA;1.5 Nm;0.64 kgcm²\nB;13 lb-in;1e-4 kg m²")

    assert [motor["designation"] for motor in table.motors] == ["A", "B"]
    assert table.motors[0]["inertia_kgm2"] == pytest.approx(6.4e-5, rel=1e-11)
    assert table.motors[1]["rated_torque_Nm"] == pytest.approx(13 * 4.4482216152605 * 0.0254, rel=1e-11)


@pytest.mark.parametrize(
    ("heading", "is_asked"),
    [*(("GD² [kg·m²]", True), ("Rotor GD2 [kg·cm²]", True)), *(("GD²/4 [kg·m²]", False), ("J [kg·m²]", False))],
)
def test_a_flywheel_effect_is_never_read_as_an_inertia(heading: str, is_asked: bool) -> None:
    """GD² is 4 J: read as J, the motor would have four times its inertia, and a ratio four times too good."""
    named = read_motors(grids_of(f"Motor;{heading}\nA;2")[0], MOTORS, Choices(roles={1: "Jm"}), WIRE)

    assert any("GD² is four times the inertia" in asked for asked in questions(named)) == is_asked
    assert bool(named.motors) != is_asked


def test_small_figures_of_a_preview_are_written_as_an_engineer_writes_them(keeping: TestClient) -> None:
    page = sent(keeping, {"text": "Motor;J [kg·cm²];n_max [rpm]\nA;0.005;6000"}).text

    assert "5·10⁻⁷" in page
    assert "5e-07" not in page


def test_inertia_and_power_without_a_unit_are_asked_where_torque_and_speed_are_not() -> None:
    """Sheets often have kg·cm² and W: taken as kg·m² and kW a figure would be 10,000 or 1,000 times too large."""
    asked = questions(table_of("Motor;Rated torque;Max speed;Rotor inertia;Rated power\nA;1.3;6000;0.4;400"))

    assert asked == ["Which unit is column “Rotor inertia” in?", "Which unit is column “Rated power” in?"]


def test_power_over_speed_is_the_rated_torque_where_none_is_given() -> None:
    watts = table_of("Type;Rated power [W];Rated speed [rpm]\nA;400;3000\nB;200;", blanks="unknown")
    beside = table_of("Type;Rated power [kW];Rated speed [rpm];Rated torque [Nm]\nA;0.4;3000;1.3")

    # 400 W at 3000 rpm: 400 / (100 π) Nm
    assert watts.motors[0]["rated_torque_Nm"] == pytest.approx(1.27323954474, rel=1e-11)
    assert len(watts.motors) == 1  # B has no figure without its speed
    assert beside.motors[0]["rated_torque_Nm"] == 1.3


def test_currents_and_torque_constants_are_asked() -> None:
    table = table_of("Motor;Rated torque [Nm];Rated current [mA];k_T [Nm/A]\nA;1;900;0.4")

    assert questions(table) == ["What is column “Rated current [mA]”?", "What is column “k_T [Nm/A]”?"]
    assert table.motors == ()


def test_zeros_and_blanks_are_asked_once_and_become_no_figure() -> None:
    text = "Motor;Rated torque [Nm];Weight [kg]\nA;1.5;\nB;0;2.5\nC;1.5;2.5"

    assert len(questions(table_of(text))) == 2
    unknown = table_of(text, zeros="unknown", blanks="unknown").motors
    assert unknown[0] == {"designation": "A", "rated_torque_Nm": 1.5}
    assert unknown[1] == {"designation": "B", "weight_kg": 2.5}
    left = table_of(text, zeros="skip", blanks="unknown")
    assert [motor["designation"] for motor in left.motors] == ["A", "C"]
    assert any("left out" in note.text for note in left.notes)


def test_a_blank_may_stand_for_the_row_above() -> None:
    motors = table_of("Motor;Max speed [rpm];Weight [kg]\nA;6000;1\nB;;2", blanks="above").motors

    assert motors[1]["maximum_speed_rpm"] == 6000


@pytest.mark.parametrize(("cell", "names"), [("0", ["A", "B", "C"]), ("x", ["A"])])
def test_a_blank_below_what_is_not_known_is_not_known_either(cell: str, names: list[str]) -> None:
    text = f"Motor;Max speed [rpm];Weight [kg]\nA;6000;1\nB;{cell};2\nC;;3"
    motors = table_of(text, blanks="above", zeros="unknown").motors

    assert [motor["designation"] for motor in motors] == names
    assert all("maximum_speed_rpm" not in motor for motor in motors[1:])


def test_motors_that_stand_there_twice_are_asked_unless_they_are_the_same() -> None:
    text = "Motor;Rated torque [Nm]\nA;1.5\nB;2.5\nA;{}"

    assert [motor["designation"] for motor in table_of(text.format("1.5")).motors] == ["A", "B"]
    assert len(questions(table_of(text.format("3.5")))) == 1
    for answer, names, torque in (
        ("first", ["A", "B"], 1.5),
        ("last", ["A", "B"], 3.5),
        ("both", ["A", "B", "A (2)"], 1.5),
    ):
        motors = table_of(text.format("3.5"), twins=answer).motors
        assert [motor["designation"] for motor in motors] == names
        assert motors[0]["rated_torque_Nm"] == torque


def test_a_unit_that_does_not_fit_its_name_is_asked() -> None:
    assert questions(table_of("Motor;Weight [Nm]\nA;2")) == ["What is column “Weight [Nm]”?"]
    assert questions(table_of("Motor;M;J\nA;2;3")) == ["What is column “M”?", "What is column “J”?"]


def test_a_motor_whose_figures_contradict_one_another_is_left_out_with_its_reason() -> None:
    motors, said = motors_in(table_of("Motor;Rated torque [Nm];Peak torque [Nm]\nA;5;2\nB;1;2"))

    assert [motor.designation for motor in motors] == ["B"]
    assert "Row 2, A, is left out" in said[0].text


def test_a_list_that_is_written_as_a_table_is_read_as_the_same_list() -> None:
    motors, _ = motors_in(table_of(SHEET))
    again, _ = motors_in(table_of(as_text(motors), decimal=".", blanks="unknown"))

    assert again == motors


# --- Pages ------------------------------------------------------------------------------------------------------------


def hidden(page: str) -> dict[str, str]:
    """Hidden fields of the form that reads a table."""
    form = page[page.index("motors-upload") :]
    return {name: unescape(value) for name, value in re.findall(r'type="hidden" name="(\w+)" value="([^"]*)"', form)}


def sent(keeping: TestClient, fields: dict[str, str], place: str = "/motor-lists") -> Response:
    """Answer to a form sent as by a browser."""
    return keeping.post(place, files={name: (None, text) for name, text in fields.items()}, follow_redirects=False)


def kept(keeping: TestClient, name: str, text: str = SHEET) -> str:
    """Address of a list that was pasted and stored."""
    shown = sent(keeping, {"text": text})
    assert shown.status_code == 200
    answer = sent(keeping, {**hidden(shown.text), "name": name, "keep": "1"})
    assert answer.status_code == 303, answer.text
    return answer.headers["location"]


def test_a_pasted_sheet_is_shown_as_it_is_read_then_kept_under_a_name(keeping: TestClient) -> None:
    place = kept(keeping, "Servo 230 V")

    page = keeping.get(place).text
    assert "Servo 230 V" in page and "S60-1.3" in page and "0.41" in page
    assert "Servo 230 V" in keeping.get("/motor-lists").text
    listed = keeping.get(f"/api/v1{place}").json()
    assert listed["motors"][0]["inertia_kgm2"] == 1.7e-5


def test_a_list_without_a_name_is_not_kept_and_nothing_is_lost(keeping: TestClient) -> None:
    shown = sent(keeping, {"text": SHEET, "keep": "1"})

    assert shown.status_code == 422
    assert "Name the list." in shown.text and hidden(shown.text)["table"]


def test_open_questions_are_asked_before_a_list_is_kept(keeping: TestClient) -> None:
    text = "Motor;Rated torque [Nm];Rated current [A]\nA;1.5;2.5"
    shown = sent(keeping, {"text": text, "name": "Asked", "keep": "1"})

    assert shown.status_code == 200 and "Rated current" in shown.text
    answered = {**hidden(shown.text), "name": "Asked", "keep": "1", "rest": "skip"}
    assert sent(keeping, answered).status_code == 303


def long_sheet(count: int) -> str:
    return "Motor;M_N [Nm];J_m [kg·cm²]\n" + "".join(f"M {k};1.5;0.4\n" for k in range(1, count + 1))


def test_a_list_longer_than_a_sheet_is_edited_as_text_and_none_of_its_motors_is_lost_unsaid(
    keeping: TestClient,
) -> None:
    place = kept(keeping, "Long", long_sheet(301))
    page = keeping.get(place).text
    text = unescape(page.split("<textarea")[1].split(">", 1)[1].split("</textarea>")[0]).strip()
    fields = {**hidden(page), "name": "Long", "keep": "1", "text": text.replace("M 7\t1.5", "M 7\t1.7")}

    asked = sent(keeping, {**fields, "text": text.replace("M 7\t1.5", "M 7\tmany")}, f"{place}/save")
    assert asked.status_code == 200
    assert "Motors with a cell that is no number above 0 are left out (1): row 8." in asked.text
    assert len(keeping.get(f"/api/v1{place}").json()["motors"]) == 301

    assert sent(keeping, fields, f"{place}/save").status_code == 303
    assert keeping.get(f"/api/v1{place}").json()["motors"][6]["rated_torque_Nm"] == 1.7
    assert sent(keeping, fields, f"{place}/save").status_code == 412
    agreed = {**hidden(asked.text), "version": "2", "name": "Long", "keep": "1"}
    assert sent(keeping, agreed, f"{place}/save").status_code == 303
    assert len(keeping.get(f"/api/v1{place}").json()["motors"]) == 300


def test_a_list_is_deleted_for_good_and_what_is_typed_of_it_can_be_stored_anew(keeping: TestClient) -> None:
    place = kept(keeping, "Gone")
    fields = cells(keeping.get(place).text)
    assert keeping.post(f"{place}/delete", data={"version": "1"}, follow_redirects=False).status_code == 303

    page = typed(keeping, fields, f"{place}/save")
    assert page.status_code == 404
    anew = typed(keeping, cells(page.text), "/motor-lists")
    assert anew.status_code == 303 and anew.headers["location"] != place


def test_a_list_is_deleted_for_good(keeping: TestClient) -> None:
    place = kept(keeping, "Deleted")

    assert keeping.post(f"{place}/delete", data={"version": "1"}, follow_redirects=False).status_code == 303
    assert keeping.get(place).status_code == 404


@pytest.mark.parametrize(
    "fields",
    [{}, {"text": "x"}, {"text": SHEET, "keep": "1", "name": "a\x00b"}, {"table": "no base64"}, {"text": "{}"}],
)
def test_nothing_that_is_sent_breaks_the_page(keeping: TestClient, fields: dict[str, str]) -> None:
    assert sent(keeping, fields or {"link": ""}).status_code in (200, 422)


def test_lists_out_of_reach_say_so_in_the_language_of_the_reader() -> None:
    settings = Settings(database_url="postgresql://nobody@127.0.0.1:9/none", database_seconds=2, log_level="error")
    with TestClient(create_app(settings), headers={"Accept-Language": "de"}) as client:
        listed = client.get("/motor-lists")
        refused = sent(client, {"text": SHEET, "name": "Servo", "keep": "1"})

    for response in (listed, refused):
        assert response.status_code == 503 and response.headers["retry-after"]
        assert "Motorenlisten sind vorübergehend nicht verfügbar" in response.text
        assert "saved selections" not in response.text
    assert "S60-1.3" in refused.text


def test_a_file_that_is_no_table_is_not_carried_along(keeping: TestClient) -> None:
    answer = keeping.post("/motor-lists", files={"file": ("motors.bin", b"\x00\x01\xff")})

    assert answer.status_code == 422
    assert "table" not in hidden(answer.text)

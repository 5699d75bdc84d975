"""Motor lists on the pages: a data sheet is pasted, what it leaves open is asked, and it is kept, edited, deleted."""

import re
from html import unescape

import pytest
from httpx2 import Response
from starlette.testclient import TestClient

from hpn.tables.columns import Choices
from hpn.tables.motors import MOTORS, read_motors
from hpn.tables.sheets import grids_of
from hpn.tables.table import Table
from hpn.web.motor_tables import as_text, motors_in

SHEET = """Motor;M_N [Nm];M_max [Nm];n_N [rpm];n_max [rpm];J_m [kg·cm²];m [kg]
S40-0.6;0.64;1.9;3000;6000;0.17;0.9
S60-1.3;1.27;3.8;3000;6000;0.41;1.4
"""
WIRE = ("Nm", "rpm", "kgm2", "kg", "kW")


def table_of(text: str, **answers: str) -> Table:
    """Reading of a table of motors, a column without a unit being in that of the wire."""
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

    assert motor[figure] == pytest.approx(value, rel=1e-11)  # twelve digits are kept of a converted number


def test_power_over_speed_is_the_rated_torque_where_none_is_given() -> None:
    watts = table_of("Type;Rated power [W];Rated speed [rpm]\nA;400;3000\nB;200;", blanks="unknown")
    beside = table_of("Type;Rated power [kW];Rated speed [rpm];Rated torque [Nm]\nA;0.4;3000;1.3")

    # 400 W at 3000 rpm: 400 / (100 π) Nm
    assert watts.motors[0]["rated_torque_Nm"] == pytest.approx(1.27323954474, rel=1e-11)
    assert "rated_torque_Nm" not in watts.motors[1]
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
    """Answer to a form that is sent as a browser sends it."""
    return keeping.post(place, files={name: (None, text) for name, text in fields.items()}, follow_redirects=False)


def kept(keeping: TestClient, name: str, text: str = SHEET) -> str:
    """Address of a list that is pasted and kept."""
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


def test_a_list_is_edited_as_a_table_and_a_later_change_is_not_overwritten(keeping: TestClient) -> None:
    place = kept(keeping, "Edited")
    page = keeping.get(place).text
    text = unescape(page.split("<textarea")[1].split(">", 1)[1].split("</textarea>")[0]).strip()
    fields = {**hidden(page), "name": "Edited", "keep": "1", "text": text.replace("1.27", "1.37")}

    assert sent(keeping, fields, f"{place}/save").status_code == 303
    assert keeping.get(f"/api/v1{place}").json()["motors"][1]["rated_torque_Nm"] == 1.37
    assert sent(keeping, fields, f"{place}/save").status_code == 412


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

"""Motors with torque curves in pairs, lists, fleets, pictures and machines."""

import csv
import json
import math
import random
from io import BytesIO
from pathlib import Path

import pytest
from openpyxl import load_workbook
from starlette.testclient import TestClient

from hpn.application import Application, MotorEntry, Pairing
from hpn.catalogue import Catalogue, load_catalogue
from hpn.documents.gears import motor_of
from hpn.engine.motors import with_figures
from hpn.engine.pairs import PairTable, pairs_of, table_of
from hpn.engine.selection import select
from hpn.explain.drawings import Subject
from hpn.explain.drawings.plane import Plane, motor_plane
from hpn.explain.drawings.svg import markup
from hpn.fleet.order import Order
from hpn.fleet.run import here, size_fleet
from hpn.tables.columns import ANY, Choices
from hpn.tables.reading import reading_of
from hpn.web.app import create_app
from hpn.web.form.link_reader import parse
from hpn.web.motor_tables import BOUNDS, as_text, motors_in
from hpn.web.settings import Settings
from hpn.words.reader import Reader
from tests.build import LIFTING, TURNING, Json, cycle, phase, worked_example
from tests.conftest import Supplement
from tests.report.test_pdf import page_texts
from tests.unit.test_calculation import steps_of
from tests.unit.test_fitting_motors import CURVE as EFFICIENCY
from tests.unit.test_fitting_motors import OWN
from tests.unit.test_motor_curves import POINTS, entry, query, with_curve

CATALOGUE = load_catalogue()


# --- Pairs ------------------------------------------------------------------------------------------------------------

APPLICATIONS: dict[str, Json] = {
    "typed": worked_example(requirements={"load_inertia_kgm2": 0.5, "utilisation": 0.8, "efficiency": 0.9}),
    "turning": {"duty_cycle": {"motion": TURNING, "pause_s": 0.5}, "requirements": {"motor": {"inertia_ratio": 60}}},
    "lifting": {"duty_cycle": {"motion": LIFTING}},
}


@pytest.mark.parametrize("own", [{}, {"gears": OWN, "efficiency": EFFICIENCY}], ids=["", "own figures"])
@pytest.mark.parametrize("application", APPLICATIONS.values(), ids=APPLICATIONS)
def test_a_pair_with_a_curve_is_judged_as_the_selection_that_takes_it(
    supplemented: Supplement, application: Json, own: dict[str, str]
) -> None:
    catalogue = supplemented(**own) if own else CATALOGUE
    some = [entry(random.Random(number), number, 4000) for number in range(5)]
    some.append(MotorEntry(designation="rated", rated_torque_Nm=9.0, peak_torque_Nm=27.0, inertia_kgm2=1e-3))
    question = Pairing.model_validate({"application": application, "motors": some}).application
    table: PairTable = table_of(question, some, catalogue)

    for row, motor in enumerate(some):
        taken = with_figures(question, motor)
        assert taken.requirements.motor is not None
        assert (taken.requirements.motor.curve, taken.requirements.motor.name) == (motor.curve, motor.designation)
        reply = select(taken, catalogue)
        for column, gear in enumerate(table.gears.rows):
            result = reply.candidate(gear.designation)
            assert result is not None
            thermal = result.check("motor_rated_torque")
            assert thermal is not None
            for figure, expected in (
                (table.utilisation[row, column], result.utilisation),
                (table.thermal[row, column], thermal.utilisation),
            ):
                expected = math.nan if expected is None else expected
                assert figure == pytest.approx(expected, rel=1e-12, nan_ok=True) or math.isinf(figure)


def test_a_pair_that_is_taken_keeps_its_curve_in_the_link_and_opens_as_it_was_judged() -> None:
    api = TestClient(create_app(Settings()))
    motor = {"designation": "S60", "inertia_kgm2": 1e-4, "weight_kg": 2.1, "stall_torque_Nm": 2.8, "curve": POINTS}
    document = {"application": {"duty_cycle": {"motion": TURNING, "pause_s": 0.5}}, "motors": [motor], "top": 1}
    [pair] = api.post("/api/v1/pairs", json=document).raise_for_status().json()["pairs"]

    form = parse(query(pair["link"].removeprefix("/?")))
    assert form.application is not None
    gear = select(form.application, CATALOGUE).candidate(pair["designation"])
    assert gear is not None
    assert gear.utilisation == pytest.approx(pair["utilisation"], rel=1e-12)
    assert form.application.requirements.motor is not None
    assert json.loads(form.application.requirements.motor.model_dump_json())["curve"] == POINTS
    assert api.get(pair["link"]).status_code == 200


def test_a_pair_whose_link_would_be_too_long_has_none() -> None:
    points = [
        {"speed_rpm": k * 101.2345678901234, "continuous_Nm": 2.0 - k * 0.0123456789, "peak_Nm": 7.0 - k * 0.01234567}
        for k in range(50)
    ]
    long = [phase(5 + k / 7, 50 + k / 3, 0.3) for k in range(150)]
    document = {"application": cycle(*long), "motors": [{"designation": "S60", "curve": points}], "top": 1}
    api = TestClient(create_app(Settings()))
    [pair] = api.post("/api/v1/pairs", json=document).raise_for_status().json()["pairs"]

    assert pair["link"] is None


def test_no_ratio_can_save_a_motor_by_its_torque_at_standstill(catalogue: Catalogue) -> None:
    """M₀ counts along a curve: no RMS above it passes at any speed."""
    weak = {"designation": "weak", "inertia_kgm2": 1.0, "curve": POINTS}
    strong = {"designation": "strong", "inertia_kgm2": 1e-5, "curve": POINTS, "stall_torque_Nm": 2.8}
    document = {"application": {"duty_cycle": {"motion": TURNING, "pause_s": 0.5}}, "motors": [weak, strong]}
    expected = Pairing.model_validate(document)
    result = pairs_of(expected, expected.motors or (), catalogue, lambda equipped, gear: None)

    named = next(notice for notice in result.notices if notice.code == "no_ratio_for_motor")
    assert named.values["names"] == "weak"
    assert not any(notice.code == "motor_figures_unknown" for notice in result.notices)


@pytest.mark.parametrize(
    ("inertia", "moves", "has_message"), [(None, True, True), (2e-4, True, False), (2e-4, False, True)]
)
def test_pairs_say_that_a_rotor_is_left_out_where_one_motor_is_judged_by_phases(
    catalogue: Catalogue, inertia: float | None, moves: bool, has_message: bool
) -> None:
    first = {"designation": "A", "inertia_kgm2": 1e-4, "peak_torque_Nm": 9.0}
    second = {"designation": "B", "inertia_kgm2": inertia, "curve": POINTS}
    application = {"duty_cycle": {"motion": TURNING}} if moves else cycle(phase(5, 100))
    expected = Pairing.model_validate({"application": application, "motors": [first, second]})
    result = pairs_of(expected, expected.motors or (), catalogue, lambda equipped, gear: None)

    assert [one.code for one in result.notices].count("rotor_not_included") == has_message


# --- Lists ------------------------------------------------------------------------------------------------------------


def listed(text: str, **answers: str) -> tuple[list[MotorEntry], list[str], list[str]]:
    """Motors of a table, what is said of those left out, and the notes of the reading."""
    table = reading_of(text, BOUNDS, Choices(of=ANY, **answers)).table  # type: ignore[arg-type]
    assert table is not None
    assert not table.questions
    result, message = motors_in(table)
    return result, [one.text for one in message], [note.text for note in table.notes]


ROWS = """Motor\tM0 [Nm]\tJ [kg·cm²]\tm [kg]\tcurve speed [rpm]\tM S1 [Nm]\tcurve peak torque [Nm]
S60\t2.8\t1\t2.1\t6000\t1.5\t3
\t\t\t\t0\t2.8\t7.2
S60\t\t\t\t3000\t2.4\t7.2
S80\t5\t2\t3\t\t\t
"""


def test_rows_of_a_motor_are_the_points_of_its_curve() -> None:
    result, message, notes = listed(ROWS)

    assert [motor.model_dump(exclude_none=True) for motor in result] == [
        {
            "designation": "S60",
            "stall_torque_Nm": 2.8,
            "inertia_kgm2": pytest.approx(1e-4, rel=1e-12),
            "weight_kg": 2.1,
            "curve": tuple(POINTS),
        },
        {
            "designation": "S80",
            "stall_torque_Nm": 5.0,
            "inertia_kgm2": pytest.approx(2e-4, rel=1e-12),
            "weight_kg": 3.0,
        },
    ]
    assert (message, notes) == ([], [])


COLUMNS = """Motor;M0 [Nm];S1 0 rpm [Nm];S1 3000 rpm;S1 6000 rpm;peak 0 rpm [Nm];peak 3000 rpm;peak 6000 rpm
S60;2.8;2.8;2.4;1.5;7.2;7.2;3
S80;5;;;;;;
S90;5;4;;3;9;;8
"""


def test_columns_of_the_torques_at_one_speed_are_the_points_of_a_curve() -> None:
    result, message, notes = listed(COLUMNS)

    assert [(motor.designation, motor.stall_torque_Nm) for motor in result] == [("S60", 2.8), ("S80", 5), ("S90", 5)]
    assert [[point.model_dump() for point in motor.curve or ()] for motor in result] == [
        POINTS,
        [],
        [{"speed_rpm": 0, "continuous_Nm": 4, "peak_Nm": 9}, {"speed_rpm": 6000, "continuous_Nm": 3, "peak_Nm": 8}],
    ]
    assert (message, notes) == ([], [])


def test_points_of_one_name_beside_other_figures_are_not_one_motor() -> None:
    """Of two rows with another inertia each, none says the curve of the other: which one counts is asked."""
    rows = "Motor;J [kg·cm²];curve speed [rpm];M S1 [Nm];curve peak torque [Nm]\nS60;1;0;2.8;7.2\nS60;{};3000;2.4;7\n"
    one, other = (reading_of(rows.format(inertia), BOUNDS).table for inertia in (1, 2))
    assert one is not None and other is not None
    assert [len(motor.curve or ()) for motor in motors_in(one)[0]] == [2] and not one.questions
    assert not motors_in(other)[0] and len(other.questions) == 1


HEAD = "Motor;continuous {0} 0 rpm {1};peak {0} 0 rpm {1};continuous {0} 3000 rpm {1};peak {0} 3000 rpm {1}\n"


@pytest.mark.parametrize(
    "heads",
    [
        HEAD.format("", "[Ncm]"),
        HEAD.format("", "Ncm"),
        HEAD.format("torque [Ncm] at", ""),
        HEAD.format("torque in Ncm at", ""),
        HEAD.format("", "[N cm]"),
    ],
)
def test_torques_at_one_speed_are_in_the_unit_of_their_headings(heads: str) -> None:
    ((motor,), message, notes) = listed(heads + "S60;280;720;150;300\n")
    assert [[*point.model_dump().values()] for point in motor.curve or ()] == [
        pytest.approx([0, 2.8, 7.2], rel=1e-12),
        pytest.approx([3000, 1.5, 3], rel=1e-12),
    ]
    assert (message, notes) == ([], [])


@pytest.mark.parametrize(
    "text",
    [
        "Motor;S1 0 rpm [Nm];peak 0 rpm [Nm];S1 3000 rpm [Ncm];peak 3000 rpm [Nm]\nS60;2;6;150;5\n",
        HEAD.format("current", "") + "S60;2;6;1.5;5\n",
        HEAD.format("", "[A]") + "S60;2;6;1.5;5\n",
        HEAD.format("", "10^-2 [Nm]") + "S60;200;600;150;500\n",
        HEAD.format("", "x0.01 Nm") + "S60;200;600;150;500\n",
        HEAD.format("", "") + ";Ncm;Ncm;Ncm;Ncm\nS60;200;600;150;500\n",
        HEAD.format("", "[Nm]") + ";0.01;0.01;0.01;0.01\nS60;200;600;150;500\n",
    ],
)
def test_torques_at_one_speed_of_which_unit_or_factor_is_open_are_never_points(text: str) -> None:
    table = reading_of(text, BOUNDS).table
    assert table is not None
    assert not any(motor.curve for motor in motors_in(table)[0])
    assert table.questions or table.problem


def test_a_list_with_curves_is_edited_as_the_table_that_it_is_written_as() -> None:
    result, _, _ = listed(ROWS)

    assert listed(as_text(result)) == (result, [], [])


PARTS = ROWS + "S90\t5\t2\t3\t0\t4\t9\nS90\t\t\t\t3000\t4\t\nS95\t5\t2\t3\t9\t4\t9\n\t\t\t\t99\t4\t9\n"


def test_a_part_of_a_point_is_asked_about_at_its_row_and_column() -> None:
    table = reading_of(PARTS, BOUNDS).table
    assert table is not None and not table.motors
    assert [one.text for one in table.questions] == [
        "Incomplete points of a torque curve, first in row 7: “curve peak torque [Nm]” is missing. What counts?"
    ]
    result, message, notes = listed(PARTS, points="motors")
    assert [motor.designation for motor in result] == ["S60", "S80"]
    assert notes == ["Motors with a part of a point of a torque curve are left out (1): row 7."]
    assert len(message) == 1  # S95


@pytest.mark.parametrize(
    ("rows", "figures"),
    [
        ("S60;0;;\nS80;0;2;6\nS80;3000;1;5\n", ["S80"]),
        ("S80;0;2;6\nS80;3000;1;5\nS60;;2;\n", ["S80"]),
        ("S60;0;0;7\nS60;9;0;7\n", []),  # zeros that are not known
    ],
)
def test_a_motor_without_any_figure_is_left_out_with_a_note(rows: str, figures: list[str]) -> None:
    text = "Motor;curve speed [rpm];M S1 [Nm];curve peak torque [Nm]\n" + rows
    result, _, notes = listed(text, points="skip", zeros="unknown")
    assert [motor.designation for motor in result] == figures
    assert notes[-1].startswith("Motors without any figure are left out (1): row ")


def test_a_rated_power_without_its_speed_is_no_figure_of_a_motor() -> None:
    result, _, notes = listed("Motor;P_N [kW];n_N [rpm]\nA;1;3000\nB;2;\n", blanks="unknown")
    assert [motor.designation for motor in result] == ["A"]
    assert notes[-1] == "Motors without any figure are left out (1): row 3."


@pytest.mark.parametrize("cell", ["abc", "-1", "0"])
def test_a_point_that_can_not_be_read_leaves_its_whole_motor_out(cell: str) -> None:
    """A straight line past it could be above the curve that is meant."""
    text = "Motor;curve speed [rpm];M S1 [Nm];curve peak torque [Nm]\n"
    text += f"S60;0;2;6\nS60;3000;{cell};5\nS60;6000;1;5\nS80;0;1;2\nS80;500;1;2\n"
    result, _, notes = listed(text, zeros="skip")
    assert [motor.designation for motor in result] == ["S80"]
    assert [note.endswith("(1): row 3.") for note in notes] == [True]


def test_a_part_of_a_point_is_left_out_and_a_curve_that_can_not_be_leaves_its_motor_out() -> None:
    result, message, notes = listed(PARTS, points="skip")

    assert [motor.designation for motor in result] == ["S60", "S80"]
    assert next(note for note in notes if "part of a point" in note).endswith("(1): row 7.")
    assert message == [
        "Row 6, S90, is left out: curve must have at least 2 items, not 1.",
        "Row 8, S95, is left out: curve must be 0 in the first point.",
    ]


def test_a_kept_list_gives_its_curves_to_pairs(tmp_path: Path) -> None:
    with TestClient(create_app(Settings(database_url=f"sqlite:///{tmp_path}/s.sqlite3"))) as api:
        sent = {"name": "Ours", "motors": [{"designation": "S60", "inertia_kgm2": 1e-4, "curve": POINTS}]}
        response = api.post("/api/v1/motor-lists", json=sent)
        assert response.status_code == 201
        read = api.get(response.headers["Location"]).json()
        assert read["motors"][0]["curve"] == POINTS
        document = {"application": {"duty_cycle": {"motion": TURNING, "pause_s": 0.5}}, "top": 1}
        by_list = api.post("/api/v1/pairs", json=document | {"list": response.json()["id"]}).raise_for_status().json()
        assert (
            by_list == api.post("/api/v1/pairs", json=document | {"motors": sent["motors"]}).raise_for_status().json()
        )


# --- Fleets -----------------------------------------------------------------------------------------------------------


def test_the_curve_of_an_axis_of_a_fleet_is_json_in_its_cell(tmp_path: Path, catalogue: Catalogue) -> None:
    curve = json.dumps(POINTS)
    quoted = curve.replace('"', '""')
    head = "axis,torque_Nm,speed_rpm,duration_s,requirements.motor.curve,requirements.motor.name\n"
    rows = f'a,"[40]","[100]","[1]","{quoted}",S60\nb,"[40]","[100]","[1]",,\nc,"[40]","[100]","[1]","[1]",\n'
    (tmp_path / "axes.csv").write_text(head + rows)
    size_fleet(Order(tmp_path / "axes.csv", tmp_path / "answers.csv"), catalogue, here)
    with (tmp_path / "answers.csv").open() as file:
        answers = list(csv.DictReader(file))

    question = cycle(phase(40, 100, 1), requirements={"motor": {"curve": POINTS, "name": "S60"}})
    reply = select(Application.model_validate(question), catalogue)
    assert answers[0]["selected"] == reply.selected
    assert float(answers[0]["utilisation"]) == pytest.approx(reply.candidates[0].utilisation, rel=1e-12)
    assert answers[1]["error"] == ""
    assert "requirements.motor.curve" in answers[2]["error"]


# --- Pictures and words -----------------------------------------------------------------------------------------------


def plane_of(motor: Json, duty: Json, gear: str = "HPN-20A-10") -> Plane:
    application = Application.model_validate(duty | {"requirements": {"motor": motor}})
    return motor_plane(Subject(application, CATALOGUE.by_designation[gear], CATALOGUE), Reader("en"))


def test_the_plane_draws_peak_and_continuous_curve_and_the_limits_of_the_gear() -> None:
    duty = cycle(phase(40, 100, 0.3, peak_speed_rpm=450), phase(10, 300, 0.5), pause_s=1)
    plane = plane_of({"curve": POINTS}, duty)
    drawn = markup(plane.drawing)

    for name in ("M_p(n)", "M_c(n)"):
        assert name.partition("_")[0] in drawn
        assert any(name in demand.relation for demand in plane.demands)
    peak, rms = (next(one for one in plane.demands if sign in one.relation) for sign in ("M_p(n)", "M_c(n)"))
    assert peak.value == pytest.approx(4)
    assert peak.limit == pytest.approx(5.1)
    assert rms.limit == pytest.approx(2.8 - 0.4 / 3000 * 1000, rel=1e-12)  # the makers’ rule, the smaller of both
    assert "gear limit" in drawn
    assert "drive limit" in drawn
    without = plane_of({"peak_torque_Nm": 7.2, "rated_torque_Nm": 2.4, "maximum_speed_rpm": 6000.0}, duty)
    assert not any("M_p" in demand.relation for demand in without.demands)


def test_the_points_of_a_curve_stand_below_their_name_in_the_report() -> None:
    """As wide as its value wants to be, the column of values left the names one letter a line."""
    api = TestClient(create_app(Settings()))
    curve = "&".join(f"mcv={p['speed_rpm']:g}:{p['continuous_Nm']:g}:{p['peak_Nm']:g}" for p in POINTS)
    report = api.get(f"/report.pdf?T=12&n=100&t=1&T=-8&n=50&t=2&tp=1&{curve}&mnm=S60").content
    lines = [" ".join(line.split()) for line in page_texts(report, 1)[0].splitlines()]

    place = next(k for k, line in enumerate(lines) if line.startswith("Motor torque over speed"))
    assert lines[place + 1].startswith("0 rpm: 2.8 Nm, peak 7.2 Nm; 3 000 rpm:")
    assert any(line.startswith("Maximum utilisation") for line in lines)


def test_both_rules_and_what_is_assumed_are_said_on_the_page() -> None:
    api = TestClient(create_app(Settings()))
    curve = "&".join(f"mcv={p['speed_rpm']:g}:{p['continuous_Nm']:g}:{p['peak_Nm']:g}" for p in POINTS)
    link = "/?T=40&n=100&t=0.3&T=10&n=300&t=0.5&tp=1&i=10&size=20A&mnm=S60"
    page = api.get(f"{link}&{curve}").text
    assert "by the balance of its losses along the curve" in page
    assert "by the makers’ rule" in page
    assert "taken as a straight line" in page
    assert "0 : 2.8 : 7.2\n3000 : 2.4 : 7.2\n6000 : 1.5 : 3</textarea>" in page
    assert "S60" in page
    rated = api.get(f"{link}&Tmn=2.4&Tm=7&nm=6000&nmr=3000").text
    assert "Of the motor one rated point is known" in rated
    assert "balance of its losses along" not in rated


def test_the_calculation_compares_with_the_curve_and_says_both_rules(catalogue: Catalogue) -> None:
    duty = with_curve(cycle(phase(40, 100, 0.3, peak_speed_rpm=450), phase(10, 300, 0.5), pause_s=1))
    steps = steps_of(duty, "HPN-20A-10", catalogue)

    [peak] = steps["motor_peak_torque"].comparisons
    assert peak.value == pytest.approx(4)
    assert peak.limit == pytest.approx(5.1)
    assert any("balance" in note.template for note in steps["motor_rated_torque"].notes)


# --- A machine --------------------------------------------------------------------------------------------------------


def test_the_gear_list_of_a_machine_names_the_motors_of_its_axes(tmp_path: Path) -> None:
    with TestClient(create_app(Settings(database_url=f"sqlite:///{tmp_path}/s.sqlite3"))) as api:
        axes = [
            {"name": name, "application": cycle(phase(5, 50, 1), requirements=requirements)}
            for name, requirements in (
                ("X", {"motor": {"curve": POINTS, "name": "S60"}}),
                ("Y", {"motor": {"curve": POINTS, "name": "S60"}}),
                ("Z", {"motor": {"peak_torque_Nm": 60.0, "name": "S80"}}),
                ("A", {}),
            )
        ]
        response = api.post("/api/v1/machines", json={"title": "Line", "axes": axes})
        assert response.status_code == 201, response.text
        gears = api.get(f"/api/v1/machines/{response.json()['id']}/gears").json()["gears"]
        assert sorted(name for gear in gears for name in gear["motors"]) == ["S60", "S80"]
        page = api.get(response.json()["url"]).text
        assert "S60" in page
        book = load_workbook(BytesIO(api.get(f"/api/v1/machines/{response.json()['id']}/gears.xlsx").content))
        assert {row[7] for row in book.worksheets[0].iter_rows(values_only=True) if len(row) > 7} >= {"S60", "S80"}
        report = api.get(f"/api/v1/machines/{response.json()['id']}/report.pdf").content
        assert "S60" in page_texts(report, 1)[0] and "S80" in page_texts(report, 1)[0]


@pytest.mark.parametrize("own", [b"{}", b'{"requirements": "x"}', b'{"requirements": {"motor": {"name": 3}}}', b"["])
def test_an_axis_without_a_motors_name_has_none_whatever_was_sent(own: bytes) -> None:
    assert motor_of(own) is None

"""The user's own motors: motors.csv of a supplement, its route, and an application that names one of them."""

from pathlib import Path
from typing import Any

import pytest
from starlette.testclient import TestClient

from hpn.application import Application, InputError
from hpn.catalogue import Catalogue, CatalogueError
from hpn.catalogue.copy import copy_of, read_copy
from hpn.web.app import create_app
from hpn.web.settings import Settings
from tests.build import Json, answer, cycle, phase, worked_example
from tests.conftest import Supplement
from tests.unit.test_application import refused
from tests.wire import select_fleet

HEADER = "designation,maximum_speed_rpm,rated_speed_rpm,rated_torque_Nm,peak_torque_Nm,inertia_kgm2,source\n"
MOTORS = HEADER + "M 40,6000,3000,2.4,7.2,0.00015,data sheet\nM 60,4500,,4,12,,\n"
FIGURES = {
    "maximum_speed_rpm": 6000,
    "rated_speed_rpm": 3000,
    "rated_torque_Nm": 2.4,
    "peak_torque_Nm": 7.2,
    "inertia_kgm2": 0.00015,
}


def asking(motor: Json, **more: Any) -> Json:
    return cycle(phase(20, 100), phase(5, 0, 2), requirements={"motor": motor, **more})


def test_a_motor_of_the_list_stands_for_its_figures(supplemented: Supplement) -> None:
    catalogue = supplemented(motors=MOTORS)
    ratio = {"inertia_ratio": 5}
    named = answer(asking({"designation": "M 40"} | ratio, load_inertia_kgm2=0.01), catalogue)
    typed = answer(asking(FIGURES | ratio, load_inertia_kgm2=0.01), catalogue)

    assert named == typed
    codes = [check["code"] for check in named["candidates"][0]["checks"]]
    assert codes[-5:] == [
        *("motor_speed", "motor_peak_torque", "motor_rated_torque", "motor_rated_speed", "inertia_ratio"),
    ]


def test_a_figure_that_is_blank_in_the_list_is_not_checked(supplemented: Supplement) -> None:
    reply = answer(asking({"designation": "M 60"}), supplemented(motors=MOTORS))

    codes = [check["code"] for check in reply["candidates"][0]["checks"]]
    assert codes[-3:] == ["motor_speed", "motor_peak_torque", "motor_rated_torque"]


def test_a_motor_that_is_not_listed_is_refused_by_name_with_those_there_are(
    supplemented: Supplement, catalogue: Catalogue
) -> None:
    for book, message in ((supplemented(motors=MOTORS), "M 40, M 60"), (catalogue, r"motors\.csv")):
        with pytest.raises(InputError, match=message) as refusal:
            answer(asking({"designation": "M 41"}), book)
        assert [place for place, _ in refusal.value.problems] == [("requirements", "motor", "designation")]


@pytest.mark.parametrize(("count", "last"), [(20, "M 18, M 19)"), (21, "M 18, M 19, …)")])
def test_of_the_motors_there_are_twenty_are_named(supplemented: Supplement, count: int, last: str) -> None:
    book = supplemented(motors=HEADER + "".join(f"M {k},6000,,,,,\n" for k in range(count)))
    with pytest.raises(InputError) as refusal:
        answer(asking({"designation": "M 41"}), book)
    ((_, message),) = refusal.value.problems
    assert str(message).endswith(f", {last}")


def test_a_motor_without_inertia_has_no_inertia_ratio(supplemented: Supplement) -> None:
    motor = {"designation": "M 60", "inertia_ratio": 5}
    with pytest.raises(InputError, match="inertia_ratio needs") as refusal:
        answer(asking(motor, load_inertia_kgm2=1), supplemented(motors=MOTORS))
    assert [place for place, _ in refusal.value.problems] == [("requirements", "motor", "designation")]


def test_in_a_batch_an_unlisted_motor_fails_alone(supplemented: Supplement) -> None:
    motors = ("M 40", "M 41", "M 60")
    applications = [Application.model_validate(asking({"designation": name})) for name in motors]
    failed = [isinstance(one, InputError) for one in select_fleet(applications, supplemented(motors=MOTORS))]

    assert failed == [False, True, False]


@pytest.mark.parametrize(("name", "value"), FIGURES.items())
def test_a_name_beside_figures_is_refused(name: str, value: float) -> None:
    errors = refused(asking({"designation": "M 40", name: value}))
    assert list(errors) == [("requirements", "motor", "designation")]
    assert "either the motor or its figures" in errors["requirements", "motor", "designation"]


@pytest.mark.parametrize(
    ("motor", "more", "place", "message"),
    [
        ({"inertia_ratio": 5}, {"load_inertia_kgm2": 1}, ("motor", "inertia_ratio"), "inertia_kgm2"),
        ({"inertia_ratio": 5, "inertia_kgm2": 1e-4}, {}, ("motor", "inertia_ratio"), "load_inertia_kgm2"),
        ({"inertia_ratio": 0, "inertia_kgm2": 1e-4}, {}, ("motor", "inertia_ratio"), "greater than 0"),
        ({}, {"load_inertia_kgm2": 0}, ("load_inertia_kgm2",), "greater than 0"),
    ],
)
def test_an_inertia_ratio_needs_both_inertias(motor: Json, more: Json, place: tuple[str, ...], message: str) -> None:
    errors = refused(asking(motor, **more))
    assert list(errors) == [("requirements", *place)]
    assert message in errors["requirements", *place]


def test_a_motion_has_its_own_inertia_of_the_load() -> None:
    moves = [{"profile": "triangular", "angle_deg": 90, "time_s": 1}]
    motion = {"mechanism": {"type": "rotary", "inertia_kgm2": 1}, "moves": moves}
    errors = refused({"duty_cycle": {"motion": motion}, "requirements": {"load_inertia_kgm2": 1}})
    assert list(errors) == [("requirements", "load_inertia_kgm2")]


# --- The list ---------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("rows", "message"),
    [
        ("M 40,6000,6001,2.4,7.2,0.1,\n", "rated_speed_rpm"),
        ("M 40,6000,3000,7.3,7.2,0.1,\n", "rated_torque_Nm"),
        ("M 40,6000,3000,2.4,7.2,-1,\n", "inertia_kgm2"),
        (",6000,3000,2.4,7.2,1,\n", "designation"),
        ("M 40,1,1,1,1,1,\nM 40,2,2,2,2,2,\n", "line 3"),
    ],
)
def test_a_wrong_list_of_motors_is_refused_by_its_cell(supplemented: Supplement, rows: str, message: str) -> None:
    with pytest.raises(CatalogueError, match=f"motors.csv.*{message}"):
        supplemented(motors=HEADER + rows)


def test_motors_change_the_version_and_outlast_their_file(supplemented: Supplement, catalogue: Catalogue) -> None:
    listed = supplemented(motors=MOTORS)
    assert listed.version != catalogue.version
    assert read_copy(copy_of(listed)).motors == listed.motors


def test_the_motors_are_told_with_their_source(tmp_path: Path) -> None:
    (tmp_path / "motors.csv").write_text(MOTORS)
    for settings, count in ((Settings(catalogue_supplement=tmp_path), 2), (Settings(), 0)):
        with TestClient(create_app(settings)) as client:
            reply = client.get("/api/v1/motors")
            assert reply.status_code == 200
            assert len(reply.json()["motors"]) == count
            again = client.get("/api/v1/motors", headers={"If-None-Match": reply.headers["ETag"]})
            assert again.status_code == 304
            if count:
                first, second = reply.json()["motors"]
                assert first == FIGURES | {"designation": "M 40", "source": "supplied by the user: data sheet"}
                assert second["inertia_kgm2"] is None


def test_the_use_of_each_motor_on_a_gear_is_that_of_a_selection_with_it(tmp_path: Path) -> None:
    (tmp_path / "motors.csv").write_text(MOTORS)
    application = worked_example(requirements={"sizes": ["20A"], "ratios": [5]})
    with TestClient(create_app(Settings(catalogue_supplement=tmp_path))) as client:
        reply = client.post("/api/v1/motors/hpn-20a-05", json=application).json()
        assert reply["designation"] == "HPN-20A-5"
        assert [use["motor"]["designation"] for use in reply["motors"]]
        for use in reply["motors"]:
            application["requirements"]["motor"] = {"designation": use["motor"]["designation"]}
            [gear] = client.post("/api/v1/select", json=application).json()["candidates"]
            checks = {check["code"]: check for check in gear["checks"] if check["code"] in use["utilisations"]}
            assert {code: check["utilisation"] for code, check in checks.items()} == use["utilisations"]
            assert use["fits"] == all(check["status"] == "pass" for check in checks.values())
            assert use["utilisations"][use["governing_check"]] == max(use["utilisations"].values())


@pytest.mark.parametrize(
    ("path", "body", "status", "message"),
    [
        ("HPN-99A-5", "{}", 404, "no gear 'HPN-99A-5'"),
        ("HPN-20A-5", "{", 400, "JSON"),
        ("HPN-20A-5", "{}", 422, "duty_cycle"),
    ],
)
def test_a_question_that_cannot_be_answered_says_why(path: str, body: str, status: int, message: str) -> None:
    with TestClient(create_app(Settings())) as client:
        kind = {"Content-Type": "application/json"}
        reply = client.post(f"/api/v1/motors/{path}", content=body, headers=kind)
        assert (reply.status_code, reply.headers["Content-Type"]) == (status, "application/problem+json")
        assert message in reply.text
        fine = client.post("/api/v1/motors/HPN-20A-5", json=worked_example())
        assert (fine.status_code, fine.json()["motors"]) == (200, [])


@pytest.mark.parametrize(
    ("header", "cell"),
    [
        ("inertia_kgm2", "1.5 kg·cm²"),
        ("inertia_kgm2", "0.00015 kgm2"),
        ("inertia_kgcm2", "1.5"),
        ("inertia_kg_cm2", "1.5"),
        ("inertia [kg·cm²]", "1.5"),
        ("inertia_gcm2", "1500"),
        ("inertia_gcm2", "1.5 kgcm2"),
    ],
)
def test_inertia_of_a_motor_is_read_in_the_unit_that_it_is_written_in(
    supplemented: Supplement, header: str, cell: str
) -> None:
    book = supplemented(motors=f"{HEADER.replace('inertia_kgm2', header)}M 40,6000,3000,2.4,7.2,{cell},data sheet\n")

    assert book.motors[0].inertia_kgm2 == 0.00015


@pytest.mark.parametrize(
    ("cell", "inertia_kgm2"),
    [("1 lb·in²", 0.0002926396534292), ("1 oz·in·s²", 0.0070615518142260435), ("1 oz-in²", 1.8289978339325e-05)],
)
def test_inertia_of_a_motor_in_inches_is_exact(supplemented: Supplement, cell: str, inertia_kgm2: float) -> None:
    book = supplemented(motors=f"{HEADER}M 40,6000,3000,2.4,7.2,{cell},data sheet\n")

    assert book.motors[0].inertia_kgm2 == pytest.approx(inertia_kgm2, rel=1e-11)  # twelve digits are kept


def test_other_figures_of_a_motor_have_their_units_as_well(supplemented: Supplement) -> None:
    book = supplemented(motors=HEADER.replace("peak_torque_Nm", "peak_torque_Ncm") + "M 40,6 krpm,3000,2.4,720,,\n")

    assert (book.motors[0].maximum_speed_rpm, book.motors[0].peak_torque_Nm) == (6000, 7.2)


@pytest.mark.parametrize(
    ("header", "cell", "column"), [("inertia_kgm2", "1.5 kgm", "inertia_kgm2"), ("inertia_kgm", "1.5", "inertia_kgm")]
)
def test_unknown_unit_of_a_motor_names_those_that_are_known(
    supplemented: Supplement, header: str, cell: str, column: str
) -> None:
    with pytest.raises(CatalogueError, match=r"kgm is not a unit of this quantity; possible: kg·m², kg·cm²") as refusal:
        supplemented(motors=f"{HEADER.replace('inertia_kgm2', header)}M 40,6000,3000,2.4,7.2,{cell},data sheet\n")
    assert column in str(refusal.value)

"""Catalogue, envelopes and health over HTTP."""

from typing import Any

import pytest
from starlette.testclient import TestClient

from hpn import ENGINE_VERSION
from hpn.catalogue import Catalogue
from tests.reference import handbook

FIELDS = {
    *("designation", "size", "ratio", "stages"),
    *("repeated_peak_torque_Nm", "rated_torque_Nm", "momentary_peak_torque_Nm"),
    *("maximum_input_speed_rpm", "average_input_speed_rpm", "weight_kg", "backlash_arcmin"),
    *("transmission_accuracy_arcmin", "torsional_stiffness_Nm_per_rad", "length_min_mm", "length_max_mm"),
    *("dynamic_radial_load_N", "dynamic_axial_load_N", "sources"),
}


def test_the_catalogue_lists_every_gear_with_every_field_of_the_contract(api: TestClient, catalogue: Catalogue) -> None:
    body = api.get("/api/v1/catalogue").json()

    assert body["catalogue_version"] == catalogue.version
    assert [gear["designation"] for gear in body["gears"]] == [gear.designation for gear in catalogue.gears]
    for gear in body["gears"]:
        assert set(gear) >= FIELDS
        for name in FIELDS - {"designation", "size", "sources"}:
            assert (gear[name] is None) == (name not in gear["sources"]), (gear["designation"], name)


def test_figures_on_the_wire_are_the_printed_ones(api: TestClient) -> None:
    gears = {gear["designation"]: gear for gear in api.get("/api/v1/catalogue").json()["gears"]}

    for size, torques in handbook.RATED_TORQUE_NM.items():
        for ratio, torque in zip(handbook.RATIOS[size], torques, strict=True):
            assert gears[f"HPN-{size}-{ratio}"]["rated_torque_Nm"] == torque
    assert gears["HPN-40A-5"]["rated_torque_Nm"] is None
    assert gears["HPN-40A-5"]["torsional_stiffness_Nm_per_rad"] == 143000


@pytest.mark.parametrize("spelling", ["HPN-20A-5", "HPN-20-5", "hpn-20a-05", "HPN-20A-5-J6-BH-AF1"])
def test_one_gear_is_found_by_any_printed_spelling(api: TestClient, spelling: str) -> None:
    reply = api.get(f"/api/v1/catalogue/{spelling}")

    assert reply.status_code == 200
    assert reply.json()["designation"] == "HPN-20A-5"
    assert reply.json()["sources"]["rated_torque_Nm"].startswith("table 12.1")


@pytest.mark.parametrize("name", ["HPN-20A-6", "HPN", "%00", "a" * 3000, "%F0%9F%98%80", "%FF"])
def test_a_gear_that_is_not_there_is_a_404_problem(api: TestClient, name: str) -> None:
    reply = api.get(f"/api/v1/catalogue/{name}")

    assert reply.status_code == 404
    assert reply.headers["content-type"] == "application/problem+json"
    assert "HPN-20A-5" in reply.json()["detail"]


def envelopes(api: TestClient, size: str, **query: Any) -> dict[str, Any]:
    reply = api.get(f"/api/v1/bearing-envelopes/{size}", params=query)
    assert reply.status_code == 200, reply.text
    body: dict[str, Any] = reply.json()
    return body


@pytest.mark.parametrize("size", handbook.DYNAMIC_RADIAL_LOAD_N)
def test_envelopes_at_the_published_condition_end_at_the_published_limits(api: TestClient, size: str) -> None:
    body = envelopes(api, size, speed_rpm=100, life_h=20000, load_coefficient=1)

    assert (body["size"], body["model"]) == (size, "linear")
    assert [curve["load_coefficient"] for curve in body["curves"]] == [1, 1.2, 1.5]
    first = body["curves"][0]
    assert (max(first["radial_N"]), max(first["axial_N"])) == (
        handbook.DYNAMIC_RADIAL_LOAD_N[size],
        handbook.DYNAMIC_AXIAL_LOAD_N[size],
    )


def test_the_coefficient_asked_for_is_drawn_beside_the_printed_ones_and_once(api: TestClient) -> None:
    drawn = [curve["load_coefficient"] for curve in envelopes(api, "20A", load_coefficient=2)["curves"]]
    assert drawn == [1, 1.2, 1.5, 2]
    assert len(envelopes(api, "20A", load_coefficient=1.2)["curves"]) == 3


def test_eight_times_the_speed_halves_the_envelope_and_slower_running_leaves_it(api: TestClient) -> None:
    """Exponent 3: 800 rpm instead of 100 rpm allows half the load."""
    fast = envelopes(api, "20A", speed_rpm=800)["curves"][0]
    long = envelopes(api, "20A", life_h=160000)["curves"][0]
    slow = envelopes(api, "20A", speed_rpm=1)["curves"][0]

    assert max(fast["radial_N"]) == pytest.approx(900, rel=1e-15)  # a cube root and its rounding
    assert max(long["radial_N"]) == pytest.approx(900, rel=1e-15)
    assert max(slow["radial_N"]) == 1800


def test_the_iso_model_has_its_knee(api: TestClient) -> None:
    curve = envelopes(api, "HPN-20", model="iso281")["curves"][0]

    assert curve["radial_N"] == [0, 1800, 1800]
    assert curve["axial_N"] == pytest.approx([2200, 968, 0], rel=1e-15)


@pytest.mark.parametrize(
    ("path", "status", "words"),
    [
        ("40A", 422, "HPN-40A"),
        ("15A", 404, "11A, 14A, 20A, 32A, 40A"),
        ("x" * 3000, 404, "there are"),
        ("20A?speed_rpm=0", 422, "speed_rpm"),
        ("20A?speed_rpm=-5", 422, "speed_rpm"),
        ("20A?speed_rpm=1,5", 422, "speed_rpm"),
        ("20A?speed_rpm=nan", 422, "speed_rpm"),
        ("20A?speed_rpm=inf", 422, "speed_rpm"),
        ("20A?life_h=0", 422, "life_h"),
        ("20A?load_coefficient=0.9", 422, "load_coefficient"),
        ("20A?load_coefficient=3.1", 422, "load_coefficient"),
        ("20A?model=curved", 422, "model"),
        ("20A?model=digitised", 422, "bearing_envelopes.csv"),
        ("20A?colour=red", 422, "colour"),
    ],
)
def test_an_envelope_that_cannot_be_drawn_is_a_problem_that_says_why(
    api: TestClient, path: str, status: int, words: str
) -> None:
    reply = api.get(f"/api/v1/bearing-envelopes/{path}")

    assert reply.status_code == status
    assert reply.headers["content-type"] == "application/problem+json"
    assert words in reply.text
    if status == 422 and "digitised" not in path and path != "40A":
        assert [error["pointer"] for error in reply.json()["errors"]] == ["/" + words]


def test_a_constant_load_read_off_the_curves_of_the_api_is_full_by_the_api(api: TestClient) -> None:
    """The same question over both endpoints: a point half way along the drawn life envelope has utilisation 1."""
    curve = envelopes(api, "32A", speed_rpm=300, life_h=30000, load_coefficient=1.7)["curves"][-1]
    load = {
        "radial_N": sum(curve["radial_N"]) / 2,
        "axial_N": sum(curve["axial_N"]) / 2,
        "load_coefficient": 1.7,
        "life_h": 30000,
    }
    application = {
        "duty_cycle": {"phases": [{"torque_Nm": 1, "speed_rpm": 300, "duration_s": 1}]},
        "output_load": load,
        "requirements": {"sizes": ["32A"], "ratios": [5]},
    }
    [gear] = api.post("/api/v1/select", json=application).json()["candidates"]
    used = {check["code"]: check["utilisation"] for check in gear["checks"]}

    assert used["output_bearing_life"] == pytest.approx(1, rel=1e-14)


def test_health_says_that_it_lives_and_is_ready(api: TestClient, catalogue: Catalogue) -> None:
    assert api.get("/healthz").json() == {"status": "ok"}
    ready = api.get("/readyz")
    assert ready.status_code == 200
    assert (ready.json()["status"], ready.json()["gears"]) == ("ok", len(catalogue.gears))
    assert (ready.json()["engine_version"], ready.json()["catalogue_version"]) == (ENGINE_VERSION, catalogue.version)


def test_reading_endpoints_refuse_other_methods(api: TestClient) -> None:
    for path in ("/api/v1/catalogue", "/api/v1/catalogue/HPN-20A-5", "/api/v1/bearing-envelopes/20A", "/healthz"):
        reply = api.post(path)
        assert reply.status_code == 405
        assert reply.headers["content-type"] == "application/problem+json"

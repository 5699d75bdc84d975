"""Bounds in the OpenAPI document equal the applied ones: of bodies, motions, queries and lists."""

import math
import re
from collections.abc import Iterator
from typing import Any

import pytest
from starlette.testclient import TestClient

from tests.build import LIFTING, TURNING, worked_example
from tests.web.test_openapi import FULL
from tests.web.test_openapi_truth import Json, Path, operations, with_value


def resolved(document: Json, schema: Json) -> Json:
    """Schema with its reference resolved, and without the option null."""
    union = (*schema.get("anyOf", ()), *schema.get("oneOf", ()))
    options = [option for option in union if option.get("type") != "null"]
    schema = options[0] if options else schema
    return document["components"]["schemas"][schema["$ref"].rpartition("/")[2]] if "$ref" in schema else schema


def leaves(document: Json, schema: Json, path: Path = ()) -> Iterator[tuple[Path, Json]]:
    """Yield path and schema of every part of a schema; a list is represented by its first item."""
    schema = resolved(document, schema)
    yield path, schema
    for name, entry in schema.get("properties", {}).items():
        yield from leaves(document, entry, (*path, name))
    if "items" in schema:
        yield from leaves(document, schema["items"], (*path, 0))


def tries(schema: Json, there: Any = None) -> Iterator[tuple[Any, bool]]:
    """Yield values at every bound of a schema with True, and values just beyond with False."""
    whole = schema.get("type") == "integer"
    for name, beyond in (("minimum", -math.inf), ("maximum", math.inf)):
        if name in schema:
            bound = schema[name]
            yield bound, True
            yield bound + int(math.copysign(1, beyond)) if whole else math.nextafter(bound, beyond), False
    if "exclusiveMinimum" in schema:
        yield math.nextafter(schema["exclusiveMinimum"], math.inf), True
        yield schema["exclusiveMinimum"], False
    if "maxLength" in schema:
        yield "a" * schema["maxLength"], True
        yield "a" * (schema["maxLength"] + 1), False
    for name, step in (("minItems", -1), ("maxItems", 1)):
        if name in schema:
            yield there[:1] * schema[name], True
            yield there[:1] * (schema[name] + step), False
    if schema.get("type") == "array" and "minItems" not in schema:
        yield [], True


def at(body: Json, path: Path) -> Any:
    """Value at a path, or None."""
    value: Any = body
    for step in path:
        value = value.get(step) if isinstance(value, dict) else value[step]
    return value


def refusals(response: Any, pointer: str) -> list[str]:
    """Errors of the models at a pointer, without those for unknown entries of a catalogue, list or table."""
    assert response.status_code in (200, 201, 404, 413, 422), response.text
    errors = response.json().get("errors", []) if response.status_code in (413, 422) else []
    values = [error["detail"] for error in errors if error["pointer"] == pointer]
    return [
        text
        for text in values
        if not re.match("the catalogue has no|is not a cursor|a+: must be a column and what it is", text)
    ]


INERTIAS = {"inertia_kgm2": 0.001, "inertia_ratio": 5}
POINTS = [{"speed_rpm": n, "continuous_Nm": 1, "peak_Nm": 3} for n in (0, 6000)]
WHOLE: Json = FULL | {
    "requirements": FULL["requirements"]
    | {
        "ratios": [5],
        "sizes": ["20A"],
        "load_inertia_kgm2": 1,
        "position_radius_mm": 9,
        "motor": FULL["requirements"]["motor"] | INERTIAS | {"curve": POINTS},
    },
    "duty_cycle": FULL["duty_cycle"]
    | {"phases": [phase | {"radial_N": 1, "axial_N": 1} for phase in FULL["duty_cycle"]["phases"]]},
}
BODIES: dict[str, tuple[str, Json]] = {
    "Application": ("/api/v1/select", WHOLE),
    "SaveRequest": ("/api/v1/selections", {"application": worked_example(), "title": "t", "reference": "r"}),
    "Batch": ("/api/v1/select/batch", {"applications": [{}]}),
}


RACK: Json = LIFTING | {
    "mechanism": {"type": "rack_and_pinion", "mass_kg": 80.0, "diameter_mm": 60.0, "incline_deg": 30.0}
}
GRAVITY = ("gravity_mass_kg", "gravity_radius_mm")
WEIGHTLESS: Json = TURNING | {
    "mechanism": {name: value for name, value in TURNING["mechanism"].items() if name not in GRAVITY}
}
TRIED_BY_THEMSELVES: tuple[Path, ...] = (
    ("applications", 0),
    ("duty_cycle", "motion"),
    ("emergency_stop", "brake"),
    ("output_load", "drive"),
)


@pytest.mark.parametrize("name", BODIES)
def test_each_bound_of_a_body_is_the_one_that_is_applied(api: TestClient, document: Json, name: str) -> None:
    address, body = BODIES[name]
    tried = 0
    for path, schema in leaves(document, document["components"]["schemas"][name]):
        # Tried elsewhere: applications, and a code, which must be valid besides its maximum length.
        if (
            path[:1] in (("application",), ("ordering_code",))
            or path[:2] in TRIED_BY_THEMSELVES
            or path[-1:] == ("designation",)
        ):
            continue
        # Also bounded by the other figures of their curve.
        if "curve" in path and path[-1] in ("speed_rpm", "continuous_Nm"):
            continue
        # Also bounded by their phase.
        if {"peak_torque_Nm", "peak_speed_rpm", "rms_torque_Nm", "least_torque_Nm"} & {*path} and "phases" in path:
            continue
        for value, allowed in tries(schema, at(body, path)):
            response = api.post(address, json=with_value(body, path, value))
            pointer = "".join(f"/{step}" for step in path)
            assert (refusals(response, pointer) == []) is allowed, (pointer, str(value)[:60], response.text[:300])
            tried += 1
    assert tried >= (2 if name == "Batch" else 4)


@pytest.mark.parametrize(("name", "motion"), [("RotaryMotion", TURNING), ("LinearMotion", RACK)])
def test_each_bound_of_a_motion_is_the_one_that_is_applied(
    api: TestClient, document: Json, name: str, motion: Json
) -> None:
    tried = 0
    for path, schema in leaves(document, document["components"]["schemas"][name]):
        if path[:2] == ("moves", 0):  # the figures of a move bound one another
            continue
        # An inertia is also bounded by the gravity mass, so it is tried without one.
        inputs = WEIGHTLESS if name == "RotaryMotion" and path[-1:] == ("inertia_kgm2",) else motion
        for value, allowed in tries(schema, at(inputs, path)):
            response = api.post("/api/v1/select", json={"duty_cycle": {"motion": with_value(inputs, path, value)}})
            pointer = "".join(f"/{step}" for step in ("duty_cycle", "motion", *path))
            assert (refusals(response, pointer) == []) is allowed, (pointer, str(value)[:60], response.text[:300])
            tried += 1
    assert tried >= 12


def test_each_bound_of_a_brake_is_the_one_that_is_applied(api: TestClient, document: Json) -> None:
    tried, brake = (
        0,
        {"torque_Nm": 8.0, "rise_time_s": 0.01, "reaction_time_s": 0.02, "speed_rpm": 9.0, "dynamic_factor": 2.0}
        | {"load_torque_Nm": 0.0, "opposing_torque_Nm": 1e6},
    )
    for path, schema in leaves(document, document["components"]["schemas"]["Brake"]):
        for value, allowed in tries(schema, at(brake, path)):
            body = worked_example() | {"emergency_stop": {"brake": with_value(brake, path, value)}}
            response = api.post("/api/v1/select", json=body)
            pointer = "".join(f"/{step}" for step in ("emergency_stop", "brake", *path))
            assert (refusals(response, pointer) == []) is allowed, (pointer, str(value)[:60], response.text[:300])
            tried += 1
    assert tried >= 8


def test_each_bound_of_a_drive_is_the_one_that_is_applied(api: TestClient, document: Json) -> None:
    tried, drive = 0, {"type": "belt", "diameter_mm": 80.0}
    for path, schema in leaves(document, document["components"]["schemas"]["Drive"]):
        for value, allowed in tries(schema, at(drive, path)):
            body = worked_example() | {"output_load": {"drive": with_value(drive, path, value)}}
            pointer = "".join(f"/{step}" for step in ("output_load", "drive", *path))
            assert (refusals(api.post("/api/v1/select", json=body), pointer) == []) is allowed, (pointer, value)
            tried += 1
    assert tried >= 4


CSV: Json = {"content": b"axis", "headers": {"Content-Type": "text/csv"}}


def test_each_bound_of_a_query_is_the_one_that_is_applied(api: TestClient, document: Json) -> None:
    tried = 0
    for method, path, operation in operations(document):
        for parameter in operation.get("parameters", ()):
            for value, allowed in tries(parameter["schema"], ["a"]) if parameter["in"] == "query" else ():
                address = path.format(size="20A", designation="HPN-20A-5", id="A" * 22, number=1)
                inputs = {parameter["name"]: value}
                body: Json = {"json": worked_example()} if path.endswith("/select") else CSV if method == "POST" else {}
                response = api.request(method, address, params=inputs, **body)
                result = refusals(response, f"/{parameter['name']}")
                assert (result == []) is allowed, (path, parameter["name"], value, result)
                tried += 1
    assert tried >= 16


MAY_BE_EMPTY = {("Batch", ("applications",))}


def test_an_operation_of_the_api_takes_the_parameters_that_it_declares_and_each_once(
    api: TestClient, document: Json
) -> None:
    for method, path, entry in operations(document):
        if not path.startswith("/api/"):
            continue
        query = [parameter for parameter in entry.get("parameters", ()) if parameter["in"] == "query"]
        known = [parameter["name"] for parameter in query]
        once = [parameter["name"] for parameter in query if parameter["schema"].get("type") != "array"]
        address = path.replace("{size}", "20A").replace("{designation}", "HPN-20A-5").replace("{id}", "a" * 22)

        reply = api.request(method, f"{address}?refrence=1" + "".join(f"&{name}=1&{name}=" for name in known))

        assert reply.status_code == 422, path
        assert [problem["pointer"] for problem in reply.json()["errors"]] == ["/refrence", *(f"/{n}" for n in once)]
        assert (", ".join(known) or "it takes none") in reply.json()["errors"][0]["detail"]
        assert "422" in entry["responses"], path


def test_no_list_of_a_request_is_empty_but_a_batch(document: Json) -> None:
    lists = {
        (name, path): part
        for name in (*BODIES, "RotaryMotion", "LinearMotion")
        for path, part in leaves(document, document["components"]["schemas"][name])
        if part.get("type") == "array"
    }

    assert {place for place, part in lists.items() if not part.get("minItems")} == MAY_BE_EMPTY
    assert len(lists) >= 7


def test_no_list_is_bounded_as_a_text(document: Json) -> None:
    for name, schema in document["components"]["schemas"].items():
        for path, part in leaves(document, schema) if name in BODIES else ():
            assert part.get("type") != "array" or not {"minLength", "maxLength"} & set(part), (name, path)

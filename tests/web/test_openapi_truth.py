"""Agreement of the service with its OpenAPI document: names, bounds, examples, headers, links."""

import copy
import math
import re
from collections.abc import Iterator
from typing import Any

import pytest
from fastapi import FastAPI
from starlette.testclient import TestClient

from hpn.web.api.samples import LIFTING, TURNING
from hpn.web.api.schemas import HEADERS
from hpn.web.app import create_app
from hpn.web.door.access import MAXIMUM_QUERY_BYTES
from hpn.web.door.keys import new_key
from hpn.web.door.observation import SECURITY_HEADERS
from hpn.web.settings import Settings
from tests.build import worked_example
from tests.web.test_openapi import FULL

Json = dict[str, Any]
Path = tuple[str | int, ...]

OPERATIONS = {
    "deleteSelection": "DELETE /api/v1/selections/{id}",
    "fitMotors": "POST /api/v1/motors/{designation}",
    "getApplicationSchema": "GET /api/v1/application.schema.json",
    "getBearingEnvelopes": "GET /api/v1/bearing-envelopes/{size}",
    "getCatalogue": "GET /api/v1/catalogue",
    "getGear": "GET /api/v1/catalogue/{designation}",
    "getHealth": "GET /healthz",
    "getMetrics": "GET /metrics",
    "getMotors": "GET /api/v1/motors",
    "getReadiness": "GET /readyz",
    "getSelection": "GET /api/v1/selections/{id}",
    "getSelectionReport": "GET /api/v1/selections/{id}/report.pdf",
    "getSelectionSubmodel": "GET /api/v1/selections/{id}/submodel.aasx",
    "getSelectionWorkbook": "GET /api/v1/selections/{id}/report.xlsx",
    "listSelections": "GET /api/v1/selections",
    "makeReport": "POST /api/v1/report.pdf",
    "makeSubmodel": "POST /api/v1/submodel.aasx",
    "makeWorkbook": "POST /api/v1/report.xlsx",
    "renameSelection": "PATCH /api/v1/selections/{id}",
    "saveSelection": "POST /api/v1/selections",
    "select": "POST /api/v1/select",
    "selectBatch": "POST /api/v1/select/batch",
    "sizeFleet": "POST /api/v1/fleet",
}
"""Generated clients name their functions by these: rename none without a new version of the API."""


def operations(document: Json) -> Iterator[tuple[str, str, Json]]:
    """Method, path and entry of every operation."""
    for path, entries in document["paths"].items():
        for method, entry in entries.items():
            yield method.upper(), path, entry


# --- Names ------------------------------------------------------------------------------------------------------------


def test_operations_keep_their_ids(document: Json) -> None:
    assert {entry["operationId"]: f"{method} {path}" for method, path, entry in operations(document)} == OPERATIONS


def test_every_operation_has_one_tag_and_every_tag_says_what_it_holds(document: Json) -> None:
    used = [tuple(entry["tags"]) for _, _, entry in operations(document)]

    assert all(len(tags) == 1 for tags in used)
    assert {tag["name"] for tag in document["tags"]} == {tag for (tag,) in used}
    assert all(tag["description"] for tag in document["tags"])


def test_the_server_is_whoever_sent_the_document(document: Json) -> None:
    assert [server["url"] for server in document["servers"]] == ["/"]


def test_every_link_leads_to_an_operation_with_such_a_parameter(document: Json) -> None:
    taken = {
        entry["operationId"]: {parameter["name"] for parameter in entry.get("parameters", ())}
        for _, _, entry in operations(document)
    }
    followed = 0
    for _, _, entry in operations(document):
        for response in entry["responses"].values():
            for link in response.get("links", {}).values():
                assert set(link["parameters"]) <= taken[link["operationId"]], link
                followed += 1
    assert followed > 10


# --- Bounds -----------------------------------------------------------------------------------------------------------


def resolved(document: Json, schema: Json) -> Json:
    """A schema without its reference, and without that it may be null."""
    union = (*schema.get("anyOf", ()), *schema.get("oneOf", ()))
    options = [option for option in union if option.get("type") != "null"]
    schema = options[0] if options else schema
    return document["components"]["schemas"][schema["$ref"].rpartition("/")[2]] if "$ref" in schema else schema


def leaves(document: Json, schema: Json, path: Path = ()) -> Iterator[tuple[Path, Json]]:
    """Every part of a schema with its path, lists by their first item."""
    schema = resolved(document, schema)
    yield path, schema
    for name, entry in schema.get("properties", {}).items():
        yield from leaves(document, entry, (*path, name))
    if "items" in schema:
        yield from leaves(document, schema["items"], (*path, 0))


def tries(schema: Json, there: Any = None) -> Iterator[tuple[Any, bool]]:
    """Values at every bound of a schema, which it allows, and just beyond, which it refuses."""
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


def with_value(body: Json, path: Path, value: Any) -> Json:
    """A copy of a body with another value at a path."""
    changed: Any = copy.deepcopy(body)
    place = changed
    for step in path[:-1]:
        place = place[step]
    place[path[-1]] = value
    return dict(changed)


def at(body: Json, path: Path) -> Any:
    """Value at a path, or None."""
    value: Any = body
    for step in path:
        value = value.get(step) if isinstance(value, dict) else value[step]
    return value


def refusals(response: Any, pointer: str) -> list[str]:
    """Errors of the models at a place; that the catalogue or the list has no such entry is no bound."""
    assert response.status_code in (200, 201, 404, 413, 422), response.text
    errors = response.json().get("errors", []) if response.status_code in (413, 422) else []
    found = [error["detail"] for error in errors if error["pointer"] == pointer]
    return [text for text in found if not re.match("the catalogue has no|is not a cursor", text)]


INERTIAS = {"inertia_kgm2": 0.001, "inertia_ratio": 5}
WHOLE: Json = FULL | {
    "requirements": FULL["requirements"]
    | {
        "ratios": [5],
        "sizes": ["20A"],
        "load_inertia_kgm2": 1,
        "position_radius_mm": 9,
        "motor": FULL["requirements"]["motor"] | INERTIAS,
    },
    "duty_cycle": FULL["duty_cycle"]
    | {"phases": [phase | {"radial_N": 1, "axial_N": 1} for phase in FULL["duty_cycle"]["phases"]]},
}
BODIES: dict[str, tuple[str, Json]] = {
    "Application": ("/api/v1/select", WHOLE),
    "SaveRequest": ("/api/v1/selections", {"application": worked_example(), "title": "t", "reference": "r"}),
    "Batch": ("/api/v1/select/batch", {"applications": [{}]}),
}


RACK: Json = LIFTING | {"mechanism": {"type": "rack_and_pinion", "mass_kg": 80.0, "diameter_mm": 60.0}}
GRAVITY = ("gravity_mass_kg", "gravity_radius_mm")
WEIGHTLESS: Json = TURNING | {
    "mechanism": {name: value for name, value in TURNING["mechanism"].items() if name not in GRAVITY}
}
TRIED_BY_THEMSELVES: tuple[Path, ...] = (("applications", 0), ("duty_cycle", "motion"), ("emergency_stop", "brake"))


@pytest.mark.parametrize("name", BODIES)
def test_each_bound_of_a_body_is_the_one_that_is_applied(api: TestClient, document: Json, name: str) -> None:
    address, body = BODIES[name]
    tried = 0
    for path, schema in leaves(document, document["components"]["schemas"][name]):
        # Tried by themselves: applications, and a code that has to be one besides being no longer than it may.
        if (
            path[:1] in (("application",), ("ordering_code",))
            or path[:2] in TRIED_BY_THEMSELVES
            or path[-1:] == ("designation",)
        ):
            continue
        # Bounded by their phase besides.
        if path[-1:] in (("peak_torque_Nm",), ("peak_speed_rpm",), ("rms_torque_Nm",)) and "phases" in path:
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
        if path[:2] == ("moves", 0):  # each bounds the others
            continue
        # An inertia is bounded by the gravity mass besides, so that it is tried without one.
        given = WEIGHTLESS if name == "RotaryMotion" and path[-1:] == ("inertia_kgm2",) else motion
        for value, allowed in tries(schema, at(given, path)):
            response = api.post("/api/v1/select", json={"duty_cycle": {"motion": with_value(given, path, value)}})
            pointer = "".join(f"/{step}" for step in ("duty_cycle", "motion", *path))
            assert (refusals(response, pointer) == []) is allowed, (pointer, str(value)[:60], response.text[:300])
            tried += 1
    assert tried >= 12


def test_each_bound_of_a_brake_is_the_one_that_is_applied(api: TestClient, document: Json) -> None:
    tried, brake = (
        0,
        {"torque_Nm": 8.0, "rise_time_s": 0.01, "reaction_time_s": 0.02, "speed_rpm": 9.0, "dynamic_factor": 2.0},
    )
    for path, schema in leaves(document, document["components"]["schemas"]["Brake"]):
        for value, allowed in tries(schema, at(brake, path)):
            body = worked_example() | {"emergency_stop": {"brake": with_value(brake, path, value)}}
            response = api.post("/api/v1/select", json=body)
            pointer = "".join(f"/{step}" for step in ("emergency_stop", "brake", *path))
            assert (refusals(response, pointer) == []) is allowed, (pointer, str(value)[:60], response.text[:300])
            tried += 1
    assert tried >= 8


def test_each_bound_of_a_query_is_the_one_that_is_applied(api: TestClient, document: Json) -> None:
    tried = 0
    for method, path, operation in operations(document):
        for parameter in operation.get("parameters", ()):
            for value, allowed in tries(parameter["schema"], ["a"]) if parameter["in"] == "query" else ():
                address = path.format(size="20A", designation="HPN-20A-5", id="A" * 22)
                given = {parameter["name"]: value}
                table: Json = {"content": b"axis", "headers": {"Content-Type": "text/csv"}} if method == "POST" else {}
                response = api.request(method, address, params=given, **table)
                found = refusals(response, f"/{parameter['name']}")
                assert (found == []) is allowed, (path, parameter["name"], value, found)
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


# --- Examples ---------------------------------------------------------------------------------------------------------


def test_an_example_gives_the_answer_that_stands_beside_it(api: TestClient, document: Json) -> None:
    compared = []
    for method, path, operation in operations(document):
        address = path.format(**{entry["name"]: entry.get("example", "") for entry in operation.get("parameters", ())})
        for status, response in operation["responses"].items():
            for media_type, content in response.get("content", {}).items():
                for name, example in content.get("examples", {}).items():
                    answer = asked(api, method, address, operation, media_type, name)
                    shown = answer.text if media_type.endswith("ndjson") else answer.json()
                    assert (answer.status_code, shown) == (int(status), example["value"]), (path, name)
                    compared.append((operation["operationId"], name))
    assert compared == [
        ("select", "worked_example"),
        ("select", "no_duration"),
        ("selectBatch", "worked_example"),
        ("selectBatch", "two_lines"),
        ("getGear", "first_gear"),
        ("getBearingEnvelopes", "first_size"),
    ]


def asked(api: TestClient, method: str, address: str, operation: Json, media_type: str, name: str) -> Any:
    """Answer to the request that stands as an example."""
    bodies = operation.get("requestBody", {}).get("content", {})
    if media_type.endswith("ndjson"):
        lines = bodies[media_type]["examples"][name]["value"]
        return api.request(method, address, content=lines, headers={"Content-Type": media_type})
    if not bodies:
        return api.request(method, address)
    body = bodies["application/json"]["examples"]["worked_example"]["value"]
    if name == "no_duration":
        body = with_value(body, ("duty_cycle", "phases", 0, "duration_s"), 0)
    return api.request(method, address, json=body)


def test_every_content_type_of_a_body_is_taken_and_no_other(api: TestClient, document: Json) -> None:
    patched = set()
    for method, address, operation in operations(document):
        declared = operation.get("requestBody", {}).get("content", {})
        for media_type in (*declared, "application/x-other") if declared else ():
            at = re.sub(r"\{.*?\}", "HPN-20A-5", address)
            answer = api.request(method, at, content="", headers={"Content-Type": media_type})
            assert (answer.status_code == 415) is (media_type not in declared), (method, address, media_type)
            if method.lower() == "patch":
                patched.add(media_type)

    assert patched == {"application/json", "application/merge-patch+json", "application/x-other"}


# --- Headers ----------------------------------------------------------------------------------------------------------

OF_HTTP = {"cache-control", "content-encoding", "content-length", "content-type", "vary", "x-accel-buffering"}
OF_HTTP |= {name.lower() for name in SECURITY_HEADERS}
"""Headers that say nothing of the selection."""


def test_every_answer_is_in_the_document_with_each_of_its_headers(api: TestClient, document: Json) -> None:
    application = worked_example()
    saved = api.post("/api/v1/selections", json={"application": application}, headers={"Prefer": "return=minimal"})
    api.post("/api/v1/selections", json={"application": application})
    own = saved.headers["location"]
    tag = api.get(own).headers["etag"]
    answers = {
        "saveSelection": [saved, api.post("/api/v1/selections", json={})],
        "getSelection": [api.get(own), api.get(own, headers={"If-None-Match": tag}), api.get(own[:-1])],
        "listSelections": [api.get("/api/v1/selections?limit=1"), api.get("/api/v1/selections?limit=0")],
        "getSelectionReport": [
            report := api.get(f"{own}/report.pdf"),
            api.get(f"{own}/report.pdf", headers={"If-None-Match": report.headers["etag"]}),
        ],
        "deleteSelection": [api.delete(own, headers={"If-Match": '"x"'}), api.delete(own), api.delete(own)],
        "select": [api.post("/api/v1/select", json=application), api.post("/api/v1/select", content="{}")],
        "selectBatch": [api.post("/api/v1/select/batch", headers={"Content-Type": "application/x-ndjson"})],
        "getApplicationSchema": [api.get("/api/v1/application.schema.json")],
        "getMetrics": [api.get("/metrics")],
        "getHealth": [api.get("/healthz")],
        "makeReport": [with_keys().post("/api/v1/report.pdf", json=application)],
    }
    entries = {entry["operationId"]: entry for _, _, entry in operations(document)}
    for name, responses in answers.items():
        for response in responses:
            entry = entries[name]["responses"][str(response.status_code)]
            media_type = response.headers.get("content-type", "").partition(";")[0]
            assert not response.content or media_type in entry["content"], (name, response.status_code)
            sent = {header for header in response.headers if header not in OF_HTTP}
            said = {header.lower() for header in entry["headers"]}
            assert sent <= said, (name, response.status_code)


def test_refusals_that_any_address_may_give_are_in_the_document(service: FastAPI, document: Json) -> None:
    client = TestClient(service, follow_redirects=False)
    elsewhere = TestClient(create_app(Settings(allowed_hosts="hpn.example")))
    for method, path, entry in operations(document):
        address = path.format(size="20A", designation="HPN-20A-5", id="A" * 22)
        found = [client.request("TRACE", address), client.request(method, f"{address}/")]
        assert [answer.status_code for answer in found] == [405, 307], path
        if path not in ("/healthz", "/readyz"):
            found.append(elsewhere.request(method, address))
            assert found[-1].status_code == 421
            assert "503" in entry["responses"]
        for answer in found:
            said = entry["responses"][str(answer.status_code)]
            media_type = answer.headers.get("content-type", "")
            assert not answer.content or media_type in said["content"]
            assert {name for name in answer.headers if name not in OF_HTTP} <= {
                name.lower() for name in said["headers"]
            }


def with_keys() -> TestClient:
    """Client without a key of a service that wants one for every calculation."""
    _, pair = new_key("plm")
    return TestClient(create_app(Settings(api_keys=pair, guarded="calculator")))


def test_every_header_in_the_document_is_used_by_some_answer(document: Json) -> None:
    used = {
        name
        for _, _, entry in operations(document)
        for response in entry["responses"].values()
        for name in response["headers"]
    }

    assert used == set(HEADERS) == set(document["components"]["headers"])


def test_the_link_of_a_reply_says_how_long_a_link_the_page_opens(document: Json) -> None:
    schemas = document["components"]["schemas"]

    for name in ("Selection", "BatchLine"):
        assert f"{MAXIMUM_QUERY_BYTES:,} bytes" in schemas[name]["properties"]["link"]["description"]

"""OpenAPI document: valid, complete, and in agreement with the service's answers."""

import copy
import json
from collections.abc import Iterator
from typing import Any

import jsonschema_rs
import pytest
from schemathesis.specs.openapi.definitions import OPENAPI_31
from starlette.testclient import TestClient

from hpn.web.app import create_app
from hpn.web.door.keys import new_key
from hpn.web.settings import Settings
from hpn.words.units import suffix_of, symbol_of
from tests.build import TURNING, cycle, phase, worked_example

Json = dict[str, Any]
FULL = worked_example(
    output_load={"radial_N": 500, "axial_N": 200, "load_coefficient": 1.2, "life_h": 20000, "model": "iso281"},
    requirements={
        "life_h": 20000,
        "backlash_arcmin": 7,
        "torsional_stiffness_Nm_per_rad": 5000,
        "weight_kg": 5,
        "length_mm": 200,
        "ambient_temperature_degC": 25,
        "utilisation": 1.0,
        "efficiency": 0.95,
        "motor": {"maximum_speed_rpm": 4000, "peak_torque_Nm": 20, "rated_torque_Nm": 8},
    },
    application_area="vacuum",
) | {"emergency_stop": {"torque_Nm": 200, "count": 1000}}


def validator(document: Json, name: str, *, closed: bool = True) -> jsonschema_rs.Validator:
    """Validator of a schema of the document; `closed` refuses unknown fields."""
    components = copy.deepcopy(document["components"])
    if closed:
        for schema in components["schemas"].values():
            if "properties" in schema:
                schema.setdefault("additionalProperties", False)
    return jsonschema_rs.validator_for(
        {
            "$schema": "https://json-schema.org/draft/2020-12/schema",
            "$ref": f"#/components/schemas/{name}",
            "components": components,
        }
    )


def fields(document: Json) -> Iterator[tuple[str, str, Json]]:
    """Yield schema name, name and entry of every field of every schema."""
    for schema_name, schema in document["components"]["schemas"].items():
        for name, entry in schema.get("properties", {}).items():
            yield schema_name, name, entry


def test_every_number_of_the_document_has_a_format(document: Json) -> None:
    """Without one a client in Go computes in 32 bits."""
    text = json.dumps(document)
    for kind, form in (("number", "double"), ("integer", "int64")):
        assert text.count(f'"format": "{form}"') == text.count(f'"type": "{kind}"') > 10


def test_motor_torques_are_described_as_a_lower_bound_without_an_efficiency(document: Json) -> None:
    candidate = document["components"]["schemas"]["Candidate"]["properties"]
    for name in ("motor_peak_torque_Nm", "motor_rated_torque_Nm"):
        assert "lower bound" in candidate[name]["description"]


def test_the_document_is_valid_openapi_3_1_and_served_as_it_is(api: TestClient, document: Json) -> None:
    served = api.get("/openapi.json").json()

    assert served == document
    assert served["openapi"].startswith("3.1")
    jsonschema_rs.validator_for(OPENAPI_31).validate(served)


def test_every_schema_of_the_document_is_valid_json_schema_and_every_reference_leads_somewhere(document: Json) -> None:
    for name, schema in document["components"]["schemas"].items():
        jsonschema_rs.meta.validate({"$schema": "https://json-schema.org/draft/2020-12/schema", **schema})
        assert validator(document, name) is not None  # compiling it follows its references


def test_every_endpoint_of_the_contract_is_in_the_document(document: Json) -> None:
    expected = {
        ("/api/v1/select", "post"),
        ("/api/v1/select/batch", "post"),
        ("/api/v1/catalogue", "get"),
        ("/api/v1/catalogue/{designation}", "get"),
        ("/api/v1/bearing-envelopes/{size}", "get"),
        ("/healthz", "get"),
        ("/readyz", "get"),
    }
    there = {(path, method) for path, operations in document["paths"].items() for method in operations}

    assert expected <= there


def test_every_operation_has_a_summary_a_description_and_its_refusals_as_problems(document: Json) -> None:
    for path, operations in document["paths"].items():
        for method, operation in operations.items():
            assert operation.get("summary"), (path, method)
            assert operation.get("description"), (path, method)
            for status, response in operation["responses"].items():
                if status.startswith(("4", "5")):
                    assert list(response["content"]) == ["application/problem+json"], (path, method, status)
                    schema = response["content"]["application/problem+json"]["schema"]
                    assert schema == {"$ref": "#/components/schemas/ProblemReply"}


def test_every_field_has_a_description(document: Json) -> None:
    missing = [f"{schema}.{name}" for schema, name, entry in fields(document) if not entry.get("description")]

    assert missing == []


def test_every_field_whose_name_ends_in_a_unit_says_so_and_no_other(document: Json) -> None:
    for schema, name, entry in fields(document):
        if suffix_of(name):
            assert entry.get("x-unit") == symbol_of(name), f"{schema}.{name}"
        else:
            assert "x-unit" not in entry, f"{schema}.{name}"


def test_every_parameter_of_a_query_or_path_has_a_description_and_its_unit(document: Json) -> None:
    for path, operations in document["paths"].items():
        for operation in operations.values():
            for parameter in operation.get("parameters", ()):
                where = (path, parameter["name"])
                assert parameter.get("description") or parameter["schema"].get("description"), where
                if suffix_of(parameter["name"]):
                    unit = parameter.get("x-unit") or parameter["schema"].get("x-unit")
                    assert unit == symbol_of(parameter["name"]), where


def test_an_operation_not_open_to_all_says_which_keys_it_takes_and_that_it_may_refuse(document: Json) -> None:
    for path, operations in document["paths"].items():
        for method, operation in operations.items():
            is_open = path in ("/healthz", "/readyz")
            refusals = {"401", "429"} & set(operation["responses"])
            assert refusals == (set() if is_open else {"401", "429"}), (path, method)
            assert operation["security"] == ([] if is_open else [{"bearer": []}, {"key": []}, {}]), (path, method)


def test_where_a_key_is_needed_the_document_does_not_say_it_can_be_left_out() -> None:
    _, pair = new_key("plm")
    paths = create_app(Settings(api_keys=pair)).openapi()["paths"]

    assert paths["/api/v1/selections"]["post"]["security"] == [{"bearer": []}, {"key": []}]
    assert paths["/api/v1/select"]["post"]["security"] == [{"bearer": []}, {"key": []}, {}]


def test_every_example_of_a_field_is_valid_by_its_own_schema(document: Json) -> None:
    for schema, name, entry in fields(document):
        for example in entry.get("examples", ()):
            others = document["components"]["schemas"][schema].get("required", [])
            if others in ([], [name]):
                validator(document, schema).validate({name: example})
            else:
                property_schema = {**entry, "components": document["components"]}
                jsonschema_rs.validator_for(property_schema).validate(example)


@pytest.mark.parametrize("path", ["/api/v1/select", "/api/v1/select/batch"])
def test_a_whole_request_stands_as_an_example_and_is_accepted(api: TestClient, document: Json, path: str) -> None:
    content = document["paths"][path]["post"]["requestBody"]["content"]["application/json"]
    examples = [entry["value"] for entry in content.get("examples", {}).values()]
    if "example" in content:
        examples.append(content["example"])

    assert examples, f"{path} has no example of a request"
    for example in examples:
        assert api.post(path, json=example).status_code == 200


APPLICATIONS: dict[str, Json] = {
    "full": FULL,
    "least": {"duty_cycle": {"phases": [phase(1, 1)]}},
    "no gear fits": cycle(phase(9000, 100), emergency_stop={"torque_Nm": 20000, "count": 3}),
    "no torque": cycle(phase(0, 100, radial_N=0.0), requirements={"life_h": 5}),
    "null is not given": {
        "duty_cycle": {"phases": [phase(1, 1) | {"radial_N": None, "peak_speed_rpm": None}], "motion": None},
        "emergency_stop": None,
        "output_load": None,
        "requirements": {"ratios": None, "life_h": None, "motor": None},
        "application_area": None,
    },
    "a motion": {"duty_cycle": {"phases": None, "motion": TURNING}},
}


@pytest.mark.parametrize("case", APPLICATIONS, ids=list(APPLICATIONS))
def test_request_and_reply_of_select_are_valid_by_the_schemas_to_the_last_field(
    api: TestClient, document: Json, case: str
) -> None:
    validator(document, "Application").validate(APPLICATIONS[case])

    reply = api.post("/api/v1/select", json=APPLICATIONS[case])

    assert reply.status_code == 200
    validator(document, "Selection").validate(reply.json())


def test_other_replies_are_valid_by_their_schemas_to_the_last_field(api: TestClient, document: Json) -> None:
    batch = {"applications": [FULL | {"reference": "a"}, {}, cycle(phase(9000, 1))]}
    validator(document, "BatchReply").validate(api.post("/api/v1/select/batch", json=batch).json())
    validator(document, "CatalogueReply").validate(api.get("/api/v1/catalogue").json())
    validator(document, "OneGearReply").validate(api.get("/api/v1/catalogue/HPN-40A-5").json())
    validator(document, "EnvelopeReply").validate(api.get("/api/v1/bearing-envelopes/20A").json())
    own = api.post("/api/v1/selections", json={"application": FULL, "title": "t"})
    saved = own.headers["location"]
    validator(document, "SavedSelectionReply").validate(api.get(saved).json())
    validator(document, "SavedSelectionReply").validate(api.patch(saved, json={"reference": "r"}).json())
    validator(document, "SelectionListReply").validate(api.get("/api/v1/selections?reference=r").json())
    validator(document, "SavedReply").validate(api.post("/api/v1/selections", json={"application": FULL}).json())
    validator(document, "MotorsReply").validate(api.get("/api/v1/motors").json())
    validator(document, "MotorsOnGearReply").validate(api.post("/api/v1/motors/HPN-20A-5", json=FULL).json())
    motor = {"designation": "M 40", "rated_torque_Nm": 2.4, "inertia_kgm2": 0.00015}
    pairs = api.post("/api/v1/pairs", json={"application": cycle(phase(20, 100)), "motors": [motor], "top": 1000})
    validator(document, "Pairs").validate(pairs.json())
    validator(document, "Health").validate(api.get("/healthz").json())
    validator(document, "Readiness").validate(api.get("/readyz").json())
    for problem in (
        api.get("/api/v1/catalogue/HPN-1A-1"),
        api.get("/nowhere"),
        api.post("/api/v1/select", json={}),
        api.get("/api/v1/bearing-envelopes/40A"),
    ):
        validator(document, "ProblemReply").validate(problem.json())


def test_every_reply_is_described_by_its_model_alone(document: Json) -> None:
    """A `type` beside the reference to an object would make a schema that nothing satisfies."""
    for path, operations in document["paths"].items():
        for method, operation in operations.items():
            for status, response in operation["responses"].items():
                for content in response.get("content", {}).values():
                    if "$ref" in content["schema"]:
                        assert set(content["schema"]) == {"$ref"}, (path, method, status)


OF_TOLERANCES = {"tolerance", "worst", "exact"}
"""Fields that only an answer to an application with tolerances has."""


def test_a_required_field_is_never_null_and_an_optional_reply_field_may_be_left_out(document: Json) -> None:
    """Client generators rely on `required` to list the fields that are always there."""
    for name in ("Selection", "Candidate", "CheckResult", "OneGearReply", "EnvelopeReply"):
        schema = document["components"]["schemas"][name]
        assert set(schema["required"]) == set(schema["properties"]) - OF_TOLERANCES, name

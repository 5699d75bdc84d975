"""Agreement of the service with its OpenAPI document: names, bounds, examples, headers, links."""

import copy
from collections.abc import Iterator
from typing import Any

from fastapi import FastAPI
from starlette.testclient import TestClient

from hpn.web.api.schemas import HEADERS
from hpn.web.app import create_app
from hpn.web.door.access import MAXIMUM_QUERY_BYTES
from hpn.web.door.keys import new_key
from hpn.web.door.observation import SECURITY_HEADERS
from hpn.web.settings import Settings
from tests.build import worked_example

Json = dict[str, Any]
Path = tuple[str | int, ...]

OPERATIONS = {
    "addAxes": "POST /api/v1/machines/{id}/axes",
    "changeAxes": "PATCH /api/v1/machines/{id}/axes",
    "changeAxis": "PATCH /api/v1/machines/{id}/axes/{number}",
    "changeMachine": "PATCH /api/v1/machines/{id}",
    "deleteMachine": "DELETE /api/v1/machines/{id}",
    "deleteMotorList": "DELETE /api/v1/motor-lists/{id}",
    "deleteSelection": "DELETE /api/v1/selections/{id}",
    "fitMotors": "POST /api/v1/motors/{designation}",
    "getApplicationSchema": "GET /api/v1/application.schema.json",
    "getAxesAsCsv": "GET /api/v1/machines/{id}/axes.csv",
    "getAxesAsParquet": "GET /api/v1/machines/{id}/axes.parquet",
    "getAxis": "GET /api/v1/machines/{id}/axes/{number}",
    "getAxisReport": "GET /api/v1/machines/{id}/axes/{number}/report.pdf",
    "getAxisSelection": "GET /api/v1/machines/{id}/axes/{number}/selection",
    "getAxisSubmodel": "GET /api/v1/machines/{id}/axes/{number}/submodel.aasx",
    "getBearingEnvelopes": "GET /api/v1/bearing-envelopes/{size}",
    "getCatalogue": "GET /api/v1/catalogue",
    "getDifferences": "GET /api/v1/machines/{id}/differences",
    "getDifferencesAsPdf": "GET /api/v1/machines/{id}/differences.pdf",
    "getDifferencesAsWorkbook": "GET /api/v1/machines/{id}/differences.xlsx",
    "getGear": "GET /api/v1/catalogue/{designation}",
    "getGearList": "GET /api/v1/machines/{id}/gears.xlsx",
    "getGears": "GET /api/v1/machines/{id}/gears",
    "getHealth": "GET /healthz",
    "getKinds": "GET /api/v1/machines/{id}/kinds",
    "getMachine": "GET /api/v1/machines/{id}",
    "getMachineReport": "GET /api/v1/machines/{id}/report.pdf",
    "getMetrics": "GET /metrics",
    "getMotorList": "GET /api/v1/motor-lists/{id}",
    "getMotors": "GET /api/v1/motors",
    "getReadiness": "GET /readyz",
    "getRevision": "GET /api/v1/machines/{id}/revisions/{label}",
    "getSelection": "GET /api/v1/selections/{id}",
    "getSelectionReport": "GET /api/v1/selections/{id}/report.pdf",
    "getSelectionRevision": "GET /api/v1/selections/{id}/revisions/{label}",
    "getSelectionSubmodel": "GET /api/v1/selections/{id}/submodel.aasx",
    "getSelectionWorkbook": "GET /api/v1/selections/{id}/report.xlsx",
    "listMachines": "GET /api/v1/machines",
    "listMotorLists": "GET /api/v1/motor-lists",
    "listRevisions": "GET /api/v1/machines/{id}/revisions",
    "listSelectionRevisions": "GET /api/v1/selections/{id}/revisions",
    "listSelections": "GET /api/v1/selections",
    "makeReport": "POST /api/v1/report.pdf",
    "makeSubmodel": "POST /api/v1/submodel.aasx",
    "makeWorkbook": "POST /api/v1/report.xlsx",
    "pairMotors": "POST /api/v1/pairs",
    "putAxis": "PUT /api/v1/machines/{id}/axes/{number}",
    "putMotorList": "PUT /api/v1/motor-lists/{id}",
    "readSizing": "POST /api/v1/sizing",
    "removeAxis": "DELETE /api/v1/machines/{id}/axes/{number}",
    "renameSelection": "PATCH /api/v1/selections/{id}",
    "saveMachine": "POST /api/v1/machines",
    "saveMotorList": "POST /api/v1/motor-lists",
    "saveRevision": "POST /api/v1/machines/{id}/revisions",
    "saveSelection": "POST /api/v1/selections",
    "saveSelectionRevision": "POST /api/v1/selections/{id}/revisions",
    "select": "POST /api/v1/select",
    "selectBatch": "POST /api/v1/select/batch",
    "sizeFleet": "POST /api/v1/fleet",
}
"""Operation ids, which name the functions of generated clients: rename none without a new version of the API."""


def operations(document: Json) -> Iterator[tuple[str, str, Json]]:
    """Yield method, path and entry of every operation."""
    for path, entries in document["paths"].items():
        for method, entry in entries.items():
            yield method.upper(), path, entry


def at(path: str) -> str:
    """Address of an operation on an id without a document."""
    return path.format(size="20A", designation="HPN-20A-5", id="A" * 22, number=1, label="A")


def with_value(body: Json, path: Path, value: Any) -> Json:
    """Copy of a body with another value at a path."""
    changed: Any = copy.deepcopy(body)
    place = changed
    for step in path[:-1]:
        place = place[step]
    place[path[-1]] = value
    return dict(changed)


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


def test_every_content_type_of_a_body_is_taken_and_no_other(api: TestClient, document: Json) -> None:
    patched = set()
    for method, address, operation in operations(document):
        declared = operation.get("requestBody", {}).get("content", {})
        for media_type in (*declared, "application/x-other") if declared else ():
            answer = api.request(method, at(address), content="", headers={"Content-Type": media_type})
            assert (answer.status_code == 415) is (media_type not in declared), (method, address, media_type)
            if method.lower() == "patch":
                patched.add(media_type)

    assert patched == {"application/json", "application/merge-patch+json", "application/x-other"}


# --- Headers ----------------------------------------------------------------------------------------------------------

OF_HTTP = {"cache-control", "content-encoding", "content-length", "content-type", "vary", "x-accel-buffering"}
OF_HTTP |= {name.lower() for name in SECURITY_HEADERS}
"""Headers without information on the selection."""


def test_every_answer_is_in_the_document_with_each_of_its_headers(api: TestClient, document: Json) -> None:
    application = worked_example()
    saved = api.post("/api/v1/selections", json={"application": application})
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
            names = {header.lower() for header in entry["headers"]}
            assert sent <= names, (name, response.status_code)


def test_refusals_that_any_address_may_give_are_in_the_document(service: FastAPI, document: Json) -> None:
    client = TestClient(service, follow_redirects=False)
    elsewhere = TestClient(create_app(Settings(allowed_hosts="hpn.example")))
    for method, path, entry in operations(document):
        address = at(path)
        result = [client.request("TRACE", address), client.request(method, f"{address}/")]
        assert [answer.status_code for answer in result] == [405, 307], path
        if path not in ("/healthz", "/readyz"):
            result.append(elsewhere.request(method, address))
            assert result[-1].status_code == 421
            assert "503" in entry["responses"]
        for answer in result:
            message = entry["responses"][str(answer.status_code)]
            media_type = answer.headers.get("content-type", "")
            assert not answer.content or media_type in message["content"]
            assert {name for name in answer.headers if name not in OF_HTTP} <= {
                name.lower() for name in message["headers"]
            }


def with_keys() -> TestClient:
    """Client without a key, of a service that requires one for calculations."""
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

"""Logs and metrics for operators: one JSON line per request, its id, and Prometheus' counts."""

import json
import re
import sqlite3
from contextlib import closing
from pathlib import Path
from typing import Any

import pytest
from fastapi import FastAPI
from prometheus_client.parser import text_string_to_metric_families
from starlette.requests import Request
from starlette.responses import Response
from starlette.testclient import TestClient

from hpn import ENGINE_VERSION
from hpn.catalogue import Catalogue
from hpn.store import Store
from hpn.store.engine import make_engine
from hpn.web.app import create_app
from hpn.web.door.keys import new_key
from hpn.web.door.metrics import CountedStore, Metrics
from hpn.web.settings import Settings
from tests.build import worked_example
from tests.operations.conftest import MakeClient
from tests.operations.service import serving

SECRET = "4711.25"
"""A figure that stands in the requests, and must not stand in the log."""


def events(text: str) -> list[dict[str, Any]]:
    """Events of the log."""
    return [json.loads(line) for line in text.splitlines()]


def counts(client: TestClient) -> dict[str, float]:
    """Samples of /metrics by name and labels."""
    families = text_string_to_metric_families(client.get("/metrics").text)
    return {
        sample.name + "".join(f" {value}" for _, value in sorted(sample.labels.items())): sample.value
        for family in families
        for sample in family.samples
    }


def test_a_request_is_one_line_with_route_status_and_duration(
    make_client: MakeClient, capsys: pytest.CaptureFixture[str]
) -> None:
    client = make_client()
    capsys.readouterr()

    client.get("/api/v1/catalogue/HPN-20A-5", headers={"X-Request-ID": "plm-42"})

    (event,) = events(capsys.readouterr().out)
    assert event["event"] == "request"
    assert event["level"] == "info"
    assert (event["method"], event["route"], event["status"]) == ("GET", "/api/v1/catalogue/{designation}", 200)
    assert 0 < event["duration_ms"] < 60_000
    assert event["request_id"] == "plm-42"
    assert event["timestamp"].endswith("Z")


def test_no_input_stands_in_the_log(make_client: MakeClient, capsys: pytest.CaptureFixture[str]) -> None:
    client = make_client()
    application = worked_example(emergency_stop={"torque_Nm": float(SECRET)})
    client.get(f"/?T={SECRET}&n=100&t=1")
    client.get(f"/?T={SECRET}x&n=100&t=1")
    client.get(f"/api/v1/{SECRET}")
    client.get(f"/api/v1/catalogue/{SECRET}")
    client.post("/api/v1/select", json=application)
    client.post("/api/v1/select", content=f'{{"{SECRET}'.encode(), headers={"Content-Type": "application/json"})
    client.post("/api/v1/select/batch", json={"applications": [application, {"reference": SECRET}]})
    client.post("/api/v1/selections", json={"application": application, "title": SECRET, "reference": SECRET})
    client.get(f"/api/v1/selections?reference={SECRET}")

    logged = capsys.readouterr().out
    assert len(events(logged)) >= 9
    assert SECRET not in logged


def test_no_input_stands_in_what_is_logged_of_a_store_that_fails(
    make_client: MakeClient, tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    client = make_client()
    with closing(sqlite3.connect(tmp_path / "store.sqlite3")) as connection:
        connection.execute("DROP TABLE documents")

    client.post("/api/v1/selections", json={"application": worked_example(), "title": SECRET})
    client.get(f"/api/v1/selections?reference={SECRET}")

    assert caplog.text.count("the store is not available") == 2
    assert SECRET not in caplog.text


def test_an_engine_of_either_database_hides_parameters(tmp_path: Path) -> None:
    engines = [
        make_engine(address, seconds=1) for address in ("postgresql://h/d", f"sqlite:///{tmp_path}/store.sqlite3")
    ]

    assert [engine.sync_engine.hide_parameters for engine in engines] == [True, True]


def test_no_input_stands_in_the_log_of_a_service_that_logs_all_it_can(tmp_path: Path) -> None:
    with serving(tmp_path, {"HPN_LOG_LEVEL": "debug"}) as service:
        save = {"application": worked_example(), "title": SECRET, "reference": SECRET}
        saved = service.client.post("/api/v1/selections", json=save)
        listed = service.client.get(f"/api/v1/selections?reference={SECRET}", headers={"X-Request-ID": "last"})
        service.event(request_id="last")

    assert (saved.status_code, listed.status_code) == (201, 200)
    assert SECRET not in service.log.read_text()


@pytest.mark.parametrize("id", ["", "a b", "x" * 65, "ü", "a\tb"])
def test_an_id_that_is_not_well_formed_is_replaced(id: str, make_client: MakeClient) -> None:
    response = make_client().get("/healthz", headers={b"X-Request-ID": id.encode("latin-1")})

    assert re.fullmatch("[0-9a-f]{32}", response.headers["X-Request-ID"])


def test_every_answer_has_an_id_of_its_own(make_client: MakeClient) -> None:
    client = make_client()
    paths = ["/", "/healthz", "/nowhere", "/api/v1/catalogue", "/api/v1/select"]

    assert len({client.get(path).headers["X-Request-ID"] for path in paths}) == len(paths)


def test_routes_asked_every_few_seconds_are_not_logged(
    make_client: MakeClient, capsys: pytest.CaptureFixture[str]
) -> None:
    client = make_client()
    capsys.readouterr()
    for path in ("/healthz", "/readyz", "/metrics"):
        client.get(path)

    assert capsys.readouterr().out == ""


def test_the_key_that_asked_is_named(make_client: MakeClient, capsys: pytest.CaptureFixture[str]) -> None:
    key, pair = new_key("plm")
    make_client(api_keys=pair).get("/api/v1/selections", headers={"X-API-Key": key})
    logged = capsys.readouterr().out

    assert events(logged)[-1]["key"] == "plm"
    assert key not in logged


def failing(app: FastAPI) -> FastAPI:
    """The application with a route that fails."""

    async def fail(request: Request) -> Response:
        raise RuntimeError("a mistake")

    app.router.add_route("/fail", fail)
    return app


def test_a_mistake_is_logged_once_with_its_trace_and_answered_as_a_problem(
    capsys: pytest.CaptureFixture[str], caplog: pytest.LogCaptureFixture
) -> None:
    response = TestClient(failing(create_app(Settings(log_level="error")))).get("/fail")

    assert response.status_code == 500
    assert response.headers["Content-Type"] == "application/problem+json"
    assert "X-Request-ID" in response.headers
    assert "Content-Security-Policy" in response.headers
    assert "mistake" not in response.json()["title"]
    (event,) = events(capsys.readouterr().out)
    assert event["level"] == "error"
    assert event["request_id"] == response.headers["X-Request-ID"]
    assert 'RuntimeError("a mistake")' in event["exception"]
    assert caplog.records == []


def test_requests_are_counted_by_route_and_status(make_client: MakeClient) -> None:
    client = make_client()
    for name in ("HPN-20A-5", "HPN-14A-5", "none"):
        client.get(f"/api/v1/catalogue/{name}")
    client.get("/some/where")
    client.request("BREW", "/healthz")

    result = counts(client)
    route = "/api/v1/catalogue/{designation}"
    assert result[f"hpn_http_requests_total GET {route} 200"] == 2
    assert result[f"hpn_http_requests_total GET {route} 404"] == 1
    assert result["hpn_http_requests_total GET none 404"] == 1
    assert result["hpn_http_requests_total other /healthz 405"] == 1
    assert result[f"hpn_http_request_duration_seconds_count GET {route}"] == 3


def test_selections_are_counted_by_verdict_wherever_they_are_asked_for(make_client: MakeClient) -> None:
    client = make_client()
    good, heavy = worked_example(), worked_example(requirements={"weight_kg": 0.001})
    client.post("/api/v1/select", json=good)
    client.post("/api/v1/select", json=heavy)
    client.post("/api/v1/select/batch", json={"applications": [good, heavy, {}]})
    client.post("/api/v1/selections", json={"application": good})
    client.get("/?T=40&n=250&t=1")

    result = counts(client)
    assert result["hpn_selections_total selected"] == 4
    assert result["hpn_selections_total none"] == 2
    assert result["hpn_selections_total refused"] == 1


def test_the_versions_that_run_are_a_metric(make_client: MakeClient, catalogue: Catalogue) -> None:
    # Labels in their order: catalogue_version, engine_version.
    assert counts(make_client())[f"hpn_build_info {catalogue.version} {ENGINE_VERSION}"] == 1


def test_operations_of_the_store_are_counted_and_its_failures(make_client: MakeClient) -> None:
    client = make_client()
    id = client.post("/api/v1/selections", json={"application": worked_example()}).json()["id"]
    client.get(f"/api/v1/selections/{id}")
    client.get("/api/v1/selections")
    client.delete(f"/api/v1/selections/{id}")
    result = counts(client)
    values = [result[f"hpn_store_operations_total {name} ok"] for name in ("save", "find", "page", "delete")]
    assert values == [1, 2, 1, 1]  # what is to be deleted is found first, because it has to be one's own

    broken = make_client(database_url="postgresql://nobody@127.0.0.1:1/none", database_seconds=1)
    assert broken.get("/api/v1/selections").status_code == 503
    assert counts(broken)["hpn_store_operations_total pending failed"] == 1


@pytest.mark.anyio
@pytest.mark.parametrize("operation", sorted(name for name in vars(Store) if not name.startswith("_")))
async def test_every_operation_of_the_store_is_counted(operation: str, monkeypatch: pytest.MonkeyPatch) -> None:
    async def nothing(store: Store, *arguments: object, **named: object) -> None:
        pass

    monkeypatch.setattr(Store, operation, nothing)
    metrics = Metrics()
    await getattr(CountedStore(metrics, "sqlite:///none.sqlite3", seconds=1, password=None), operation)()

    counted = f'operation="{operation}",outcome="ok"' in metrics.exposition().decode()
    assert counted == (operation not in ("open", "close", "require_complete"))

"""Rate limits: per key or address, per kind of request, and who an address is behind a proxy."""

import time

import pytest
from pydantic import ValidationError
from starlette.requests import Request
from starlette.testclient import TestClient

from hpn.web.door.access import Gate
from hpn.web.door.keys import new_key
from hpn.web.door.rates import Counters, Limiter, subject_of
from hpn.web.settings import Settings
from tests.build import worked_example
from tests.operations.conftest import MakeClient

SELECT = "/api/v1/select"


def statuses(client: TestClient, count: int, **headers: str) -> list[int]:
    """Answers to some requests of the calculator."""
    return [client.get("/api/v1/catalogue/HPN-20A-5", headers=headers).status_code for _ in range(count)]


def test_more_requests_than_the_rate_are_refused_with_the_time_to_wait(make_client: MakeClient) -> None:
    client = make_client(calculator_rate="2/minute")

    assert statuses(client, 2) == [200, 200]
    refused = client.post(SELECT, json=worked_example())

    assert refused.status_code == 429
    assert refused.headers["Content-Type"] == "application/problem+json"
    assert 1 <= int(refused.headers["Retry-After"]) <= 60
    assert refused.headers["RateLimit-Policy"] == '"calculator";q=2;w=60'
    assert refused.headers["RateLimit"].startswith('"calculator";r=0;t=')
    assert "2 per 1 minute" in refused.json()["detail"]


def test_every_answer_says_how_many_more_requests_may_follow(make_client: MakeClient) -> None:
    client = make_client(calculator_rate="3/minute")

    paths = ("/api/v1/catalogue", "/api/v1/catalogue/none", "/")
    values = [client.get(path).headers["RateLimit"].split(";")[1] for path in paths]

    assert values == ["r=2", "r=1", "r=0"]


def test_too_many_requests_without_a_key_are_a_429_and_no_more_a_401(make_client: MakeClient) -> None:
    client = make_client(calculator_rate="1/minute", api_keys=new_key("plm")[1])

    assert [client.get("/api/v1/selections").status_code for _ in range(2)] == [401, 429]


def test_kinds_of_requests_are_counted_apart(make_client: MakeClient) -> None:
    client = make_client(calculator_rate="1/minute", batch_rate="1/minute", writing_rate="1/minute")
    save = {"application": worked_example()}

    def ask() -> list[int]:
        return [
            client.post(SELECT, json=worked_example()).status_code,
            client.post(f"{SELECT}/batch", json={"applications": []}).status_code,
            client.post("/api/v1/selections", json=save).status_code,
        ]

    assert ask() == [200, 200, 201]
    assert ask() == [429, 429, 429]


def test_another_spelling_of_a_path_is_counted_with_it(make_client: MakeClient) -> None:
    client = make_client(batch_rate="1/minute")

    first = client.post("/api/v1/select/batch", json={"applications": []})
    second = client.post("/api/v1/select/batch%0a", json={"applications": []})

    assert (first.status_code, second.status_code) == (200, 429)


def test_health_and_assets_are_never_limited(make_client: MakeClient) -> None:
    client = make_client(calculator_rate="1/minute")
    statuses(client, 2)

    assert {client.get(path).status_code for path in ("/healthz", "/readyz", "/metrics")} == {200}


def test_metrics_and_the_document_are_within_limits_too(make_client: MakeClient) -> None:
    client = make_client(calculator_rate="2/minute")

    assert [client.get("/metrics").status_code for _ in range(3)] == [200, 200, 429]
    assert [client.get("/openapi.json").status_code for _ in range(3)] == [200, 200, 429]


def test_without_a_rate_answers_say_nothing_of_one(make_client: MakeClient) -> None:
    client = make_client()

    assert "RateLimit" not in client.post(SELECT, json=worked_example()).headers


def test_holders_of_different_keys_are_counted_apart(make_client: MakeClient) -> None:
    (one, first), (two, second) = new_key("one"), new_key("two")
    client = make_client(calculator_rate="1/minute", api_keys=f"{first},{second}")

    assert statuses(client, 2, **{"X-API-Key": one}) == [200, 429]
    assert statuses(client, 2, **{"X-API-Key": two}) == [200, 429]
    assert statuses(client, 2, **{"X-API-Key": "invalid"}) == [401, 429]  # counted by its address


def test_a_forwarded_address_counts_only_from_a_trusted_proxy(make_client: MakeClient) -> None:
    trusting = make_client(calculator_rate="1/minute", trusted_proxies="127.0.0.1 10.0.0.0/8")
    wary = make_client(calculator_rate="1/minute")

    chains = ["192.0.2.1", "192.0.2.2", "198.51.100.9, 192.0.2.2, 10.1.2.3"]
    assert [statuses(trusting, 1, **{"X-Forwarded-For": chain}) for chain in chains] == [[200], [200], [429]]
    assert [statuses(wary, 1, **{"X-Forwarded-For": chain}) for chain in chains] == [[200], [429], [429]]


@pytest.mark.parametrize(
    ("address", "subject"),
    [
        ("192.0.2.1", "192.0.2.1"),
        ("2001:db8:1:2:3:4:5:6", "2001:db8:1:2::/64"),
        ("::ffff:192.0.2.1", "192.0.2.1"),
        ("unix", "unix"),
    ],
)
def test_an_ipv6_customer_is_one_subject(address: str, subject: str) -> None:
    assert subject_of(address) == subject


@pytest.mark.parametrize("rate", ["many", "5", "5/fortnight", ""])
def test_a_rate_that_is_none_stops_the_start(rate: str) -> None:
    with pytest.raises(ValidationError):
        Settings(calculator_rate=rate)


def test_counters_start_again_after_their_window_and_are_forgotten() -> None:
    now, counters = time.time(), Counters()
    for address in range(1000):
        counters.hit(("calculator", f"address {address}"), 60, now)
    assert counters.hit(("calculator", "address 1"), 60, now + 20) == (2, now + 60)

    assert counters.hit(("calculator", "address 1"), 60, now + 61) == (1, now + 121)
    assert len(counters) == 1  # the sweep has taken the rest


def test_the_limiter_costs_little() -> None:
    def best(gate: Gate) -> float:
        costs = []
        for _ in range(20):
            requests = [Request({**SCOPE, "state": {"response_headers": {}}}) for _ in range(200)]
            start = time.process_time()
            for request in requests:
                gate.admit(request, "calculator")
            costs.append((time.process_time() - start) / 200)
        return min(costs)

    limited, free = (Gate(settings) for settings in (Settings(calculator_rate="120000/minute"), Settings()))

    # 10 µs was measured; the bound only catches a mistake such as a thread per request
    assert best(limited) - best(free) < 60e-6
    assert Limiter({"calculator": "off"}).admit("calculator", "x") is None


SCOPE = {"type": "http", "method": "POST", "path": SELECT, "headers": [], "client": ("127.0.0.1", 1)}

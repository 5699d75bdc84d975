"""Scripts of other origins: kept out, unless a setting names them."""

from tests.operations.conftest import MakeClient

ORIGIN = {"Origin": "https://plm.example"}
PREFLIGHT = {**ORIGIN, "Access-Control-Request-Method": "POST", "Access-Control-Request-Headers": "x-api-key"}


def test_no_other_origin_is_let_in_by_default(make_client: MakeClient) -> None:
    client = make_client()

    assert "Access-Control-Allow-Origin" not in client.get("/api/v1/catalogue", headers=ORIGIN).headers
    assert client.options("/api/v1/select", headers=PREFLIGHT).status_code == 405


def test_a_listed_origin_is_let_in_and_others_are_not(make_client: MakeClient) -> None:
    client = make_client(cors_origins="https://plm.example, https://erp.example")

    answer = client.get("/api/v1/catalogue", headers=ORIGIN)
    preflight = client.options("/api/v1/selections", headers=PREFLIGHT)
    stranger = client.get("/api/v1/catalogue", headers={"Origin": "https://else.example"})

    assert answer.headers["Access-Control-Allow-Origin"] == "https://plm.example"
    assert {"ETag", "Content-Disposition"} <= set(answer.headers["Access-Control-Expose-Headers"].split(", "))
    assert preflight.status_code == 200
    assert "Access-Control-Allow-Credentials" not in preflight.headers
    assert "Access-Control-Allow-Origin" not in stranger.headers


def test_a_refusal_can_be_read_by_the_listed_origin_too(make_client: MakeClient) -> None:
    client = make_client(cors_origins="https://plm.example", calculator_rate="1/minute")
    client.get("/api/v1/catalogue")

    refused = client.get("/api/v1/catalogue", headers=ORIGIN)

    assert refused.status_code == 429
    assert refused.headers["Access-Control-Allow-Origin"] == "https://plm.example"

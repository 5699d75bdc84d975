"""Names under which the service answers: links name no other."""

from io import BytesIO

import pikepdf
import pytest
from starlette.testclient import TestClient

from tests.operations.conftest import MakeClient
from tests.operations.service import Service

LINK = "/?T=40&n=250&t=1&i=5"
ALLOWED = "plm.example, *.erp.example, [2001:db8::1], 192.0.2.7"


def status(client: TestClient, host: str, path: str = "/api/v1/catalogue/HPN-20A-5") -> int:
    """Answer to a request for a host."""
    return client.get(path, headers={"Host": host}, follow_redirects=False).status_code


@pytest.mark.parametrize(
    "host",
    [
        "plm.example",
        "PLM.Example",
        "plm.example:8443",
        "a.erp.example",
        "[2001:db8::1]",
        "[2001:db8::1]:80",
        "192.0.2.7",
    ],
)
def test_a_permitted_host_is_answered_whatever_the_port(host: str, make_client: MakeClient) -> None:
    assert status(make_client(allowed_hosts=ALLOWED), host) == 200


@pytest.mark.parametrize(
    "host",
    [
        "evil.example",
        "plm.example.evil.example",
        "evilplm.example",
        "erp.example",
        "erp.example.",
        "[2001:db8::2]",
        "plm.example@evil.example",
        "evil.example/plm.example",
        "evil.example#plm.example",
        "[",
        "[::1",
        "a b",
        ":80",
        "",
        '"><script>',
        "plm.example:99999999",
        "plm.example, evil.example",
        "\xff",
    ],
)
def test_any_other_host_is_a_421(host: str, make_client: MakeClient) -> None:
    client = make_client(allowed_hosts=ALLOWED)

    answer = client.get(LINK, headers={b"Host": host.encode("latin-1")})

    assert answer.status_code == 421
    assert answer.headers["Content-Type"] == "application/problem+json"
    assert answer.json()["title"] == "Not the host of this service"
    assert "HPN_ALLOWED_HOSTS" in answer.json()["detail"]
    assert repr(host) in answer.json()["detail"] or not host.isascii()
    assert answer.headers["X-Request-ID"]


def test_load_balancers_ask_by_address(make_client: MakeClient) -> None:
    client = make_client(allowed_hosts=ALLOWED)

    assert [status(client, "10.1.2.3:8000", path) for path in ("/healthz", "/readyz", "/healthz/")] == [200, 200, 421]


LOCAL = ("localhost", "localhost:8000", "127.0.0.1", "127.0.0.1:80", "[::1]", "[::1]:8000")


def over_loopback(client: TestClient, host: str, path: str = "/") -> int:
    """Answer of a service to a request that came over loopback."""
    return client.get(f"http://127.0.0.1{path}", headers={"Host": host}, follow_redirects=False).status_code


def test_where_none_is_named_what_comes_over_loopback_is_for_this_machine_alone(make_client: MakeClient) -> None:
    """A page elsewhere reaches it by a name of its own that leads to 127.0.0.1, and could read and save."""
    client = make_client()

    assert {over_loopback(client, host) for host in LOCAL} == {200}
    assert {over_loopback(client, host) for host in ("evil.example", "localhost.evil.example", "0.0.0.0", "a")} == {421}
    assert {over_loopback(client, "evil.example", path) for path in ("/healthz", "/readyz")} == {200}


def test_over_loopback_a_trusted_proxy_may_ask_for_any_host_and_others_may_not(make_client: MakeClient) -> None:
    trusted, other = (make_client(trusted_proxies=proxies) for proxies in ("127.0.0.0/8", "10.0.0.0/8"))

    assert over_loopback(trusted, "plm.example") == 200
    assert over_loopback(other, "plm.example") == 421


def test_over_loopback_named_hosts_are_the_only_ones(make_client: MakeClient) -> None:
    client = make_client(allowed_hosts=ALLOWED)

    assert [over_loopback(client, host) for host in ("plm.example", "localhost")] == [200, 421]


def test_a_service_on_this_machine_answers_for_it_alone(service: Service) -> None:
    answers = {host: service.client.get("/", headers={"Host": host}) for host in ("localhost", "evil.example")}

    assert {host: answer.status_code for host, answer in answers.items()} == {"localhost": 200, "evil.example": 421}
    assert "evil.example" in answers["evil.example"].json()["detail"]


def test_any_host_is_answered_where_none_is_named_and_a_wrong_one_stands_in_no_link(make_client: MakeClient) -> None:
    client = make_client()

    for host in ("anything.example", "[", '"><script>', "evil.example/x", "a b"):
        page = client.get("/catalogue", headers={"Host": host})
        assert page.status_code == 200
        assert ("anything.example/catalogue" in page.text) == (host == "anything.example")
        assert "evil.example" not in page.text
        assert "<script>" not in page.text


def test_links_name_a_permitted_host(make_client: MakeClient) -> None:
    client = make_client(allowed_hosts=ALLOWED)
    question = {"Host": "plm.example:8443"}

    canonical = client.get("/catalogue", headers=question).text
    report = client.get(f"/report.pdf{LINK.removeprefix('/')}", headers=question).content
    moved = client.get("/catalogue/", headers=question, follow_redirects=False).headers["Location"]

    assert '<link rel="canonical" href="http://plm.example:8443/catalogue"' in canonical
    assert moved == "http://plm.example:8443/catalogue"
    with pikepdf.open(BytesIO(report)) as opened:
        targets = {str(note["/A"]["/URI"]) for note in opened.pages[0]["/Annots"].as_list()}
    assert targets == {f"http://plm.example:8443{LINK}"}

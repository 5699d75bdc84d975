"""Saved selections over REST, with the store on each kind of database."""

import re

import orjson
import pytest
from starlette.testclient import TestClient

from hpn.catalogue import Catalogue
from tests.build import Json, answer, worked_example
from tests.conftest import Supplement
from tests.state import state_of
from tests.store.drafts import ADDRESS, WEAKER, draft, save


def test_saving_answers_with_the_place_and_the_place_with_what_was_saved(
    client: TestClient, catalogue: Catalogue
) -> None:
    application = worked_example(requirements={"ratios": [5]})

    response = client.post(ADDRESS, json={"application": application, "title": " Axis Ä ", "reference": "4711"})

    assert response.status_code == 201
    id = response.json()["id"]
    assert response.json() == {"id": id, "url": f"/selections/{id}"}
    assert response.headers["location"] == f"{ADDRESS}/{id}"
    saved = client.get(response.headers["location"]).json()
    assert (saved["title"], saved["reference"], saved["selected"]) == ("Axis Ä", "4711", "HPN-20A-5")
    assert saved["application"] == application
    assert saved["result"]["candidates"] == answer(application, catalogue)["candidates"]
    assert (saved["engine_version"], saved["catalogue_version"]) == (
        saved["result"]["engine_version"],
        saved["result"]["catalogue_version"],
    )
    assert saved["today"] | {"difference_count": 0, "differences": [], "problem": None} == saved["today"]


def test_the_saved_result_is_the_reply_of_select_byte_for_byte(client: TestClient) -> None:
    reply = client.post("/api/v1/select", json=worked_example()).content

    saved = client.get(f"{ADDRESS}/{save(client)}").content

    assert b'"result":' + reply + b',"label":"saved"' in saved


def test_the_application_comes_back_as_it_was_given(client: TestClient) -> None:
    document = {"duty_cycle": {"phases": [{"torque_Nm": -1e-3, "speed_rpm": 1, "duration_s": 5e2}]}, "rank_by": "life"}

    id = save(client, application=document)

    assert client.get(f"{ADDRESS}/{id}").json()["application"] == document


@pytest.mark.parametrize(
    ("change", "pointer"),
    [
        ({"application": {}}, "/application/duty_cycle"),
        ({"application": worked_example(requirements={"ratios": [6]})}, "/application/requirements/ratios/0"),
        ({"title": "x" * 201}, "/title"),
        ({"title": "a\0b"}, "/title"),
        ({"reference": "a\nb"}, "/reference"),
        ({"reference": "a\u202eb"}, "/reference"),
        ({"title": "a\uffffb"}, "/title"),
        ({"reference": 4711}, "/reference"),
        ({"owner": "me"}, "/owner"),
    ],
)
def test_an_application_that_can_not_be_saved_is_refused_with_its_place(
    client: TestClient, change: Json, pointer: str
) -> None:
    response = client.post(ADDRESS, json={"application": worked_example()} | change)

    assert response.status_code == 422
    assert response.json()["errors"][0]["pointer"] == pointer
    assert client.get(ADDRESS).json()["selections"] == []


def test_a_retry_with_its_key_is_answered_alike_and_saved_once(client: TestClient) -> None:
    first = save(client, {"Idempotency-Key": '"8e03978e-40d5-43dd-bc93-6894a57f9324"'}, title="t")
    again = save(client, {"Idempotency-Key": "8e03978e-40d5-43dd-bc93-6894a57f9324"}, title="t")

    assert first == again
    assert len(client.get(ADDRESS).json()["selections"]) == 1


def test_a_save_answers_with_the_tag_of_what_is_saved_and_a_replay_says_that_it_is_one(client: TestClient) -> None:
    body, key = {"application": worked_example(), "title": "t"}, {"Idempotency-Key": "k"}
    first, again = (client.post(ADDRESS, json=body, headers=key) for _ in range(2))
    address = first.headers["location"]

    assert first.headers["etag"] == again.headers["etag"] == client.get(address).headers["etag"]
    assert "idempotency-replayed" not in first.headers
    assert again.headers["idempotency-replayed"] == "true"

    renamed = client.patch(address, json={"title": "u"}, headers={"If-Match": first.headers["etag"]})
    late = client.post(ADDRESS, json=body, headers=key | {"Prefer": "return=representation"})
    assert late.headers["etag"] == renamed.headers["etag"] == client.get(address).headers["etag"]
    assert late.headers["etag"] != first.headers["etag"]
    assert client.delete(address, headers={"If-Match": first.headers["etag"]}).status_code == 412


def test_a_save_without_a_key_is_no_replay(client: TestClient) -> None:
    for _ in range(2):
        answer = client.post(ADDRESS, json={"application": worked_example()})
        assert "idempotency-replayed" not in answer.headers
        assert answer.headers["etag"] == client.get(answer.headers["location"]).headers["etag"]


def test_a_key_with_other_content_is_a_problem(client: TestClient) -> None:
    save(client, {"Idempotency-Key": "k"}, title="t")

    response = client.post(
        ADDRESS, json={"application": worked_example(), "title": "u"}, headers={"Idempotency-Key": "k"}
    )

    assert response.status_code == 422
    assert "used before" in response.json()["detail"]


def test_a_retry_of_what_was_deleted_is_a_problem_that_says_what_to_do(client: TestClient) -> None:
    body, headers = {"application": worked_example(), "title": "t"}, {"Idempotency-Key": "k"}
    client.delete(f"{ADDRESS}/{save(client, headers, title='t')}")

    response = client.post(ADDRESS, json=body, headers=headers)

    assert response.status_code == 410
    assert response.headers["content-type"] == "application/problem+json"
    assert "take a new key" in response.json()["detail"]
    assert client.get(ADDRESS).json()["selections"] == []
    assert client.post(ADDRESS, json=body, headers={"Idempotency-Key": "l"}).status_code == 201


def test_the_document_says_what_becomes_of_a_key(client: TestClient) -> None:
    operations = client.get("/openapi.json").json()["paths"][ADDRESS]["post"]

    key = next(entry for entry in operations["parameters"] if entry["name"] == "Idempotency-Key")
    assert "410" in key["description"]
    assert "410" in operations["responses"]


@pytest.mark.parametrize("key", ["", '""', "a b", "ä", "x" * 201])
def test_a_key_that_cannot_be_one_is_refused(client: TestClient, key: str) -> None:
    headers = {b"Idempotency-Key": key.encode()}

    response = client.post(ADDRESS, json={"application": worked_example()}, headers=headers)

    assert response.status_code == 400


def test_the_gear_of_a_saved_selection_is_the_one_of_its_designation(client: TestClient) -> None:
    """An ordering code names another gear than the first candidate."""
    body = {"application": worked_example(), "ordering_code": "HPN-20A-7-J6"}
    saved = client.get(client.post(ADDRESS, json=body).headers["location"]).json()

    assert saved["selected"] != "HPN-20A-7"
    assert saved["gear"]["designation"] == saved["designation"] == "HPN-20A-7"


def test_a_client_can_prefer_the_whole_and_always_gets_a_body(client: TestClient) -> None:
    """Generated clients read the body that the document promises."""
    body = {"application": worked_example()}

    minimal = client.post(ADDRESS, json=body, headers={"Prefer": "respond-async, return=minimal"})
    whole = client.post(ADDRESS, json=body, headers={"Prefer": 'return="representation"'})

    assert minimal.status_code == 201
    assert minimal.json()["url"].endswith(minimal.json()["id"])
    assert "preference-applied" not in minimal.headers
    assert client.get(minimal.headers["location"]).status_code == 200
    assert whole.status_code == 201
    assert whole.headers["preference-applied"] == "return=representation"
    assert whole.json() == client.get(whole.headers["location"]).json()


def test_a_selection_that_is_known_already_is_not_sent_again(client: TestClient) -> None:
    address = f"{ADDRESS}/{save(client)}"
    etag = client.get(address).headers["etag"]

    assert client.get(address, headers={"If-None-Match": f'"x", W/{etag}'}).status_code == 304
    assert client.get(address, headers={"If-None-Match": '"x"'}).status_code == 200


def test_todays_catalogue_is_compared_and_changes_the_tag_but_not_what_was_saved(
    client: TestClient, supplemented: Supplement
) -> None:
    address = f"{ADDRESS}/{save(client, application=worked_example(requirements={'ratios': [5]}))}"
    before = client.get(address)

    state_of(client).catalogue = supplemented(ratings=WEAKER)
    after = client.get(address, headers={"If-None-Match": before.headers["etag"]})

    assert after.status_code == 200
    assert after.headers["etag"] != before.headers["etag"]
    assert {**after.json(), "today": None} == {**before.json(), "today": None}
    differences = after.json()["today"]["differences"]
    assert (differences[0]["field"], differences[0]["saved"], differences[0]["today"]) == (
        "selected",
        "HPN-20A-5",
        "HPN-32A-5",
    )
    assert (
        differences[1] | {"pointer": "/candidates/0/status", "saved": "suitable", "today": "unsuitable"}
        == differences[1]
    )
    assert after.json()["today"]["difference_count"] == len(differences)


@pytest.mark.parametrize(
    ("requirements", "detail"), [({"sizes": ["99A"]}, "no 99A"), ({"colour": "red"}, "not a field of this object")]
)
def test_an_application_that_today_cannot_be_answered_is_still_shown(
    client: TestClient, catalogue: Catalogue, requirements: Json, detail: str
) -> None:
    result = orjson.dumps(answer(worked_example(), catalogue))
    application = orjson.dumps(worked_example(requirements=requirements))
    old = draft(application=application, result=result, engine_version="0.1", selected="HPN-99A-5")
    assert client.portal
    id = client.portal.call(state_of(client).store.save, old)

    saved = client.get(f"{ADDRESS}/{id}")
    page = client.get(f"/selections/{id}")

    assert saved.status_code == page.status_code == 200
    assert (saved.json()["selected"], saved.json()["engine_version"]) == ("HPN-99A-5", "0.1")
    assert detail in saved.json()["today"]["problem"]["detail"]
    assert "Today there is no result" in page.text


def test_a_list_goes_from_newest_to_oldest_by_links(client: TestClient) -> None:
    ids = [save(client, reference="a/b & c") for _ in range(5)]
    save(client, reference="other")

    listed: list[str] = []
    address: str | None = f"{ADDRESS}?reference=a%2Fb+%26+c&limit=2"
    while address:
        response = client.get(address)
        listed += [entry["id"] for entry in response.json()["selections"]]
        link = re.fullmatch(r'<(.+)>; rel="next"', response.headers.get("link", ""))
        address = link[1] if link else None

    assert listed == ids[::-1]


@pytest.mark.parametrize("query", ["limit=0", "limit=201", "limit=x", "cursor=x", "cursor=%00", "reference=%00"])
def test_a_list_that_cannot_be_is_refused(client: TestClient, query: str) -> None:
    response = client.get(f"{ADDRESS}?{query}")

    assert response.status_code == 422
    assert response.json()["errors"][0]["pointer"] == "/" + query.partition("=")[0]


def test_deleting_asks_for_the_state_that_is_meant(client: TestClient) -> None:
    address = f"{ADDRESS}/{save(client)}"

    assert client.delete(address, headers={"If-Match": '"other"'}).status_code == 412
    assert client.delete(address, headers={"If-Match": client.get(address).headers["etag"]}).status_code == 204
    assert client.get(address).status_code == 404
    assert client.delete(address).status_code == 404


@pytest.mark.parametrize("id", ["x", "A" * 22, "%00", "..%2f..%2fetc"])
def test_a_selection_that_is_not_there_is_not_found(client: TestClient, id: str) -> None:
    assert client.get(f"{ADDRESS}/{id}").status_code == 404
    assert client.get(f"/selections/{id}").status_code == 404


def test_ready_means_that_the_store_answers(client: TestClient) -> None:
    assert client.get("/readyz").json()["store"] == "ok"

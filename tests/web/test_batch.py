"""`POST /api/v1/select/batch`: one line per item; a faulty item affects no other."""

from typing import Any

import orjson
import pytest
from starlette.testclient import TestClient

from hpn.web.api import batch
from hpn.web.app import create_app
from hpn.web.settings import Settings
from tests.build import Json, cycle, phase, suitable, worked_example

PATH = "/api/v1/select/batch"
GOOD = worked_example(requirements={"ratios": [5]})
HEAVY = cycle(phase(9000, 100))


def send(api: TestClient, *items: Any) -> list[dict[str, Any]]:
    reply = api.post(PATH, json={"applications": list(items)})
    assert reply.status_code == 200
    results: list[dict[str, Any]] = reply.json()["results"]
    return results


def test_a_line_says_what_select_says(api: TestClient) -> None:
    single = api.post("/api/v1/select", json=GOOD).json()
    [line] = send(api, GOOD | {"reference": "axis-7"})

    best = single["candidates"][0]
    assert line == {
        "reference": "axis-7",
        "status": "ok",
        "selected": "HPN-20A-5",
        "governing_check": best["governing_check"],
        "utilisation": best["utilisation"],
        "suitable": len(suitable(single)),
        "link": single["link"],
    }


def test_an_application_that_no_gear_fits_is_ok_with_nothing_selected(api: TestClient) -> None:
    [line] = send(api, HEAVY)

    assert line["reference"] is None
    assert (line["status"], line["selected"], line["suitable"]) == ("ok", None, 0)
    assert (line["governing_check"], line["utilisation"]) == (None, None)
    assert line["link"].startswith("/?T=9000")


def test_a_bad_item_never_fails_its_neighbours_and_results_keep_their_order(api: TestClient) -> None:
    items: list[Any] = [
        GOOD | {"reference": "first"},
        {"reference": "no phases"},
        GOOD | {"reference": "wrong ratio", "requirements": {"ratios": [6]}},
        5,
        None,
        "text",
        [],
        GOOD | {"reference": 7},
        GOOD | {"reference": "x" * 201},
        GOOD | {"reference": "unknown field", "price": 1},
        HEAVY | {"reference": "first"},
        cycle(phase(1, 1), output_load={"radial_N": 1, "model": "digitised"}),
        GOOD,
    ]
    lines = send(api, *items)

    assert [line["status"] for line in lines] == ["ok", *["error"] * 9, "ok", "error", "ok"]
    assert [line["reference"] for line in lines[:3]] == ["first", "no phases", "wrong ratio"]
    pointers = [
        [e["pointer"] for e in line["problem"].get("errors", ())] for line in lines if line["status"] == "error"
    ]
    assert pointers[0] == ["/duty_cycle"]
    assert pointers[1] == ["/requirements/ratios/0"]
    assert pointers[6] == ["/reference"]
    assert pointers[7] == ["/reference"]
    assert pointers[8] == ["/price"]
    assert pointers[9] == ["/output_load/model"]
    for line in lines:
        if line["status"] == "error":
            assert set(line) == {"reference", "status", "problem"}
            assert line["problem"]["status"] == 422
            assert line["problem"]["detail"]
    assert lines[-1]["selected"] == "HPN-20A-5"


def test_items_of_many_kinds_are_each_answered_as_if_alone(api: TestClient) -> None:
    items: list[Json] = []
    for k in range(40):
        item = cycle(*[phase(5 + k, 100 + j, 0.5) for j in range(1 + k % 4)])
        if k % 2:
            item["emergency_stop"] = {"torque_Nm": 50 + k, "count": k}
        if k % 3 == 0:
            item["output_load"] = {"radial_N": 10 * k, "model": "iso281"}
        if k % 5 == 0:
            item["requirements"] = {"sizes": ["20A", "32A"], "life_h": 1000}
        items.append(item)
    lines = send(api, *items)

    for item, line in zip(items, lines, strict=True):
        single = api.post("/api/v1/select", json=item).json()
        assert line["selected"] == single["selected"]
        assert line["suitable"] == len(suitable(single))
        assert line["link"] == single["link"]
        if line["selected"]:
            # padded sums may have another order
            assert line["utilisation"] == pytest.approx(single["candidates"][0]["utilisation"], rel=1e-13)


def test_no_application_at_all_gives_no_results(api: TestClient) -> None:
    assert send(api) == []


@pytest.mark.parametrize(
    "body",
    [{}, [], 5, [[[]]], {"applications": {}}, {"applications": None}, {"items": []}],
)
def test_another_shape_is_refused_with_the_right_one(api: TestClient, body: Any) -> None:
    reply = api.post(PATH, json=body)

    assert reply.status_code == 422
    assert reply.headers["content-type"] == "application/problem+json"
    assert [error["pointer"] for error in reply.json()["errors"]] == ["/applications"]


@pytest.mark.parametrize(
    "content", [b"", b"{", b"\xff", b'{"applications": [nan]}', b'{"applications": [' + b"[" * 100_000]
)
def test_a_body_that_is_no_json_is_a_400(api: TestClient, content: bytes) -> None:
    reply = api.post(PATH, content=content, headers={"content-type": "application/json"})

    assert reply.status_code == 400
    assert reply.headers["content-type"] == "application/problem+json"


def test_what_is_no_json_is_named_by_its_byte(api: TestClient) -> None:
    good = orjson.dumps(worked_example())
    begin = b'{"applications": [' + b",".join([good] * 700)
    reply = api.post(PATH, content=begin + b', {"duty_cycle" 1}]}', headers={"content-type": "application/json"})

    place = len(begin) + len(b', {"duty_cycle" ')
    assert reply.status_code == 400
    assert reply.json()["detail"] == f"the body is not JSON: JSON is malformed: expected ':' (byte {place})"


def test_a_text_that_is_no_utf_8_is_a_mistake_of_its_item_alone(api: TestClient) -> None:
    good = orjson.dumps(GOOD)
    content = b'{"applications": [' + good.replace(b"{", b'{"reference":"\xff",', 1) + b"," + good + b"]}"
    results = api.post(PATH, content=content, headers={"content-type": "application/json"}).json()["results"]

    assert [result["status"] for result in results] == ["error", "ok"]
    assert results[0]["problem"]["status"] == 400


def test_an_item_that_is_too_large_hurts_nobody() -> None:
    client = TestClient(create_app(Settings(maximum_body_bytes=2000)))
    large = GOOD | {"reference": "x" * 3000}
    results = client.post(PATH, json={"applications": [large, GOOD]}).json()["results"]

    assert [result["status"] for result in results] == ["error", "ok"]
    assert results[0]["problem"]["status"] == 413


def test_many_names_beside_the_applications_are_refused_without_being_listed(api: TestClient) -> None:
    content = b'{"applications": [],' + b",".join(b'"k%d":1' % number for number in range(100_000)) + b"}"
    reply = api.post(PATH, content=content, headers={"content-type": "application/json"})

    assert (reply.status_code, "errors" in reply.json()) == (422, False)


def test_numbers_that_are_too_large_for_json_readers_are_an_error_of_their_item(api: TestClient) -> None:
    huge = b'{"duty_cycle": {"phases": [{"torque_Nm": ' + b"9" * 400 + b', "speed_rpm": 1, "duration_s": 1}]}}'
    content = b'{"applications": [' + huge + b", " + orjson.dumps(GOOD) + b"]}"

    reply = api.post(PATH, content=content, headers={"content-type": "application/json"})

    assert reply.status_code in (200, 400)  # never a 500, never a wrong result
    if reply.status_code == 200:
        assert [line["status"] for line in reply.json()["results"]] == ["error", "ok"]


@pytest.mark.parametrize("kind", ["application/json", "application/x-ndjson"])
def test_a_name_twice_is_a_mistake_of_its_item_alone_and_colons_in_texts_are_none(api: TestClient, kind: str) -> None:
    good = [orjson.dumps(GOOD | {"reference": text}) for text in ("a:b", "c:\\d", "ü")]
    items = [
        *good,
        good[0].replace(b'"ratios":[5]', b'"ratios":[7],"ratios":[5]'),
        rb'{"reference":"\u003a",' + good[0][1:],
    ]
    lines = kind.endswith("ndjson")
    content = b"\n".join(items) if lines else b'{"applications":[%s]}' % b",".join(items)

    reply = api.post(PATH, content=content, headers={"content-type": kind})

    results = [orjson.loads(line) for line in reply.content.splitlines()] if lines else reply.json()["results"]
    assert [result["status"] for result in results] == ["ok", "ok", "ok", "error", "error"]
    assert ["'ratios' 2 times" in results[3]["problem"]["detail"], results[3]["problem"]["status"]] == [True, 422]
    assert "'reference' 2 times" in results[4]["problem"]["detail"]


@pytest.mark.parametrize("first", ["[]", "[5, {}]"])
def test_two_lists_of_applications_are_refused(api: TestClient, first: str) -> None:
    content = f'{{"applications": {first}, "applications": []}}'

    reply = api.post(PATH, content=content, headers={"content-type": "application/json"})

    assert reply.status_code == 422
    assert reply.json()["errors"] == [{"pointer": "/applications", "code": "invalid", "detail": "is there twice"}]


def test_ten_thousand_applications_are_answered_and_one_more_is_refused(api: TestClient) -> None:
    item = cycle(phase(10, 100), requirements={"ratios": [5], "sizes": ["14A"]})
    lines = send(api, *[item] * 10_000)
    assert len(lines) == 10_000
    assert {line["selected"] for line in lines} == {"HPN-14A-5"}

    reply = api.post(PATH, json={"applications": [item] * 10_001})
    assert reply.status_code == 413
    assert "10000" in reply.json()["detail"]


def test_a_lower_count_can_be_set_and_a_higher_one_cannot() -> None:
    client = TestClient(create_app(Settings(maximum_batch_count=2)))
    assert client.post(PATH, json={"applications": [GOOD] * 2}).status_code == 200
    assert client.post(PATH, json={"applications": [GOOD] * 3}).status_code == 413
    with pytest.raises(ValueError, match="maximum_batch_count"):
        Settings(maximum_batch_count=10_001)


def test_a_batch_whose_slices_end_early_answers_the_same(api: TestClient, monkeypatch: pytest.MonkeyPatch) -> None:
    body = {"applications": [worked_example(requirements={"ratios": [ratio]}) for ratio in (5, 6, 7, 10)]}
    whole = api.post(PATH, json=body).content
    monkeypatch.setattr(batch, "SLICE_SECONDS", 0)

    assert api.post(PATH, json=body).content == whole


def test_a_batch_that_takes_too_long_is_a_503_that_says_what_to_do() -> None:
    client = TestClient(create_app(Settings(batch_seconds=1e-9)))

    reply = client.post(PATH, json={"applications": [GOOD]})

    assert reply.status_code == 503
    assert reply.headers["retry-after"].isdigit()
    assert "fewer" in reply.json()["detail"]


NUMBERS = {"infinite": "1e999", "literal": "NaN", "other literal": "-Infinity", "endless": "9" * 400}


@pytest.mark.parametrize("number", NUMBERS.values(), ids=list(NUMBERS))
def test_a_number_that_is_none_is_a_mistake_of_its_item_alone(api: TestClient, number: str) -> None:
    bad = orjson.dumps(worked_example()).decode().replace("40", number, 1)
    good = orjson.dumps(GOOD | {"reference": 'NaN, \\"NaN'}).decode()

    whole = api.post(PATH, content=f'{{"applications": [{bad}, {good}]}}', headers={"content-type": "application/json"})
    lines = api.post(PATH, content=f"{bad}\n{good}\n", headers={"content-type": "application/x-ndjson"})

    for results in (whole.json()["results"], [orjson.loads(line) for line in lines.text.splitlines()]):
        assert [line["status"] for line in results] == ["error", "ok"]
        assert results[1]["reference"] == 'NaN, \\"NaN'
        assert results[0]["problem"]["errors"][0]["pointer"] == "/duty_cycle/phases/0/torque_Nm"


def test_items_that_are_no_object_and_names_of_no_field_are_told_so(api: TestClient) -> None:
    [line] = send(api, 5)
    unknown = api.post(PATH, json={"applications": [], "foo": 1})

    assert line["problem"]["detail"] == "must be an object"
    assert unknown.json()["errors"] == [
        {"pointer": "/foo", "code": "invalid", "detail": "is not a field of this object"}
    ]


TWICE = b'"rank_by":"x","rank_by":"y"'
PHASES = b'"duty_cycle":{"phases":[{"torque_Nm":40,"speed_rpm":250,"duration_s":0.3}]}'


@pytest.mark.parametrize(
    "text",
    [
        b"{%s,%s}" % (PHASES, TWICE),
        b'{"duty_cycle":{},%s}' % TWICE.replace(b"x", b"life").replace(b"y", b"weight"),
        b'{%s,"requirements":{"ratios":[6],"life_h":-1}}' % PHASES,
        b'{%s,"requirements":{"ratios":[6],"sizes":["99A"]}}' % PHASES,
        b'{%s,"output_load":{"life_h":3}}' % PHASES,
        b'{%s,"unknown":1}' % PHASES,
        b"[]",
        b"7",
    ],
)
def test_an_item_is_refused_as_select_refuses_it(api: TestClient, text: bytes) -> None:
    as_json = {"Content-Type": "application/json"}
    alone = api.post("/api/v1/select", content=text, headers=as_json).json()
    item = api.post(PATH, content=b'{"applications":[%s]}' % text, headers=as_json).json()["results"][0]["problem"]
    line = api.post(PATH, content=text + b"\n", headers={"Content-Type": "application/x-ndjson"}).json()["problem"]

    assert item == alone
    assert line | {"detail": line["detail"].removeprefix("line 1: ")} == alone

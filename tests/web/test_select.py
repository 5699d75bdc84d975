"""`POST /api/v1/select` over HTTP: the contract's shape, and problems with pointers to the faults."""

import json
import math
import re
import time
from collections.abc import Iterator
from typing import Any

import orjson
import pytest
from starlette.testclient import TestClient

from hpn import ENGINE_VERSION
from hpn.application import Application
from hpn.catalogue import load_catalogue
from hpn.engine.selection import select
from tests.build import Json, candidate, check, cycle, phase, worked_example

PATH = "/api/v1/select"
EXAMPLE = worked_example(requirements={"ratios": [5]})


def refused(api: TestClient, application: Any, status: int = 422) -> dict[str, str]:
    """Details of a refusal's errors by pointer."""
    reply = api.post(PATH, json=application)
    assert reply.status_code == status
    assert reply.headers["content-type"] == "application/problem+json"
    body = reply.json()
    assert body["status"] == status
    assert body["type"] and body["title"] and body["detail"]
    return {error["pointer"]: error["detail"] for error in body.get("errors", ())}


def test_the_worked_example_comes_back_as_the_contract_shows_it(api: TestClient) -> None:
    reply = api.post(PATH, json=EXAMPLE)

    assert reply.status_code == 200
    assert reply.headers["content-type"] == "application/json"
    body = reply.json()
    assert list(body) == [
        "engine_version",
        "catalogue_version",
        "link",
        "duty",
        "selected",
        "candidates",
        "check_definitions",
        "notices",
    ]
    assert body["engine_version"] == ENGINE_VERSION
    assert body["link"] == "/?T=40&n=250&t=0.3&T=32&n=500&t=3&T=20&n=250&t=0.4&tp=4&Tk=200&i=5"
    assert body["selected"] == "HPN-20A-5"
    first = body["candidates"][0]
    for name, value in {
        "designation": "HPN-20A-5",
        "size": "20A",
        "ratio": 5,
        "stages": 1,
        "status": "suitable",
        "rank": 1,
        "utilisation": 0.78125,
        "governing_check": "momentary_peak_torque",
        "maximum_input_speed_rpm": 2500,
        "momentary_peak_count": 3066035,
        "bearing_life_L50_h": None,
        "bearing_life_L10_h": None,
    }.items():
        assert first[name] == value, name
    assert first["average_input_speed_rpm"] == pytest.approx(1087.66, abs=0.005)  # as the contract rounds it
    assert first["life_L10_h"] == pytest.approx(1167275.9, abs=0.05)
    average = check(body, "HPN-20A-5", "average_torque")
    assert average["limit"] == 80
    assert average["status"] == "pass"
    assert average["demand"] == body["duty"]["average_torque_Nm"]
    assert average["utilisation"] == average["demand"] / 80


def test_the_contract_s_own_example_of_a_bearing_life_comes_out(api: TestClient) -> None:
    """Radial 500 N, axial 200 N, f_w = 1.2 on HPN-20A: 106167 h as L50 and 21233 h as L10, rounded in the contract."""
    load = {"radial_N": 500, "axial_N": 200, "load_coefficient": 1.2, "life_h": 20000, "life_basis": "L50"}

    body = api.post(PATH, json=EXAMPLE | {"output_load": load}).json()

    assert round(candidate(body, "HPN-20A-5")["bearing_life_L50_h"]) == 106167
    assert round(candidate(body, "HPN-20A-5")["bearing_life_L10_h"]) == 21233


def test_numbers_keep_their_full_precision_on_the_wire(api: TestClient) -> None:
    selection = select(Application.model_validate(EXAMPLE), load_catalogue())
    body = api.post(PATH, json=EXAMPLE).json()

    assert body["duty"]["average_torque_Nm"] == selection.duty.average_torque_Nm


def test_neither_nan_nor_infinity_ever_appears(api: TestClient) -> None:
    hard = cycle(phase(0, 100, radial_N=0.0), emergency_stop={"torque_Nm": 9e5, "count": 0}, requirements={"life_h": 1})
    text = api.post(PATH, json=hard).text

    assert "NaN" not in text and "Infinity" not in text and "inf" not in text.replace("inform", "")
    assert all(math.isfinite(number) for number in numbers(orjson.loads(text)))
    count = check(orjson.loads(text), "HPN-20A-5", "momentary_peak_count")
    assert (count["limit"], count["utilisation"], count["status"]) == (0, None, "fail")


def numbers(value: Any) -> Iterator[float]:
    if isinstance(value, dict):
        value = list(value.values())
    if isinstance(value, list):
        for entry in value:
            yield from numbers(entry)
    elif isinstance(value, int | float):
        yield value


def test_whole_numbers_are_as_good_as_decimals(api: TestClient) -> None:
    whole = {"duty_cycle": {"phases": [{"torque_Nm": 40, "speed_rpm": 250, "duration_s": 1}]}}
    decimal = {"duty_cycle": {"phases": [{"torque_Nm": 40.0, "speed_rpm": 250.0, "duration_s": 1.0}]}}

    assert api.post(PATH, json=whole).content == api.post(PATH, json=decimal).content


@pytest.mark.parametrize(
    ("application", "pointer"),
    [
        ({}, "/duty_cycle"),
        ({"duty_cycle": {"phases": []}}, "/duty_cycle/phases"),
        (cycle(phase(1, 0)), "/duty_cycle/phases"),
        (cycle(phase(1, 1) | {"torque_Nm": "40"}), "/duty_cycle/phases/0/torque_Nm"),
        (cycle(phase(1, 1), phase(1, 1, 0)), "/duty_cycle/phases/1/duration_s"),
        (cycle(phase(1, 1) | {"torque": 4}), "/duty_cycle/phases/0/torque"),
        (cycle(phase(1, 1), pause_s=-1), "/duty_cycle/pause_s"),
        (cycle(phase(1, 1), emergency_stop={"count": 5}), "/emergency_stop/torque_Nm"),
        (cycle(phase(1, 1), output_load={}), "/output_load"),
        (cycle(phase(1, 1), output_load={"radial_N": 1, "model": "digitised"}), "/output_load/model"),
        (cycle(phase(1, 1), requirements={"ratios": [5, 6]}), "/requirements/ratios/1"),
        (cycle(phase(1, 1), requirements={"sizes": ["15A"]}), "/requirements/sizes/0"),
        (cycle(phase(1, 1), requirements={"sizes": ["11A"], "ratios": [3]}), "/requirements/ratios"),
        (cycle(phase(1, 1), requirements={"efficiency": 1.5}), "/requirements/efficiency"),
        (cycle(phase(1, 1), requirements={"noise_dB": 40}), "/requirements/noise_dB"),
        (cycle(phase(1, 1), **{"a/b~c": 1}), "/a~1b~0c"),
        (cycle(phase(1, 1), rank_by="price"), "/rank_by"),
        (cycle(phase(1, 1), application_area="space"), "/application_area"),
    ],
)
def test_a_mistake_is_a_problem_that_points_at_it(api: TestClient, application: Json, pointer: str) -> None:
    assert list(refused(api, application)) == [pointer]


def test_a_list_that_is_none_is_told_so_in_the_words_of_json(api: TestClient) -> None:
    refusal = refused(api, cycle(phase(1, 1), requirements={"ratios": 5}))

    assert refusal == {"/requirements/ratios": "must be a list"}


def test_several_mistakes_are_reported_at_once(api: TestClient) -> None:
    refusal = refused(api, cycle(phase(1, 1) | {"torque_Nm": None}, phase(1, 1, -1), rank_by="price"))

    assert set(refusal) == {"/duty_cycle/phases/0/torque_Nm", "/duty_cycle/phases/1/duration_s", "/rank_by"}


def test_of_very_many_mistakes_the_first_20_are_named_and_the_others_counted(api: TestClient) -> None:
    reply = api.post(PATH, json=cycle(*[phase(1, 1, -1)] * 100)).json()

    assert [error["pointer"] for error in reply["errors"]] == [f"/duty_cycle/phases/{k}/duration_s" for k in range(20)]
    assert "100 errors were found" in reply["detail"]


def test_a_mistake_late_in_a_long_cycle_is_told_at_its_place(api: TestClient) -> None:
    refusal = refused(api, cycle(*[phase(1, 1)] * 9_998, phase(1, 1, -1)))

    assert set(refusal) == {"/duty_cycle/phases/9998/duration_s"}


@pytest.mark.parametrize("body", [[], "text", 5, True])
def test_json_that_is_no_object_is_a_422(api: TestClient, body: Any) -> None:
    reply = api.post(PATH, json=body)

    assert reply.status_code == 422
    assert reply.headers["content-type"] == "application/problem+json"


@pytest.mark.parametrize(
    "content",
    [
        b"",
        b"{",
        b"null",
        b'{"duty_cycle": NaN}',
        b"\xff\xfe\x00",
        b'{"duty_cycle": {"phases": [{"torque_Nm": 1e400, "speed_rpm": 1, "duration_s": 1}]}}',
        b'{"duty_cycle": {"phases": [{"torque_Nm": NaN, "speed_rpm": 1, "duration_s": 1}]}}',
        b'{"duty_cycle": {"phases": [{"torque_Nm": Infinity, "speed_rpm": 1, "duration_s": 1}]}}',
        b'{"duty_cycle": {"phases": [{"torque_Nm": ' + b"9" * 400 + b', "speed_rpm": 1, "duration_s": 1}]}}',
        b'{"\\ud800": 1}',
        b"[" * 100_000,
        b'{"duty_cycle":' * 5000 + b"1" + b"}" * 5000,
    ],
)
def test_a_body_that_is_no_json_or_has_no_finite_number_is_a_4xx(api: TestClient, content: bytes) -> None:
    reply = api.post(PATH, content=content, headers={"content-type": "application/json"})

    assert reply.status_code in (400, 422)
    assert reply.headers["content-type"] == "application/problem+json"
    assert reply.json()["detail"]


@pytest.mark.parametrize("path", ["/api/v1/select", "/api/v1/select/batch", "/api/v1/report.pdf", "/api/v1/selections"])
def test_a_byte_order_mark_before_json_is_dropped(api: TestClient, path: str) -> None:
    whole = {"/api/v1/select/batch": {"applications": [EXAMPLE]}, "/api/v1/selections": {"application": EXAMPLE}}
    content, headers = orjson.dumps(whole.get(path, EXAMPLE)), {"content-type": "application/json"}

    plain, marked, twice = (
        api.post(path, content=b"\xef\xbb\xbf" * marks + content, headers=headers) for marks in range(3)
    )

    assert (plain.status_code, plain.headers["content-type"]) == (marked.status_code, marked.headers["content-type"])
    assert marked.status_code in (200, 201)
    assert twice.status_code == 400


TWICE = {
    "at the top": ('"duty_cycle": ', '"duty_cycle": 5, "duty_cycle": ', "duty_cycle"),
    "below": ('"phases": ', '"phases": [], "phases": ', "phases"),
    "in a phase": ('"torque_Nm": 40', '"torque_Nm": 4, "torque_Nm": 40', "torque_Nm"),
    "the same value": ('"torque_Nm": 40', '"torque_Nm": 40, "torque_Nm": 40', "torque_Nm"),
    "escaped": ('"torque_Nm": 40', '"torque\\u005fNm": 4, "torque_Nm": 40', "torque_Nm"),
    "a long integer": ('"torque_Nm": 40', f'"torque_Nm": {"9" * 400}, "torque_Nm": 40', "torque_Nm"),
    "beside an escaped colon": ('"torque_Nm": 40', '"torque_Nm": "\\u003A:", "torque_Nm": 40', "torque_Nm"),
}


@pytest.mark.parametrize(("once", "twice", "name"), TWICE.values(), ids=TWICE)
def test_a_name_twice_in_one_object_is_refused_by_name(api: TestClient, once: str, twice: str, name: str) -> None:
    text = json.dumps(worked_example())
    assert once in text

    reply = api.post(PATH, content=text.replace(once, twice, 1), headers={"content-type": "application/json"})

    assert reply.status_code == 422
    assert reply.json()["detail"] == f"contains the name '{name}' 2 times in one object"


def test_many_names_twice_are_refused_at_once(api: TestClient) -> None:
    content = b'{"a":1' + b',"a":1' * 150_000 + b"}"
    start = time.perf_counter()

    reply = api.post(PATH, content=content, headers={"content-type": "application/json"})

    assert reply.status_code == 422
    assert time.perf_counter() - start < 1  # takes 0.01 s, for counting colons instead of parsing


def test_ten_thousand_phases_are_answered_and_one_more_is_refused(api: TestClient) -> None:
    one = api.post(PATH, json=cycle(phase(10, 100, 10_000.0))).json()
    many = api.post(PATH, json=cycle(*[phase(10, 100)] * 10_000))

    assert many.status_code == 200
    for gear, split in zip(one["candidates"], many.json()["candidates"], strict=True):
        assert gear["designation"] == split["designation"]
        # splitting a constant load only changes the rounding of a sum of ten thousand terms
        expected = gear["utilisation"] and pytest.approx(gear["utilisation"], rel=1e-11)
        assert split["utilisation"] == expected
    refusal = refused(api, cycle(*[phase(10, 100)] * 10_001))
    assert list(refusal) == ["/duty_cycle/phases"]
    assert "10000" in refusal["/duty_cycle/phases"]


def test_other_methods_and_content_types_are_refused_as_problems(api: TestClient) -> None:
    for method in ("GET", "PUT", "DELETE", "PATCH"):
        reply = api.request(method, PATH)
        assert reply.status_code == 405
        assert reply.headers["content-type"] == "application/problem+json"
        assert "POST" in reply.headers["allow"]
    for kind in ("text/plain", "application/x-www-form-urlencoded", "application/jsonx", ""):
        reply = api.post(PATH, content=b"{}", headers={"content-type": kind})
        assert reply.status_code == 415
        assert reply.json()["status"] == 415
    charset = {"content-type": "Application/JSON; charset=utf-8"}
    assert api.post(PATH, content=orjson.dumps(EXAMPLE), headers=charset).status_code == 200


def test_a_path_that_is_not_there_is_a_404_problem(api: TestClient) -> None:
    for path in ("/api/v1/selekt", "/api/v2/select", "/api", "/nowhere"):
        reply = api.get(path)
        assert reply.status_code == 404
        assert reply.headers["content-type"] == "application/problem+json"
        assert path in reply.json()["detail"]


def test_no_answer_is_to_be_taken_for_what_it_is_not(api: TestClient) -> None:
    for reply in (
        api.get("/healthz"),
        api.post(PATH, json=EXAMPLE),
        api.post(PATH, json={}),
        api.get("/nowhere"),
        api.get("/api/v1/catalogue"),
        api.get("/openapi.json"),
        api.get("/"),
    ):
        assert reply.headers["x-content-type-options"] == "nosniff"


def test_every_answer_keeps_to_its_own_host(api: TestClient) -> None:
    page, kinds = api.get("/"), set()
    assets = {asset.rpartition(".")[2]: asset for asset in re.findall(r'"(/static/[^"]+)"', page.text)}
    for reply in (
        page,
        api.get(assets["js"]),
        api.get(assets["svg"]),
        api.post("/api/v1/report.pdf", json=EXAMPLE),
        api.get("/metrics"),
        api.post(PATH, json=EXAMPLE),
        api.post(PATH, json={}),
        api.get("/nowhere"),
    ):
        kinds.add(reply.headers["content-type"].partition(";")[0])
        policy = reply.headers["content-security-policy"]
        assert "default-src 'self'" in policy
        assert "script-src" not in policy or "unsafe" not in policy.split("script-src")[1].split(";")[0]
        assert "frame-ancestors 'none'" in policy
        assert reply.headers["referrer-policy"]
    output = {"text/html", "text/javascript", "image/svg+xml", "application/pdf", "text/plain"}
    assert kinds == output | {"application/json", "application/problem+json"}


def test_the_same_question_gets_the_same_bytes(api: TestClient) -> None:
    assert len({api.post(PATH, json=EXAMPLE).content for _ in range(3)}) == 1


def test_the_link_of_a_reply_leads_to_a_page_and_back_to_the_same_link(api: TestClient) -> None:
    body = api.post(PATH, json=EXAMPLE | {"output_load": {"radial_N": 1e-7, "axial_N": -2.5}}).json()

    assert api.get(body["link"]).status_code == 200


# --- A part of the reply ----------------------------------------------------------------------------------------------


def test_the_best_candidates_and_some_fields_are_those_of_the_whole_reply(api: TestClient) -> None:
    whole = api.post(PATH, json=worked_example()).json()

    def part(query: str) -> Any:
        return api.post(f"{PATH}?{query}", json=worked_example()).raise_for_status().json()

    assert part("top=3") == whole | {"candidates": whole["candidates"][:3]}
    assert part("top=1000") == part("fields=" + ",".join(whole)) == whole
    assert part("fields=selected, link") == {"selected": whole["selected"], "link": whole["link"]}
    assert part("top=2&fields=duty,candidates.designation,candidates.checks") == {
        "duty": whole["duty"],
        "candidates": [{name: one[name] for name in ("designation", "checks")} for one in whole["candidates"][:2]],
    }
    assert part("top=1&fields=candidates,candidates.size") == {"candidates": whole["candidates"][:1]}
    # Only tolerances give this field; without any a reply lacks it, even if it is requested.
    assert part("fields=tolerance,selected") == {"selected": whole["selected"]}


@pytest.mark.parametrize(
    ("query", "pointer"),
    [
        *(("top=0", "/top"), ("top=1001", "/top"), ("top=x", "/top"), ("top=1&top=2", "/top"), ("fields=", "/fields")),
        *(("fields=nothing", "/fields"), ("fields=selected,candidates.nothing", "/fields")),
        *(("fields=axes.name", "/fields"), ("fields=candidates.", "/fields"), ("fields=" + "a" * 1001, "/fields")),
    ],
)
def test_a_part_that_there_is_none_of_is_refused_by_its_parameter(api: TestClient, query: str, pointer: str) -> None:
    reply = api.post(f"{PATH}?{query}", json=EXAMPLE)

    assert reply.status_code == 422
    assert [error["pointer"] for error in reply.json()["errors"]] == [pointer]


@pytest.mark.parametrize(
    ("body", "detail"),
    [
        (b"", "the body is empty"),
        (b" \n", "the body is empty"),
        ('{"rank_by": "weight"}'.encode("utf-16"), "the body is not text in UTF-8"),
        (b"torque", "the body is not JSON: expected ident at line 1 column 2"),
    ],
)
def test_a_body_that_is_no_json_is_refused_with_the_reason(api: TestClient, body: bytes, detail: str) -> None:
    answer = api.post(PATH, content=body, headers={"Content-Type": "application/json"})

    assert (answer.status_code, answer.json()["detail"]) == (400, detail)


def test_a_boolean_is_asked_for_by_its_two_words(api: TestClient) -> None:
    application = {**worked_example(), "requirements": {"load_reverses": 1}}

    assert refused(api, application) == {"/requirements/load_reverses": "must be true or false"}

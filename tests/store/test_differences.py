"""Differences between two replies, field by field."""

import copy
from typing import Any

import pytest

from hpn.catalogue import Catalogue
from hpn.explain.comparison import TOLERANCE
from hpn.explain.differences import differences
from tests.build import Json, answer, worked_example


@pytest.fixture(scope="module")
def reply(catalogue: Catalogue) -> Json:
    """A reply with every candidate."""
    return answer(worked_example(), catalogue)


def changed(reply: Json) -> Json:
    """A copy to change."""
    return copy.deepcopy(reply)


def at(reply: Json, pointer: str) -> Any:
    """Value at a JSON pointer."""
    value: Any = reply
    for part in pointer.split("/")[1:]:
        value = value[int(part)] if isinstance(value, list) else value[part]
    return value


def test_equal_replies_do_not_differ(reply: Json) -> None:
    assert differences(reply, changed(reply)) == []


def test_versions_alone_are_no_difference(reply: Json) -> None:
    assert differences(reply, reply | {"engine_version": "9", "catalogue_version": "x"}) == []


def test_the_order_of_the_candidates_alone_is_no_difference(reply: Json) -> None:
    today = changed(reply)
    today["candidates"].reverse()

    assert differences(reply, today) == []


def test_rounding_of_another_processor_is_no_difference(reply: Json) -> None:
    today = changed(reply)
    today["duty"]["average_torque_Nm"] *= 1 + TOLERANCE / 2

    assert differences(reply, today) == []


def test_a_figure_stands_with_both_values_and_a_pointer_to_the_saved_one(reply: Json) -> None:
    today = changed(reply)
    today["candidates"][3]["checks"][1]["limit"] = 12345.0
    today["candidates"].insert(0, today["candidates"].pop())

    (difference,) = differences(reply, today)

    assert difference.pointer == "/candidates/3/checks/1/limit"
    assert (difference.kind, difference.change, difference.field) == ("figure", "changed", "limit")
    assert difference.candidate == reply["candidates"][3]["designation"]
    assert difference.check == reply["candidates"][3]["checks"][1]["code"]
    assert (difference.saved, difference.today) == (at(reply, difference.pointer), 12345.0)


def test_verdicts_come_first_then_figures_then_texts(reply: Json) -> None:
    today = changed(reply)
    today["candidates"][0] |= {"reason": "new", "utilisation": 0.123, "status": "unsuitable", "rank": None}
    today["candidates"][0]["checks"][0]["status"] = "fail"
    today["selected"] = None

    result = differences(reply, today)

    assert [difference.field for difference in result] == [
        "selected",
        "status",
        "status",
        "rank",
        "utilisation",
        "reason",
    ]
    assert [difference.kind for difference in result] == ["verdict"] * 4 + ["figure", "text"]


def test_a_candidate_that_is_gone_is_one_difference(reply: Json) -> None:
    today = changed(reply)
    gone = today["candidates"].pop(2)

    (difference,) = differences(reply, today)

    assert (difference.pointer, difference.change) == ("/candidates/2/status", "removed")
    assert (difference.candidate, difference.saved, difference.today) == (gone["designation"], gone["status"], None)


def test_a_candidate_that_is_new_is_one_difference(reply: Json) -> None:
    today = changed(reply)
    today["candidates"].append(changed(today["candidates"][5]) | {"designation": "HPN-99A-5"})

    (difference,) = differences(reply, today)

    assert (difference.change, difference.candidate) == ("added", "HPN-99A-5")
    assert at(today, difference.pointer) == difference.today


def test_a_check_that_is_gone_is_one_difference(reply: Json) -> None:
    today = changed(reply)
    gone = today["candidates"][0]["checks"].pop(1)

    (difference,) = differences(reply, today)

    assert (difference.change, difference.check, difference.saved) == ("removed", gone["code"], gone["status"])


def test_a_notice_that_is_new_is_one_difference(reply: Json) -> None:
    today = changed(reply)
    today["notices"].append({"code": "new", "text": "Something to note."})

    (difference,) = differences(reply, today)

    assert (difference.kind, difference.change, difference.today) == ("text", "added", "Something to note.")


def test_a_field_that_todays_reply_lacks_is_named(reply: Json) -> None:
    today = changed(reply)
    del today["duty"]["maximum_torque_Nm"]

    (difference,) = differences(reply, today)

    assert (difference.pointer, difference.change) == ("/duty/maximum_torque_Nm", "removed")
    assert (difference.saved, difference.today) == (reply["duty"]["maximum_torque_Nm"], None)


def test_a_field_that_the_version_of_the_saved_reply_did_not_know_is_no_difference(reply: Json) -> None:
    older = changed(reply)
    del older["duty"]["maximum_torque_Nm"]
    for entry in older["candidates"]:
        del entry["wind_up_arcmin"], entry["reserve"]["brake_torque_Nm"]

    assert differences(older, reply) == []
    older["candidates"][0]["wind_up_arcmin"] = None
    assert {one.field for one in differences(older, reply)} == {"wind_up_arcmin"}


def test_a_pointer_is_escaped_as_the_standard_says() -> None:
    (difference,) = differences({"a/b~c": 1}, {"a/b~c": 2})

    assert difference.pointer == "/a~1b~0c"


def test_a_zero_beside_larger_numbers_of_its_list_is_no_difference(reply: Json) -> None:
    before, after = changed(reply), changed(reply)
    before["duty"]["phases"] = [{"torque_Nm": 46.2}, {"torque_Nm": -1.1e-16}]
    after["duty"]["phases"] = [{"torque_Nm": 46.2}, {"torque_Nm": 0.0}]

    assert differences(before, after) == []
    after["duty"]["phases"][1]["torque_Nm"] = 1e-9
    assert [one.pointer for one in differences(before, after)] == ["/duty/phases/1/torque_Nm"]


def test_a_verdict_that_differs_though_no_figure_does_is_the_tie_rules(reply: Json) -> None:
    today = changed(reply)
    first, second = today["candidates"][:2]
    first["rank"], second["rank"] = second["rank"], first["rank"]
    today["selected"] = second["designation"]

    result = differences(reply, today)

    assert {one.field for one in result} == {"selected", "rank"}
    assert {one.cause for one in result} == {"tie_rule"}
    today["duty"]["average_torque_Nm"] *= 1.01
    assert {one.cause for one in differences(reply, today)} == {None}

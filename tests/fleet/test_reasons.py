"""Reasons of rejected axes as sentences: read back from the answers, each has a German text with its values."""

import json
from typing import Any

import pytest

from hpn.web.pages.fleet_reasons import reasons_of
from hpn.words.reader import Reader
from tests.fleet.conftest import Size

SOUND: dict[str, Any] = {"torque_Nm": [40.0, 20.0], "speed_rpm": [250.0, 100.0], "duration_s": [0.5, 3.0]}
WRONG: tuple[dict[str, Any], ...] = (
    {"torque_Nm": None},
    {"speed_rpm": [250.0]},
    {"speed_rpm": [0.0, 0.0]},
    {"speed_rpm": "fast"},
    {"speed_rpm": [250.0, "fast"]},
    {"duration_s": [0.0, 3.0]},
    {"duration_s": [1e99, 3.0]},
    {"torque_Nm": [40.0, None]},
    {"pause_s": -1.0},
    {"pause_s": "long"},
    {"output_load.life_h": 20000.0},
    {"requirements.utilisation": 1.5},
    {"requirements.sizes": ["20A", "99A"]},
    {"requirements.sizes": "20A"},
    {"requirements.sizes": ["20A", 14]},
    {"requirements.ratios": [5, 6]},
    {"requirements.ratios": [3], "requirements.sizes": ["11A"]},
    {"requirements.ratios": [5] * 1001},
    {"requirements.motor.designation": "M 40"},
    {"requirements.motor.designation": "M 40", "requirements.motor.peak_torque_Nm": 5.0},
    {"requirements.motor.designation": ""},
    {"requirements.motor.designation": "M" * 101},
    {"requirements.motor.inertia_ratio": 5.0},
    {"rank_by": "colour"},
    {"rank_by": 3},
    {"output_load.radial_N": 100.0, "output_load.model": "digitised"},
    {"colour": "red"},
)
LINES = ('{"axis": "broken", "torque_Nm": [', '{"axis": 7, "torque_Nm": [1]}', json.dumps({"axis": "sound", **SOUND}))
TWICE = f'{{"axis": "twice", "pause_s": 1, {json.dumps(SOUND)[1:-1]}, "pause_s": 2}}'
CELLS = b"axis,torque_Nm,speed_rpm,duration_s\na,9,5,1\nb,9 5,5,1\nc,9,5\n,9,5,1\n\xff,9,5,1\nd,inf,5,1\n"


def test_every_reason_has_a_german_text(size: Size) -> None:
    rows = [json.dumps({"axis": str(place), **SOUND, **wrong}) for place, wrong in enumerate(WRONG)]

    answers = [*size("\n".join((json.dumps({"axis": "sound", **SOUND}), *rows, *LINES, TWICE))), *size(CELLS, ".csv")]

    assert [row["axis"] for row in answers if not row["error"]] == ["a"]
    for error in filter(None, (row["error"] for row in answers)):
        reasons = reasons_of(error)
        assert "; ".join(f"{column}: {reason.text}" for column, reason in reasons) == error
        for _, reason in reasons:
            assert Reader("de").told(reason) != reason.text


def test_a_quotation_in_a_reason_is_no_reason_of_its_own() -> None:
    (first, second) = reasons_of('n: phase 2: must be a number, such as 9.3, not "a: b"; duration_s: is required')

    assert [first[0], second[0]] == ["n", "duration_s"]
    assert Reader("de").told(first[1]) == 'Phase 2: muss eine Zahl sein, z. B. 9.3, nicht "a: b"'


def test_a_quoted_separator_is_written_closer(size: Size) -> None:
    (answer,) = size(json.dumps({"axis": "a", **SOUND, "speed_rpm": [250.0, "x; n: 5"]}))

    assert [column for column, _ in reasons_of(answer["error"])] == ["speed_rpm"]


@pytest.mark.parametrize("bad", [2**63, 10**300, -(2**63) - 1, 2.5, True, None])
def test_one_bad_axis_decides_nothing_for_the_others(bad: Any, size: Size) -> None:
    answers = size("\n".join(json.dumps({"axis": axis, **SOUND}) for axis in (bad, 1, 2, bad)))

    assert [row["axis"] for row in answers if not row["error"]] == [1, 2]

"""Reasons of rejected axes as sentences: each has a German text with its values, and is kept as it is."""

from typing import Any

import pytest

from hpn.catalogue import Catalogue
from hpn.fleet.faults import CellFault, Reason, cell_of, reasons_of
from hpn.web.axis_tables import drafts_in
from hpn.web.columns import answer_in
from hpn.words.reader import Reader
from hpn.words.wording import Sentence
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
    {"name": ["a", 5]},
    {"pause_s": -1.0},
    {"pause_s": "long"},
    {"output_load.life_h": 20000.0},
    {"requirements.utilisation": 1.5},
    {"requirements.load_reverses": "perhaps"},
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
)
CELLS = (
    b"axis,torque_Nm,speed_rpm,duration_s,pause_s\na,9,5,1,\nb,9 5,5,1,\nc,9,5\n,9,5,1,\n\xff,9,5,1,\nd,inf,5,1,\n"
    b"e,9,5,1,1\ne,9,5,1,2\nf,9,5,1,\na,9,5,1,\n" + b"x" * 1001 + b",9,5,1,\n"
)


def test_every_reason_has_a_german_text(catalogue: Catalogue) -> None:
    axes = [{"axis": str(place), **SOUND, **wrong} for place, wrong in enumerate(WRONG)]
    sound, *drafts = drafts_in([{"axis": "sound", **SOUND}, *axes], (), {}, catalogue)

    assert sound.answer["status"] == "suitable"
    for draft in drafts:
        faults = answer_in(draft.answer).faults
        assert faults and draft.answer["status"] == "open", draft
        for fault in faults:
            assert Reader("de").sentence(fault.wording) != fault.wording.text
            assert fault.code


def test_every_reason_of_a_file_has_a_german_text(size: Size, catalogue: Catalogue) -> None:
    answers = list[dict[str, Any]]()

    size(CELLS, ".csv", use=lambda tables: answers.extend(row for table in tables for row in table.to_pylist()))

    assert [row["axis"] for row in answers if not row["error"]] == ["f"]
    for row in answers:
        if row["error"]:
            assert_told(row)


def assert_told(row: dict[str, Any]) -> None:
    """The text of an answer is that of its reasons, each of which is German for a German reader."""
    reasons = reasons_of(row["faults"])
    assert "; ".join(f"{reason.column}: {reason.sentence.text}" for reason in reasons) == row["error"]
    for reason in reasons:
        assert Reader("de").sentence(reason.sentence) != reason.sentence.text
        assert reason.code


def test_a_text_that_an_earlier_version_has_kept_is_shown_as_it_is() -> None:
    (reason,) = reasons_of(None, "n: phase 2: must be a number, such as 9.3; duration_s: is required")

    assert reason.column == ""
    assert reason.sentence.text == "n: phase 2: must be a number, such as 9.3; duration_s: is required"
    assert reasons_of(None, None) == []


def test_a_reason_is_kept_with_its_values(catalogue: Catalogue) -> None:
    wrong = {"axis": "a", **SOUND, "speed_rpm": [250.0, "x; n: 5"]}
    (draft,) = drafts_in([wrong], (), {"a": (7, 9)}, catalogue)
    (fault,) = answer_in(draft.answer).faults

    assert fault.wording.text == 'row 9: must be a number, such as 9.3, not "x;n: 5"'
    assert Reader("de").sentence(fault.wording) == 'Zeile 9: muss eine Zahl sein, z. B. 9.3, nicht "x;n: 5"'
    (reason,) = reasons_of(cell_of([CellFault(0, "speed_rpm", fault.wording, fault.code)]))
    assert reason.sentence == fault.wording


@pytest.mark.parametrize("bad", [2.5, float("nan"), 1e300, None])
def test_one_bad_axis_decides_nothing_for_the_others(bad: Any, size: Size) -> None:
    answers = size([{"axis": axis, **SOUND} for axis in (bad, 1.0, 2.0, bad)])

    assert [row["axis"] for row in answers if not row["error"]] == [1, 2]


OF_PHASE = Sentence("phase {number}: {reason}", {"number": "2", "reason": Sentence("is required")})


@pytest.mark.parametrize(
    ("reason", "english", "german"),
    [
        (Reason("speed_rpm", "missing", OF_PHASE), "Speed of phase 2 is required", "Drehzahl der Phase 2 fehlt"),
        (Reason("pause_s", "missing", Sentence("is required")), "Pause is required", "Pause fehlt"),
        (
            Reason(
                "x",
                "mechanism",
                Sentence("item {number}: {reason}", {"number": "1", "reason": Sentence("is required")}),
            ),
            "x: item 1: is required",
            "x: Eintrag 1: fehlt",
        ),
    ],
)
def test_a_reason_with_the_name_of_its_input_is_a_sentence(reason: Reason, english: str, german: str) -> None:
    name = {"speed_rpm": "Speed", "pause_s": "Pause"}.get(reason.column, reason.column)
    assert [Reader(language).sentence(reason.named(name)) for language in ("en", "de")] == [english, german]
    assert Reader("de").sentence(reason.named("")) == Reader("de").sentence(reason.sentence)

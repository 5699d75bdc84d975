"""Candidates, written in compiled code, against the typed rows and templates filled in by Python."""

import math
import random
from typing import Any

import numpy as np
import orjson
from msgspec.json import decode

from hpn import checks as c
from hpn import rows
from hpn.application import Application
from hpn.bearing import L50_PER_L10
from hpn.catalogue import Catalogue
from hpn.checks import CHECKS, STATUS, table_of
from hpn.explanations import EXPLANATIONS
from hpn.ranking import CANDIDATE_STATUS
from hpn.reply import REASONS, CandidateRow, CheckRow, ReserveRow, encode
from hpn.reserve import reserve_on
from hpn.selection import Selection, select


def drawn(chance: random.Random) -> Application:
    """An application of many checks, mild or far beyond every gear."""
    phase = {"torque_Nm": chance.uniform(1, 300), "speed_rpm": chance.uniform(1, 2000), "duration_s": 1.0}
    return Application.model_validate(
        {
            "duty_cycle": {"phases": [phase | {"radial_N": chance.uniform(0, 3000)}]},
            "emergency_stop": {"torque_Nm": chance.uniform(1, 1500), "count": chance.randint(0, 10**6)},
            "requirements": {"life_h": chance.uniform(1, 1e5), "weight_kg": chance.uniform(0.5, 9)},
        }
    )


def sentence(gear: dict[str, Any]) -> str:
    """What the reason of a candidate has to be."""
    failed = [check for check in gear["checks"] if check["status"] == "fail"]
    if gear["status"] == "unrated":
        return REASONS["unrated"].format(name=f"HPN-{gear['size']}")
    if any(check["utilisation"] is None for check in failed):
        return REASONS["no_stop_allowed"]
    key = "suitable" if not failed else "unsuitable" if len(failed) == 1 else "unsuitable_more"
    title, percent = EXPLANATIONS[gear["governing_check"]].title, float(np.round(100 * gear["utilisation"], 1))
    return REASONS[key].format(check=title, percent=f"{percent} %", failed=len(failed))


def test_every_candidate_has_the_sentence_that_its_checks_ask_for(catalogue: Catalogue) -> None:
    chance, kinds = random.Random(1), set()
    for _ in range(60):
        for gear in select(drawn(chance), catalogue).reply("/?")["candidates"]:
            assert gear["reason"] == sentence(gear)
            kinds.add((gear["status"], gear["reason"] == REASONS["no_stop_allowed"]))

    assert kinds == {("suitable", False), ("unsuitable", False), ("unsuitable", True), ("unrated", False)}


def row(selection: Selection, place: int, reason: str) -> CandidateRow:
    """The candidate at a place of the ranking."""
    evaluation = selection.evaluation
    g = evaluation.order.item(0, place)
    gear, put, figures = selection.gears.rows[g], evaluation.numbers[0, g], evaluation.figures[0, g]
    reserve = reserve_on(evaluation.duty.wishes, table_of(selection.gears), evaluation.numbers, False, 0, g)
    *states, verdict, governing = evaluation.codes[0, g].tolist()
    status = CANDIDATE_STATUS[verdict]
    return CandidateRow(
        designation=gear.designation,
        size=gear.size,
        ratio=gear.ratio,
        stages=gear.stages,
        status=status,
        rank=place + 1 if status == "suitable" else None,
        utilisation=math.nan if status == "unrated" else put.item(governing, c.USED),
        governing_check=None if status == "unrated" else CHECKS[governing].code,
        reason=reason,
        average_input_speed_rpm=figures.item(c.N_IN_AV),
        maximum_input_speed_rpm=figures.item(c.N_IN_MAX),
        life_L10_h=figures.item(c.L10),
        momentary_peak_count=figures.item(c.PEAKS),
        bearing_life_L50_h=figures.item(c.BEARING_L50),
        bearing_life_L10_h=figures.item(c.BEARING_L50) / L50_PER_L10,
        motor_peak_torque_Nm=figures.item(c.MOTOR_PEAK),
        motor_rated_torque_Nm=figures.item(c.MOTOR_RATED),
        reserve=ReserveRow(*reserve),
        checks=[
            CheckRow(
                code=CHECKS[check].code,
                demand=put.item(check, c.DEMAND),
                limit=put.item(check, c.LIMIT),
                utilisation=put.item(check, c.USED),
                status=STATUS[states[check]],
            )
            for check in evaluation.asked(0)
        ],
    )


def test_what_is_moved_beyond_the_last_number_is_there_to_be_read() -> None:
    assert len(orjson.dumps([rows._LONG] * rows._BEHIND)) >= rows._MOVE


def test_every_candidate_has_the_words_and_numbers_of_its_row(catalogue: Catalogue) -> None:
    chance = random.Random(2)
    for _ in range(40):
        selection = select(drawn(chance), catalogue)
        for place, candidate in enumerate(selection.reply("/?")["candidates"]):
            assert candidate == decode(encode(row(selection, place, candidate["reason"])))

"""The sentence of every candidate, put together in compiled code, against its template filled in by Python."""

import random
from typing import Any

import numpy as np

from hpn.application import Application
from hpn.catalogue import Catalogue
from hpn.explanations import EXPLANATIONS
from hpn.reply import REASONS
from hpn.selection import select


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

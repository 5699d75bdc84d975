"""Broken inputs through every door: never a server error, none over a second of processor time.

In `make soak` each door gets `HPN_TEST_FUZZ_INPUTS` of them, 200,000 by default.
"""

import os
import time
from collections.abc import Callable

import pytest

from tests.fuzz.doors import DOORS
from tests.fuzz.run import Outcome, attack, attack_in_parts

SHORT, LONG = 80, int(os.environ.get("HPN_TEST_FUZZ_INPUTS", "200000"))


@pytest.fixture(scope="module")
def attacked(soak: bool) -> Callable[[str], Outcome]:
    """Outcome of a door's inputs: the same few each time, or very many others each time."""
    if soak:
        return lambda door: attack_in_parts(door, int(time.time()), LONG)
    outcomes = attack(DOORS, range(SHORT))
    return lambda door: outcomes[door]


@pytest.mark.parametrize("door", DOORS)
def test_no_broken_input_brings_a_mistake_or_takes_long(attacked: Callable[[str], Outcome], door: str) -> None:
    outcome = attacked(door)

    print(f"{door}: {outcome}")
    assert outcome.findings == []
    assert outcome.inputs >= SHORT
    assert len(outcome.answers) > 1 or door == "xlsx"  # a table is taken or refused, a workbook refused

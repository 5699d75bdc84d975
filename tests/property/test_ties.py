"""Ties in real numbers are ties in the product: figures as people type them, against exact arithmetic.

The contract's plain reading (tests/reference/contract.py) is worked out with mpmath in 40 digits from the decimals as
they are written; the product's verdicts, order, governing checks and counts must be the same, also where cube roots,
powers and logarithms come out one last bit higher or lower, as they do on other processors.
"""

import random
from dataclasses import fields, replace
from typing import Any

import mpmath
import pytest

from hpn.application import Application
from hpn.catalogue import Catalogue
from tests.build import Json, cycle, phase
from tests.last_bits import WAYS, moved
from tests.property.draw import RANKS
from tests.reference import contract
from tests.reference.contract_gears import Arithmetic, Gear, printed_gears
from tests.wire import Selection, select_fleet

DIGITS = 40
EXACT = Arithmetic(lambda value: mpmath.mpf(str(value)), mpmath.fsum, lambda value: int(mpmath.floor(value)))

TORQUES = [0, 5.2, 9, 14, 20, 24, 26, 29, 32, 40, 40.8, 56, 62, 80, 84, 107, 133, 149, 156, 200, 226, 256, 376, 400]
SPEEDS = [1, 50, 60, 80, 100, 120, 200, 218, 250, 285, 300, 400, 428.5, 500, 600, 750, 850, 857, 1000, 1200, 2000]
DURATIONS = [0.1, 0.2, 0.25, 0.3, 0.4, 0.5, 0.8, 1, 1.5, 2, 3]
PAUSES = [0, 0, 0.1, 0.6, 1, 1.2, 2, 4, 10]


def typed(chance: random.Random) -> Json:
    """An application in round figures, many of which are limits of some gear, so that checks, gears and lives tie."""
    phases = [
        phase(chance.choice(TORQUES), chance.choice(SPEEDS if k == 0 else [0, *SPEEDS]), chance.choice(DURATIONS))
        for k in range(chance.choice([1, 1, 1, 2, 3, 4]))
    ]
    parts: Json = {"rank_by": chance.choice(RANKS)}
    if chance.random() < 0.4:
        parts["emergency_stop"] = {"torque_Nm": chance.choice([*TORQUES[1:], 250, 650])}
        if chance.random() < 0.6:
            parts["emergency_stop"]["count"] = chance.choice([0, 1, 10, 100, 1000, 10000, 3066035])
    if chance.random() < 0.4:
        parts["output_load"] = {
            "radial_N": chance.choice([0, 100, 280, 440, 500, 720, 840, 1500, 1800]),
            "axial_N": chance.choice([0, 100, 200, 300, 660, 970]),
            "load_coefficient": chance.choice([1, 1.2, 1.5]),
            "life_h": chance.choice([5000, 10000, 20000, 40000]),
            "life_basis": chance.choice(["L50", "L10"]),
            "model": chance.choice(["linear", "iso281"]),
        }
    wishes: dict[str, Any] = {"utilisation": chance.choice([1, 1, 1, 0.5, 0.7, 0.8, 0.9])}
    if chance.random() < 0.5:
        wishes["life_h"] = chance.choice([1000, 5000, 10000, 20000, 30000, 50000])
    if chance.random() < 0.3:
        wishes["motor"] = {"maximum_speed_rpm": chance.choice([2000, 3000, 4500, 6000])}
        wishes["motor"]["peak_torque_Nm"] = chance.choice([2, 4, 8, 10])
        wishes["efficiency"] = chance.choice([0.8, 0.9, 0.95, 1])
    for name, values in (
        ("ambient_temperature_degC", [0, 20, 25, 40, 45]),
        ("backlash_arcmin", [3, 5, 7]),
        ("weight_kg", [0.6, 1.3, 2.4, 6]),
    ):
        if chance.random() < 0.1:
            wishes[name] = chance.choice(values)
    return cycle(*phases, pause_s=chance.choice(PAUSES), requirements=wishes, **parts)


def exactly(value: Any) -> Any:
    """The same with every number as its decimals are written."""
    if isinstance(value, dict):
        return {name: exactly(part) for name, part in value.items()}
    if isinstance(value, list | tuple):
        return type(value)(map(exactly, value))
    return EXACT.number(value) if isinstance(value, int | float) and not isinstance(value, bool) else value


def exact_gears() -> list[Gear]:
    """Printed gears, of exact numbers."""
    names = [field.name for field in fields(Gear) if field.name not in ("size", "ratio", "stages")]
    return [replace(gear, **{name: exactly(getattr(gear, name)) for name in names}) for gear in printed_gears()]


Decided = list[tuple[str, str, str | None, int | None, float | None]]


def decided(reply: Json) -> Decided:
    """Decisions of a reply: order, verdicts, governing checks, ranks and counts of stops."""
    names = ("designation", "status", "governing_check", "rank", "momentary_peak_count")
    return [tuple(candidate[name] for name in names) for candidate in reply["candidates"]]


def expected(case: Json, gears: list[Gear]) -> Decided:
    """The same by the contract in exact arithmetic."""
    with mpmath.workdps(DIGITS):
        answer = contract.answer(exactly(case), gears, EXACT)
    return [
        (
            c.gear.name,
            c.status,
            c.governing,
            c.rank,
            None if (allowed := c.figures["momentary_peak_count"]) in (None, contract.INFINITE) else allowed,
        )
        for c in answer.candidates
    ]


def test_figures_as_typed_are_decided_as_in_exact_arithmetic_whatever_the_last_bits(
    catalogue: Catalogue, soak: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    with mpmath.workdps(DIGITS):
        gears = exact_gears()
    count = 20_000 if soak else 200
    step = 200
    for first in range(0, count, step):
        cases = [typed(random.Random(seed)) for seed in range(first, first + step)]
        applications = [Application.model_validate(case) for case in cases]
        wanted = [expected(case, gears) for case in cases]
        for way in (None, *WAYS):
            with monkeypatch.context() as patch:
                if way is not None:
                    moved(patch, way)
                replies = [
                    one.reply("/") for one in select_fleet(applications, catalogue) if isinstance(one, Selection)
                ]
            for case, reply, want in zip(cases, replies, wanted, strict=True):
                assert decided(reply) == want, (way, case)

"""The product against the contract worked out a second time in plain Python (tests/reference/contract.py)."""

import itertools
import json
import math
import random
from collections import Counter
from collections.abc import Iterator

from hpn.application import Application
from hpn.catalogue import Catalogue
from tests.build import Json
from tests.conftest import Supplement
from tests.property.draw import RANKS, at_random
from tests.reference import contract
from tests.reference.contract_gears import Answer, Gear, printed_gears
from tests.wire import EXPLANATIONS, Selection, select, select_fleet

# Both ways round sums, powers and quotients differently; a power 10/3 of a sum of twelve terms stays far below this.
ROUNDING = 1e-12


def same(given: float | None, expected: float | None) -> bool:
    """The contract's JSON: unlimited is null; numbers agree to rounding."""
    if expected is None or math.isinf(expected):
        return given is None
    return given is not None and math.isclose(given, expected, rel_tol=ROUNDING)


def differences(reply: Json, expected: Answer) -> Iterator[str]:
    """Everything that the contract fixes of a reply and that is otherwise in this one."""
    for name, figure in expected.duty.items():
        if not same(reply["duty"][name], figure):
            yield f"{name}: {reply['duty'][name]} instead of {figure}"
    if reply["selected"] != expected.selected:
        yield f"selected: {reply['selected']} instead of {expected.selected}"
    order = [c["designation"] for c in reply["candidates"]]
    if order != [c.gear.name for c in expected.candidates]:
        yield f"order: {order} instead of {[c.gear.name for c in expected.candidates]}"
        return
    for inputs, target in zip(reply["candidates"], expected.candidates, strict=True):
        fixed = {
            "size": target.gear.size,
            "ratio": target.gear.ratio,
            "stages": target.gear.stages,
            "status": target.status,
            "rank": target.rank,
            "governing_check": target.governing,
            "missing": ["output_load.shaft_centre_mm"] if target.lacks_input else [],
        }
        for name, text in fixed.items():
            if inputs[name] != text:
                yield f"{target.gear.name} {name}: {inputs[name]} instead of {text}"
        for name, value in (target.figures | {"utilisation": target.utilisation}).items():
            if not same(inputs[name], value):
                yield f"{target.gear.name} {name}: {inputs[name]} instead of {value}"
        if [(c["code"], c["status"]) for c in inputs["checks"]] != [(c.code, c.status) for c in target.checks]:
            yield f"{target.gear.name} checks: {inputs['checks']} instead of {target.checks}"
            continue
        for got, check in zip(inputs["checks"], target.checks, strict=True):
            for name in ("demand", "limit", "utilisation", "at_least"):
                if not same(got[name], getattr(check, name)):
                    yield f"{target.gear.name} {check.code} {name}: {got[name]} instead of {getattr(check, name)}"


def compare_many(catalogue: Catalogue, gears: list[Gear], cases: list[Json]) -> Counter[object]:
    """Compare through the batch's code path, and count what the cases reached."""
    reached: Counter[object] = Counter()
    selections = select_fleet([Application.model_validate(case) for case in cases], catalogue)
    for place, (case, selection) in enumerate(zip(cases, selections, strict=True)):
        assert isinstance(selection, Selection), (case, selection)
        if place % 10 == 0:  # and alone: both roads must lead to the same reply, to the last bit
            alone = select(Application.model_validate(case), catalogue)
            assert alone.json("/") == selection.json("/")
            selection = alone
        expected = contract.answer(case, gears)
        result = list(itertools.islice(differences(selection.reply("/"), expected), 5))
        assert not result, "\n".join([json.dumps(case), *result])
        reached.update((check.code, check.status) for c in expected.candidates for check in c.checks)
        reached.update((c.status, c.utilisation is None or math.isinf(c.utilisation)) for c in expected.candidates)
        reached.update(c.governing for c in expected.candidates)
        if sum(c.status == "suitable" for c in expected.candidates) > 1:
            reached[case.get("rank_by", "weight")] += 1
    return reached


def test_thousands_of_random_applications_get_what_the_contract_says(catalogue: Catalogue, soak: bool) -> None:
    cases = [at_random(random.Random(seed)) for seed in range(3000 if soak else 1500)]

    reached = compare_many(catalogue, printed_gears(), cases)

    # A comparison is worth as much as what it reaches: every check in every state, every way to rank and to govern.
    rated_by_input = {"motor_speed", "motor_peak_torque", "motor_rated_torque", "backlash", "torsional_stiffness"}
    rated_by_input |= {"motor_rated_speed", "inertia_ratio", "natural_frequency", "position_error"}
    for code, explanation in EXPLANATIONS.items():
        states = {"pass", "fail"} | (set() if code in rated_by_input else {"not_rated"})
        assert all(reached[code, state] > 20 for state in states), code
        assert reached[code] > 20, code
        assert explanation.group in ("load", "property")
    assert all(reached[rank] > 20 for rank in RANKS)
    assert reached["unsuitable", True] > 20  # fails without a utilisation
    assert reached["unrated", True] > 20


CURVE = {"14A": [(900, 0), (880, 300), (500, 700), (420, 1000), (0, 950)], "40A": [(8000, 0), (0, 6000)]}


def test_random_applications_agree_under_a_supplement_that_rates_some_of_40a_and_draws_two_curves(
    supplemented: Supplement, soak: bool
) -> None:
    points = [f"{size},1,{axial},{radial}," for size, curve in CURVE.items() for radial, axial in curve]
    catalogue = supplemented(
        ratings="size,ratio,repeated_peak_torque_Nm,rated_torque_Nm,momentary_peak_torque_Nm,source\n"
        "40A,5,752,400,1250,my page\n40A,10,370,370,1250,my page\n40A,20,700,,1250,\n",
        sizes="size,maximum_input_speed_rpm,average_input_speed_rpm,ambient_temperature_minimum_degC,"
        "ambient_temperature_maximum_degC,dynamic_radial_load_N,dynamic_axial_load_N,note,source\n"
        "40A,4000,3000,0,40,,,,my page\n",
        weights="size,stages,weight_kg,source\n40A,1,15,my page\n",
        bearing_envelopes="size,load_coefficient,axial_N,radial_N,source\n" + "\n".join(points) + "\n",
    )
    gears = printed_gears()
    ratings = {5: (752, 400, 1250), 10: (370, 370, 1250), 20: (700, None, 1250)}
    for gear in gears:
        gear.curve = CURVE.get(gear.size)
        if gear.size == "40A":
            gear.T_R, gear.T_N, gear.T_M = ratings.get(gear.ratio, (None, None, None))
            gear.n_max, gear.n_av, gear.ambient = 4000, 3000, (0, 40)
            gear.weight = 15 if gear.stages == 1 else None

    cases = [at_random(random.Random(seed), ("linear", "digitised")) for seed in range(1200 if soak else 600)]
    reached = compare_many(catalogue, gears, [case for case in cases if _has_curve(case)])
    assert reached["output_bearing_load", "not_rated"] > 20
    assert reached["output_bearing_load", "fail"] > 20


def _has_curve(case: Json) -> bool:
    """True where the digitised model, if asked for, has a curve for at least one of the sizes left."""
    sizes = case.get("requirements", {}).get("sizes")
    return case.get("output_load", {}).get("model") != "digitised" or not sizes or bool(set(sizes) & set(CURVE))

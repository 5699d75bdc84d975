"""Axes of a machine against the contract's rules for own and common values, written out here a second time."""

import copy
import math
from collections import Counter
from typing import Any

from hypothesis import given, settings
from hypothesis import strategies as st
from pydantic import ValidationError

from hpn.application import Application
from hpn.catalogue import load_catalogue
from hpn.documents.answers import AxisQuestion, answer_of, answers
from hpn.documents.common import COMMON, Common
from hpn.documents.gears import OrderAxis, gears_of
from hpn.documents.merge import resolve
from hpn.engine.selection import select
from tests.build import Json
from tests.property.draw import applications

CATALOGUE = load_catalogue()

# One chunk of axes and one application alone round sums differently where cycles are padded.
ROUNDING = 1e-12

VERDICT = ("status", "selected", "designation", "governing_check", "shortest_life_of", "suitable", "runner_up")
FIGURES = (
    *("utilisation", "life_L10_h", "shortest_life_h", "natural_frequency_Hz", "motor_torque_limit_Nm", "weight_kg"),
    "average_torque_Nm",
)

VALUES: dict[str, list[Any]] = {
    "application_area": ["medical", "vacuum"],
    "rank_by": ["weight", "life", "natural_frequency", "position_error"],
    "output_load.load_coefficient": [1.0, 1.5],
    "output_load.life_h": [100.0, 20000.0],
    "output_load.life_basis": ["L50", "L10"],
    "output_load.model": ["linear", "iso281"],
    "output_load.shaft_centre_mm": [30.0],
    "requirements.ratios": [[5], [4, 10]],
    "requirements.sizes": [["14A", "20A"], ["32A"]],
    "requirements.life_h": [20000.0, 1e6],
    "requirements.backlash_arcmin": [7.0],
    "requirements.torsional_stiffness_Nm_per_rad": [1000.0],
    "requirements.weight_kg": [5.0],
    "requirements.length_mm": [200.0],
    "requirements.ambient_temperature_degC": [25.0],
    "requirements.utilisation": [0.9, 1.0],
    "requirements.efficiency": [0.95],
    "requirements.natural_frequency_Hz": [3.0],
    "requirements.position_error_arcmin": [20.0],
    "requirements.position_error_mm": [2.0],
    "requirements.position_radius_mm": [250.0],
    "requirements.position_error_at": ["cycle", "rest"],
    "requirements.worst_case_utilisation": [0.95],
    "requirements.over_tolerance": [True, False],
}
"""Every field that the contract lets be common, with values of it; some equal the default."""


def nested(values: Json) -> Json:
    """Values by their paths as the JSON of an application."""
    whole: Json = {}
    for path, value in values.items():
        part, _, name = path.rpartition(".")
        (whole.setdefault(part, {}) if part else whole)[name] = value
    return whole


def some(least: int = 0) -> st.SearchStrategy[Json]:
    """Values of some of the fields, of the position error one at most."""
    fields = {path: st.sampled_from(values) for path, values in VALUES.items()}
    drawn = st.fixed_dictionaries({}, optional=fields)
    twice = {"requirements.position_error_arcmin", "requirements.position_error_mm"}
    return drawn.map(lambda values: {k: v for k, v in values.items() if k != min(twice) or not twice <= values.keys()})


@st.composite
def own_parts(draw: st.DrawFn) -> Json:
    """An axis's own part: any application, with values of common fields, with nulls, and often without a load."""
    whole = draw(applications(wishes=False))
    own: Json = {name: whole[name] for name in ("duty_cycle", "emergency_stop") if name in whole}
    load = {
        k: v for k, v in whole.get("output_load", {}).items() if k in ("radial_N", "axial_N") and draw(st.booleans())
    }
    if draw(st.integers(0, 4)) == 0:
        own["duty_cycle"]["phases"][0]["radial_N"] = 300.0
    values = nested(draw(some()) if draw(st.booleans()) else {})
    for part, more in (("requirements", {"load_inertia_kgm2": 0.2}), ("output_load", load)):
        if more and draw(st.booleans()):
            values[part] = {**values.get(part, {}), **more}
    if draw(st.booleans()):
        values["requirements"] = {**values.get("requirements", {}), "life_h": None, "motor": None}
    return own | values


def expected(own: Json, common: Json, without: set[str]) -> tuple[Json, set[str]]:
    """Resolved application and the paths that are not asked, by the contract's sentences one after another."""
    cycle, asked, load = own["duty_cycle"], own.get("requirements") or {}, own.get("output_load") or {}
    has_load = any(load.get(name) is not None for name in ("radial_N", "axial_N")) or any(
        phase.get("radial_N") is not None for phase in cycle["phases"]
    )
    knows_inertia = asked.get("load_inertia_kgm2") is not None
    rests = cycle["pause_s"] > 0 or any(phase["speed_rpm"] == 0 for phase in cycle["phases"])
    whole = copy.deepcopy(own)
    for part in ("requirements", "output_load"):
        if part in whole:
            whole[part] = {name: value for name, value in whole[part].items() if value is not None}
    not_asked = set()
    radius_is_common = "requirements.position_radius_mm" in common and "requirements.position_radius_mm" not in without
    for path, value in common.items():
        part, _, name = path.rpartition(".")
        is_own = (own.get(part) or {} if part else own).get(name) is not None
        rival = {"position_error_mm": "position_error_arcmin", "position_error_arcmin": "position_error_mm"}.get(name)
        if path in without or is_own or (part == "output_load" and not has_load):
            continue
        if rival is not None and asked.get(rival) is not None:
            continue
        lacks = {
            "natural_frequency_Hz": not knows_inertia,
            "rank_by": value == "natural_frequency" and not knows_inertia,
            "position_error_at": value == "rest" and not rests,
            "position_error_mm": asked.get("position_radius_mm") is None and not radius_is_common,
        }
        if lacks.get(name):
            not_asked.add(path)
        else:
            (whole.setdefault(part, {}) if part else whole)[name] = value
    return whole, not_asked


def test_every_common_field_is_drawn_here() -> None:
    assert set(VALUES) == set(COMMON)


@settings(max_examples=400)
@given(own_parts(), some(), st.sets(st.sampled_from(list(VALUES))))
def test_own_and_common_values_merge_as_the_contract_says(own: Json, common: Json, without: set[str]) -> None:
    values = Common.model_validate(nested(common))
    assert values.values == common

    found = resolve(own, values.as_json, without)

    whole, not_asked = expected(own, common, without)
    try:
        application = Application.model_validate(whole)
    except ValidationError as error:
        # An own value that lacks something is the axis's fault. The first fault may hide a common one that lacks.
        assert found.application is None
        assert {code for _, _, code in found.faults} == {entry["type"] for entry in error.errors()}
        return
    assert found.whole == whole
    assert set(found.not_asked) == not_asked
    assert found.application == application


@settings(max_examples=60)
@given(st.lists(own_parts(), min_size=1, max_size=8), some())
def test_axes_together_are_answered_as_each_alone(owns: list[Json], common: Json) -> None:
    resolved = [resolve(own, nested(common)) for own in owns]

    for one, answer in zip(resolved, answers([AxisQuestion(one) for one in resolved], CATALOGUE), strict=True):
        if one.application is None:
            assert answer.status == "open" and answer.faults and answer.designation is None
            continue
        try:
            selection = select(one.application, CATALOGUE)
        except ValueError:
            assert answer.status == "open" and answer.faults
            continue
        whole = answer_of(selection, selection.foremost, CATALOGUE)
        for name in (
            "status",
            "selected",
            "designation",
            "governing_check",
            "shortest_life_of",
            "suitable",
            "runner_up",
        ):
            assert getattr(answer, name) == getattr(whole, name)
        for name in FIGURES:
            expected_figure, figure = getattr(whole, name), getattr(answer, name)
            assert (figure is None) == (expected_figure is None)
            assert figure is None or math.isclose(figure, expected_figure, rel_tol=ROUNDING)


@given(
    st.lists(
        st.tuples(
            st.integers(1, 1000),
            st.sampled_from([None, "HPN-20A-5-J6", "hpn-20a-5", "no code"]),
            st.sampled_from([None, "HPN-20A-5", "HPN-14A-5"]),
        ),
        max_size=12,
    )
)
def test_the_gear_list_counts_every_axis_with_a_gear_once(rows: list[tuple[int, str | None, str | None]]) -> None:
    found = gears_of((OrderAxis(number, *row) for number, row in enumerate(rows, 1)), CATALOGUE)

    by_hand: Counter[str] = Counter()
    for quantity, code, selected in rows:
        if code != "no code" and (code or selected):
            by_hand["HPN-20A-5" if code else str(selected)] += quantity
    listed: Counter[str] = Counter()
    for gear in found.gears:
        listed[gear.designation] += gear.quantity
    assert listed == by_hand
    weights = {"HPN-20A-5": 2.6, "HPN-14A-5": 0.95}  # as table 5 of the handbook prints them
    assert math.isclose(found.weight_kg or 0.0, sum(weights[name] * count for name, count in by_hand.items()))
    numbers = [number for gear in found.gears for number in gear.axes]
    assert len(numbers) == len(set(numbers))

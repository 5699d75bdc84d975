"""The input models: what is accepted, what is refused, and where the refusal points."""

import copy
from typing import Any

import pytest
from pydantic import ValidationError

from hpn.application import Application, BatchItem, InputError
from hpn.catalogue import Catalogue
from hpn.words.designations import canonical_designation, canonical_size
from hpn.words.fields import MAXIMUM_PHASES
from hpn.words.units import SYMBOLS, suffix_of, symbol_of
from tests.build import Json, answer, check, cycle, phase, worked_example


def refused(application: Json) -> dict[tuple[Any, ...], str]:
    """Location and message of every error."""
    with pytest.raises(ValidationError) as refusal:
        Application.model_validate(application)
    return {error["loc"]: error["msg"] for error in refusal.value.errors()}


def changed(path: str, value: Any) -> Json:
    """A full application with one value replaced or added, by its JSON pointer."""
    application: Any = copy.deepcopy(
        worked_example(
            output_load={"radial_N": 100.0},
            requirements={"ratios": [5], "sizes": ["14A"], "motor": {"peak_torque_Nm": 5}},
        )
    )
    *steps, last = (int(step) if step.isdigit() else step for step in path.strip("/").split("/"))
    place = application
    for step in steps:
        place = place[step]
    if isinstance(place, list) and last == len(place):
        place.append(value)
    else:
        place[last] = value
    result: Json = application
    return result


BOUNDS: dict[str, list[Any]] = {
    "/duty_cycle/phases/0/torque_Nm": [1e6 + 1, -1e6 - 1, "40", None, True, float("nan"), float("inf")],
    "/duty_cycle/phases/1/speed_rpm": [1e6 + 1, "250", None, False],
    "/duty_cycle/phases/2/duration_s": [0, -1, 1e9 + 1, None, "1"],
    "/duty_cycle/phases/0/radial_N": [1e9 + 1, "5"],
    "/duty_cycle/pause_s": [-1, 1e9 + 1, "4"],
    "/emergency_stop/torque_Nm": [1e6 + 1, None],
    "/emergency_stop/count": [-1, 1.5, 10**15 + 1, "3", True],
    "/output_load/radial_N": [1e9 + 1, float("-inf")],
    "/output_load/load_coefficient": [0.99, 3.01],
    "/output_load/life_h": [0, -1, 1e9 + 1],
    "/output_load/life_basis": ["L20"],
    "/output_load/model": ["curved"],
    "/requirements/ratios": [[], "5", 5],
    "/requirements/ratios/0": [0, 5.5, "5", True],
    "/requirements/sizes": [[], "14A"],
    "/requirements/sizes/0": [14, "1" * 21],
    "/requirements/utilisation": [0, 1.01, -0.5],
    "/requirements/efficiency": [0, 1.01],
    "/requirements/life_h": [0, -5],
    "/requirements/backlash_arcmin": [0, -5, "5"],
    "/requirements/torsional_stiffness_Nm_per_rad": [0],
    "/requirements/weight_kg": [0],
    "/requirements/length_mm": [0],
    "/requirements/ambient_temperature_degC": [-273.16, 1001],
    "/requirements/motor/maximum_speed_rpm": [0],
    "/requirements/motor/peak_torque_Nm": [-1],
    "/requirements/motor/rated_torque_Nm": [0],
    "/application_area": ["space"],
    "/rank_by": ["price"],
}


@pytest.mark.parametrize(("path", "value"), [(path, value) for path, values in BOUNDS.items() for value in values])
def test_a_value_out_of_bounds_is_refused_where_it_stands(path: str, value: Any) -> None:
    errors = refused(changed(path, value))

    pointers = {"/" + "/".join(map(str, location)) for location in errors}
    assert path in pointers


@pytest.mark.parametrize(
    "path",
    [
        "/colour",
        "/duty_cycle/phases/0/torque",
        "/duty_cycle/pause",
        "/emergency_stop/n",
        "/output_load/offset_mm",
        "/requirements/price",
        "/requirements/motor/voltage",
    ],
)
def test_an_unknown_field_is_refused_and_never_ignored(path: str) -> None:
    errors = refused(changed(path, 1))

    assert {"/" + "/".join(map(str, location)) for location in errors} == {path}


def test_an_application_without_phases_or_without_motion_is_refused_in_words() -> None:
    assert ("duty_cycle",) in refused({})
    assert ("duty_cycle", "phases") in refused({"duty_cycle": {}})
    assert ("duty_cycle", "phases") in refused(cycle())
    still = refused(cycle(phase(5, 0), phase(3, 0)))
    assert "no phase moves" in still["duty_cycle", "phases"]


def test_ten_thousand_phases_are_accepted_and_one_more_is_not() -> None:
    many = [phase(1, 1)] * MAXIMUM_PHASES
    assert MAXIMUM_PHASES == 10_000
    assert len(Application.model_validate(cycle(*many)).duty_cycle.load_phases) == MAXIMUM_PHASES
    assert ("duty_cycle", "phases") in refused(cycle(*many, phase(1, 1)))


def test_an_output_load_without_any_load_is_an_error_and_a_load_of_zero_is_one() -> None:
    assert "no load" in refused(cycle(phase(1, 1), output_load={}))["output_load",]
    assert ("output_load",) in refused(cycle(phase(1, 1), output_load={"life_h": 5.0, "radial_N": None}))
    Application.model_validate(cycle(phase(1, 1), output_load={"axial_N": 0}))
    Application.model_validate(cycle(phase(1, 1, axial_N=5.0), output_load={"life_h": 5.0}))


def test_a_phase_load_stands_for_itself_and_the_cycle_fills_what_it_leaves(catalogue: Catalogue) -> None:
    """Phase 1 has its own radial load and the cycle's axial one; phase 2 the reverse; by hand for HPN-20A (linear)."""
    application = cycle(
        phase(1, 100, radial_N=900.0),
        phase(1, 100, axial_N=0.0),
        output_load={"radial_N": 180.0, "axial_N": -220.0},
        requirements={"sizes": ["20A"], "ratios": [5]},
    )

    demand = check(answer(application, catalogue), "HPN-20A-5", "output_bearing_load")["demand"]
    alone = cycle(phase(1, 100, radial_N=900.0), requirements={"sizes": ["20A"], "ratios": [5]})

    assert demand == pytest.approx(900 / 1800 + 220 / 2200, rel=1e-15)
    assert check(answer(alone, catalogue), "HPN-20A-5", "output_bearing_load")["demand"] == 0.5


def test_defaults_are_those_of_the_contract() -> None:
    application = Application.model_validate(cycle(phase(1, 1), output_load={"radial_N": 1}))
    load = application.output_load

    assert Application.model_validate({"duty_cycle": {"phases": [phase(1, 1)]}}).duty_cycle.pause_s == 0
    assert application.rank_by == "weight"
    assert application.requirements.utilisation == 1
    assert load is not None
    assert (load.load_coefficient, load.life_h, load.life_basis, load.model) == (1, 20000, "L50", "linear")


def test_the_same_input_is_read_from_json_text_and_from_values() -> None:
    application = worked_example(requirements={"ratios": [5], "sizes": ["HPN-20A", "14"]})
    text = Application.model_validate_json(__import__("orjson").dumps(application))

    assert text == Application.model_validate(application)
    assert text.requirements.sizes == ("20A", "14A")
    assert BatchItem.model_validate(application | {"reference": "x"}).duty_cycle == text.duty_cycle


@pytest.mark.parametrize(
    ("requirements", "location", "named"),
    [
        ({"ratios": [6]}, ("requirements", "ratios", 0), "3, 4, 5, 7, 10, 15, 20, 25, 30, 35, 40, 45, 50"),
        ({"ratios": [5, 99]}, ("requirements", "ratios", 1), "99"),
        ({"sizes": ["15A"]}, ("requirements", "sizes", 0), "11A, 14A, 20A, 32A, 40A"),
        ({"sizes": ["20A", "big"]}, ("requirements", "sizes", 1), "big"),
        ({"sizes": ["11A"], "ratios": [3]}, ("requirements", "ratios"), "11A: 4, 5, 7, 10, 15, 20"),
    ],
)
def test_a_size_or_ratio_that_is_not_there_is_an_input_error_that_names_what_there_is(
    catalogue: Catalogue, requirements: Json, location: tuple[Any, ...], named: str
) -> None:
    with pytest.raises(InputError) as refusal:
        answer(cycle(phase(1, 1), requirements=requirements), catalogue)

    assert [place for place, _ in refusal.value.problems] == [location]
    assert named in str(refusal.value)


def test_whole_floats_count_as_integers_and_are_kept_as_such() -> None:
    application = Application.model_validate_json(
        b'{"duty_cycle": {"phases": [{"torque_Nm": 1, "speed_rpm": 1, "duration_s": 1}]},'
        b' "requirements": {"ratios": [5.0, 1e1]}, "emergency_stop": {"torque_Nm": 2, "count": 10.0}}'
    )

    dumped = application.model_dump_json()

    assert '"ratios":[5,10]' in dumped
    assert '"count":10}' in dumped


def test_sizes_and_ratios_restrict_the_list_and_nothing_else(catalogue: Catalogue) -> None:
    reply = answer(cycle(phase(1, 1), requirements={"sizes": ["32A", "11A"], "ratios": [50, 3]}), catalogue)

    assert {c["designation"] for c in reply["candidates"]} == {"HPN-11A-50", "HPN-32A-3", "HPN-32A-50"}
    assert len(answer(cycle(phase(1, 1)), catalogue)["candidates"]) == len(catalogue.gears)


@pytest.mark.parametrize(
    "text",
    ["HPN-20A-5", "HPN-20-5", "HPN-20A-05", "hpn-20a-5", "20A-5", "HPN-20A-5-J6-BH-AF1", " HPN-20A-5 ", "HPN20A-5"],
)
def test_every_printed_spelling_of_a_designation_is_read(catalogue: Catalogue, text: str) -> None:
    result = catalogue.find(text)

    assert result is not None
    assert result.designation == "HPN-20A-5"


@pytest.mark.parametrize(
    "text", ["20A 5:1", "20a 5", "20 5", "HPN 20A 5", "HPN 20A-5", "20A i=5", "20A-5 : 1", "hpn 20a i 5"]
)
def test_a_designation_as_people_type_it_is_read(catalogue: Catalogue, text: str) -> None:
    result = catalogue.find(text)

    assert result is not None
    assert result.designation == "HPN-20A-5"


@pytest.mark.parametrize(
    "text", ["", "HPN", "HPN-20A", "HPN-20B-5", "HPN-20A-6", "HPN-20A-5J6", "x" * 5000, "20A5", "20A 5:2", "20A 1:5"]
)
def test_a_text_that_is_no_designation_is_not_found(catalogue: Catalogue, text: str) -> None:
    assert catalogue.find(text) is None


def test_sizes_have_one_canonical_spelling() -> None:
    assert {canonical_size(text) for text in ("14", "14A", "14a", "HPN-14A", "hpn-14", " 14A ")} == {"14A"}
    assert canonical_size("fourteen") == "fourteen"
    assert canonical_size(14) == 14
    assert canonical_designation("HPN-11A-4-J6-BH-AF1") == "HPN-11A-4"


def test_a_unit_is_read_from_the_end_of_a_name_and_from_nowhere_else() -> None:
    assert {name: symbol_of(name) for name in ("torque_Nm", "life_L10_h", "K3_Nm_per_rad", "angle_arcmin")} == {
        "torque_Nm": "Nm",
        "life_L10_h": "h",
        "K3_Nm_per_rad": "Nm/rad",
        "angle_arcmin": "arcmin",
    }
    for name in ("sources", "count", "Nm", "stages", "phases", "load_coefficient"):
        assert suffix_of(name) == ""
        assert symbol_of(name) == ""
    assert symbol_of("temperature_degC") == "°C"
    assert {suffix: symbol_of(f"a_{suffix}") for suffix in SYMBOLS} == SYMBOLS


def test_the_worked_example_of_the_product_is_the_printed_one() -> None:
    printed = Application.model_validate(worked_example(requirements={"ratios": [5]}))

    assert Application.worked_example() == printed

"""The calculation of the worked example, of long cycles, and of gears that are not rated."""

import pytest

from hpn.application import Application
from hpn.catalogue import Catalogue
from hpn.engine.selection import select
from hpn.explain.calculation import Step, calculation_of
from hpn.explain.calculation.formula import Constant, Term, Variable, value_of
from hpn.explain.calculation.mathml import addition, in_symbols, mathml
from hpn.explain.calculation.motor import OWN as OWN_FIGURES
from hpn.words.reader import Reader
from tests.build import LIFTING, TURNING, Json, cycle, phase, worked_example
from tests.conftest import Supplement


def steps_of(document: Json, designation: str, catalogue: Catalogue) -> dict[str, Step]:
    """Steps of the calculation of a gear by their code."""
    application = Application.model_validate(document)
    selection = select(application, catalogue)
    candidate = selection.candidate(designation)
    assert candidate is not None
    steps = calculation_of(candidate, selection.duty, catalogue.by_designation[designation], application, catalogue)
    return {step.code: step for step in steps}


def test_worked_example_says_what_rounding_by_hand_would_give(catalogue: Catalogue) -> None:
    """1090 rpm, 3090295 stops and 1167324 h are printed in equations 18.4, 18.8 and 18.9."""
    steps = steps_of(worked_example(), "HPN-20A-5", catalogue)
    speed, stops, life = (steps[code].notes[0].text for code in ("average_input_speed", "momentary_peak_count", "life"))
    assert "218 rpm by hand you would get 1090 rpm" in speed
    assert "x rounded to 6.49 by hand you would get 3090295 stops" in stops
    assert (
        "32 Nm and n_in,av to 1090 rpm by hand you would get 1167324 h, as the handbook does in equation 18.9" in life
    )


def test_nothing_is_said_of_rounding_where_it_changes_nothing(catalogue: Catalogue) -> None:
    steps = steps_of(cycle(phase(30.0, 100.0)), "HPN-20A-5", catalogue)
    assert steps["average_input_speed"].notes == ()
    assert not any("by hand" in note.text for note in steps["life"].notes)


def test_a_motion_whose_speed_is_a_whole_number_but_for_its_last_bit_says_nothing_of_rounding(
    catalogue: Catalogue,
) -> None:
    """90° in 1.5 s by way of a stage of 1.5 are 15 rpm."""
    turn = {"profile": "trapezoidal", "angle_deg": 90, "time_s": 1.5}
    table = {"type": "rotary", "inertia_kgm2": 2, "gravity_mass_kg": 20, "gravity_radius_mm": 250, "ratio": 1.5}
    motion = {"mechanism": table, "moves": [turn]}
    assert steps_of({"duty_cycle": {"motion": motion}}, "HPN-20A-10", catalogue)["average_input_speed"].notes == ()


def test_speeds_enter_the_bearings_equivalent_load_by_magnitude_as_symbols_too(catalogue: Catalogue) -> None:
    loaded = cycle(phase(10, -100), phase(10, 50), output_load={"radial_N": 500.0})
    mean = steps_of(loaded, "HPN-20A-5", catalogue)["output_bearing_life"].lines[0]
    assert "Σ |n_j|·t_j·P_j^3" in in_symbols(Reader(), mean)


@pytest.mark.parametrize(
    ("inputs", "lines"),
    [
        ({}, 1),
        ({"shaft_centre_mm": 21}, 1),
        ({"shaft_centre_mm": 21, "axial_radius_mm": 40}, 2),
        ({"shaft_centre_mm": 21, "radial_position_mm": 10}, 2),
        ({"axial_radius_mm": 40}, 0),
    ],
)
def test_a_lever_has_an_equation_where_one_acts(inputs: Json, lines: int, catalogue: Catalogue) -> None:
    """Without the shaft's centre nothing can be worked out."""
    load = {"radial_N": 500.0, "axial_N": 100.0} | inputs
    step = steps_of(cycle(phase(10, 100), output_load=load), "HPN-20A-5", catalogue).get("output_bearing_load")
    assert len(step.lines if step else ()) == lines


def test_the_peak_of_a_phase_is_said_to_count_where_it_does(catalogue: Catalogue) -> None:
    varying = cycle(phase(10, 100, peak_torque_Nm=20), emergency_stop={"torque_Nm": 30})
    steps = steps_of(varying, "HPN-20A-5", catalogue)
    names = {code for code, step in steps.items() if any("its peak counts here" in note.text for note in step.notes)}
    assert names == {"repeated_peak_torque", "maximum_input_speed"}


def test_torques_that_an_equation_picks_are_said_beside_it(catalogue: Catalogue) -> None:
    stop = {"brake": {"torque_Nm": 5}}
    steps = steps_of(cycle(phase(10, 100), phase(-4, 50), emergency_stop=stop), "HPN-20A-5", catalogue)
    assert steps["position_error"].notes[0].text.startswith("T_lo and T_hi are the smallest and the largest torque")
    assert [note.text[:12] for note in steps["stop"].notes] == ["Upper bound:"]


def test_limits_name_their_table_and_page(catalogue: Catalogue) -> None:
    steps = steps_of(worked_example(), "HPN-20A-5", catalogue)
    sources = {c.code: c.source for step in steps.values() for c in step.comparisons}
    assert set(sources.values()) == {"table 12.1, page 12"}


def test_a_user_s_own_reserve_stands_in_the_limit(catalogue: Catalogue) -> None:
    steps = steps_of(worked_example(requirements={"utilisation": 0.8, "life_h": 1000.0}), "HPN-20A-5", catalogue)
    assert steps["average_torque"].comparisons[0].bound == 64
    assert steps["life"].comparisons[0].bound == 1250


@pytest.mark.parametrize(
    ("count", "numbers"), [(6, [1, 2, 3, 4, 5, 6]), (7, [1, 2, 3, 4, 7]), (2000, [1, 2, 3, 4, 2000])]
)
def test_sums_of_long_cycles_are_abbreviated_and_say_so(catalogue: Catalogue, count: int, numbers: list[int]) -> None:
    """n t of phase k is 0.5 (99 + k): the sum over all, whatever is written out."""
    phases = [phase(10.0 + k % 7, 100.0 + k, 0.5) for k in range(count)]
    step = steps_of(cycle(*phases, pause_s=1.0), "HPN-20A-5", catalogue)["average_torque"]
    sums = addition(Reader(), step)
    assert sums is not None
    assert [number for number, _ in sums.rows] == numbers
    assert sums.left_out == count - len(numbers)
    assert float(sums.totals[0].replace("\u202f", "")) == 0.5 * (99 * count + count * (count + 1) / 2)


def test_a_sum_of_inputs_alone_is_not_written_out(catalogue: Catalogue) -> None:
    assert addition(Reader(), steps_of(worked_example(), "HPN-20A-5", catalogue)["average_output_speed"]) is None


def test_where_equation_17_9_sets_no_limit_it_says_so(catalogue: Catalogue) -> None:
    step = steps_of(worked_example() | {"emergency_stop": {"torque_Nm": 149.0}}, "HPN-20A-5", catalogue)
    assert step["momentary_peak_count"].lines == ()
    assert "sets no limit" in step["momentary_peak_count"].notes[0].text


def test_a_gear_that_is_not_rated_shows_what_can_be_worked_out_and_no_more(catalogue: Catalogue) -> None:
    steps = steps_of(worked_example(), "HPN-40A-5", catalogue)
    assert [step.equation for step in steps.values() if step.equation] == ["17.2", "17.4", "17.5", "17.6"]
    assert not any(step.comparisons for step in steps.values())


def test_efficiency_curve_of_a_supplement_enters_phase_by_phase(supplemented: Supplement) -> None:
    rows = "size,ratio,torque_Nm,efficiency,source\n20A,5,10,0.8,own\n20A,5,50,0.9,own\n"
    catalogue = supplemented(efficiency=rows)
    steps = steps_of(worked_example(), "HPN-20A-5", catalogue)
    line = steps["motor_peak_torque"].lines[0]
    assert line.result.value == pytest.approx(40 / (5 * 0.875), rel=1e-12)
    assert "curve that you supplied" in steps["motor_rated_torque"].notes[0].text


OWN = "size,ratio,stages,inertia_kgm2,no_load_torque_Nm,source\n20A,5,1,0.002,0.5,own\n"
CURVE = "size,ratio,torque_Nm,efficiency,source\n20A,5,10,0.7,own\n20A,5,30,0.9,own\n"
LIMITS = {"peak_torque_Nm": 50.0, "rated_torque_Nm": 30.0}


@pytest.mark.parametrize("curve", [{}, {"efficiency": CURVE}], ids=["", "curve"])
@pytest.mark.parametrize("eta", [{}, {"efficiency": 0.85}], ids=["", "stated"])
@pytest.mark.parametrize("inertia", [{}, {"inertia_kgm2": 0.0004}], ids=["", "inertia"])
@pytest.mark.parametrize(
    "cycle_of", [worked_example()["duty_cycle"], {"motion": TURNING}, {"motion": LIFTING}], ids=range(3)
)
def test_a_motor_s_torques_are_those_of_its_checks_where_the_gear_has_inertia_and_losses(
    supplemented: Supplement, cycle_of: Json, inertia: Json, eta: Json, curve: dict[str, str]
) -> None:
    """Two ways: the formula as it is written out, and the kernel's arrays."""
    catalogue = supplemented(gears=OWN, **curve)
    document = {"duty_cycle": cycle_of, "requirements": {"motor": LIMITS | inertia, "ratios": [5]} | eta}
    steps = steps_of(document, "HPN-20A-5", catalogue)
    results = select(Application.model_validate(document), catalogue).candidate("HPN-20A-5")

    assert results is not None
    for code in ("motor_peak_torque", "motor_rated_torque"):
        demand = next(check.demand for check in results.checks if check.code == code)
        assert steps[code].lines[0].result.value == pytest.approx(demand, rel=1e-12)
        assert value_of(steps[code].lines[0].formula) == pytest.approx(demand, rel=1e-12)


@pytest.mark.parametrize(("cells", "has_message"), [("0.002,", True), (",0.5", True), (",", False)])
def test_what_a_supplement_says_of_the_gear_is_told_beside_the_motors_torque(
    supplemented: Supplement, cells: str, has_message: bool
) -> None:
    catalogue = supplemented(gears=f"size,ratio,stages,inertia_kgm2,no_load_torque_Nm,source\n20A,5,1,{cells},own\n")
    motor = LIMITS | {"inertia_kgm2": 0.0004}
    document = {"duty_cycle": {"motion": TURNING}, "requirements": {"motor": motor, "ratios": [5]}}
    step = steps_of(document, "HPN-20A-5", catalogue)["motor_peak_torque"]
    assert (OWN_FIGURES in [note.template for note in step.notes]) is has_message


def test_texts_in_a_formula_are_escaped() -> None:
    hostile = Variable("<script>", '"&<')
    markup = mathml(Reader(), (hostile, False), "<", (Term(hostile, 1.0), False), "=", (Constant(1.0), True))
    assert "<script" not in markup
    assert 'alttext="&lt;script&gt;_&quot;&amp;&lt; &lt; ' in markup

"""The calculation as shown, worked out again from the numbers in its MathML alone."""

import math
from typing import Any
from xml.etree import ElementTree
from xml.etree.ElementTree import Element

import pytest
from hypothesis import example, given

from hpn.application import Application
from hpn.catalogue import Catalogue, load_catalogue
from hpn.explain.calculation import EquationLine, Step
from hpn.explain.calculation.formula import value_of
from hpn.explain.calculation.mathml import addition, compared, in_symbols, result, substituted
from hpn.words.reader import Reader
from tests.build import Json, candidate, cycle, phase, worked_example
from tests.property.draw import applications
from tests.wire import calculation_of, select

CATALOGUE: Catalogue = load_catalogue()
READERS = (Reader(), Reader("de"), Reader(units=("lb_in", "rad_per_s", "lbf")))
NINE_DIGITS = 3e-7  # nine digits of T_av in the power 10/3, twice over where a root of a sum follows

LOADED = worked_example(output_load={"radial_N": 600.0, "axial_N": 300.0, "load_coefficient": 1.2, "model": "iso281"})
PER_PHASE = cycle(
    phase(40.0, 250.0, 0.3, radial_N=500.0),
    phase(-20.0, -100.0, 2.0, axial_N=300.0),
    pause_s=1.0,
    output_load={"life_basis": "L10"},
    requirements={"utilisation": 0.8, "life_h": 1000.0, "efficiency": 0.9, "motor": {"peak_torque_Nm": 9.0}},
)

TURNING = {
    "mechanism": {
        **{"type": "rotary", "inertia_kgm2": 2.0, "gravity_mass_kg": 20.0, "gravity_radius_mm": 250.0},
        **{"friction_torque_Nm": 2.0, "efficiency": 0.9, "ratio": 1.5},
    },
    "moves": [{"profile": "trapezoidal", "angle_deg": 90.0, "time_s": 1.5}],
}


def stopped(motor: Json, **brake: float) -> Json:
    """The turning mass stopped by a brake on a motor."""
    stop, asked = {"brake": {"torque_Nm": 12.0} | brake}, {"motor": motor, "position_radius_mm": 250.0}
    return {"duty_cycle": {"motion": TURNING}, "emergency_stop": stop, "requirements": {"efficiency": 0.8} | asked}


HEAVY = {"inertia_kgm2": 0.002}
STOPS = {
    "at once": (stopped(HEAVY), 7, 6),
    "after a dead time": (stopped(HEAVY, rise_time_s=0.03, reaction_time_s=0.05, speed_rpm=40.0), 7, 6),
    "of a motor that is heavy": (stopped({"inertia_kgm2": 0.5}, dynamic_factor=1.4), 6, 6),
    "of a motor that is not known": (stopped({}, rise_time_s=0.01), 6, 0),
    "by a brake that is too weak": (stopped(HEAVY, torque_Nm=0.5), 7, 0),
    "without a motion": (
        worked_example(
            emergency_stop={"brake": {"torque_Nm": 12.0}}, requirements={"load_inertia_kgm2": 0.8, "motor": HEAVY}
        ),
        *(4, 6),
    ),
    "without inertias": (worked_example(emergency_stop={"brake": {"torque_Nm": 12.0}}), 3, 0),
    "of a load that is pulled": (
        worked_example(
            emergency_stop={"brake": {"torque_Nm": 12.0, "load_torque_Nm": 9.0, "opposing_torque_Nm": 11.0}}
        ),
        *(3, 0),
    ),
}
"""Stops, and how many equations their torque and their course take."""


def steps_of(application: Json, designation: str) -> tuple[Json, tuple[Step, ...]]:
    """Entry of the reply, and the calculation of a gear."""
    selection = select(Application.model_validate(application), CATALOGUE)
    entry = candidate(selection.reply("/"), designation)
    gear = CATALOGUE.by_designation[designation]
    return entry, calculation_of(entry, gear, selection.evaluation.duty, CATALOGUE)


# --- A reader of MathML that knows nothing of the formulas ------------------------------------------------------------


def worked_out(element: Element, reader: Reader) -> float:
    """Value of a MathML element that holds numbers alone."""
    children = [child for child in element if child.tag != "mtext"]
    if element.tag == "mn":
        return number(element.text or "", reader)
    if element.tag == "mfrac":
        return worked_out(children[0], reader) / worked_out(children[1], reader)
    if element.tag == "msup":
        return float(worked_out(children[0], reader) ** worked_out(children[1], reader))
    if element.tag == "msqrt":
        return math.sqrt(worked_out(children[0], reader))
    if element.tag == "mroot":
        return float(worked_out(children[0], reader) ** (1 / worked_out(children[1], reader)))
    assert element.tag == "mrow", element.tag
    return row(children, reader)


def row(children: list[Element], reader: Reader) -> float:
    """Value of terms with operators between them."""
    if children[0].tag == "mi":  # max ( a ; b )
        return max(worked_out(child, reader) for child in children[1:] if child.tag != "mo")
    if children[0].tag == "mo":  # brackets, or the bars of a magnitude
        inside = worked_out(children[1], reader)
        return abs(inside) if children[0].text == "|" else inside
    value = worked_out(children[0], reader)
    for operator, operand in zip(children[1::2], children[2::2], strict=True):
        other = worked_out(operand, reader)
        value = {"+": value + other, "−": value - other, "·": value * other, "/": value / (other or math.nan)}[
            operator.text or ""
        ]
    return value


def number(text: str, reader: Reader) -> float:
    """A number as a page shows it."""
    mantissa, _, exponent = text.partition("·10")
    plain = "".join(mantissa.split())
    if reader.language == "de":
        plain = plain.replace(".", "").replace(",", ".")
    power = exponent.translate(str.maketrans("⁻⁰¹²³⁴⁵⁶⁷⁸⁹", "-0123456789"))
    return float(plain.replace("−", "-")) * 10.0 ** int(power or 0)


def sides(markup: str) -> list[list[Element]]:
    """Elements of an equation between its signs of equality."""
    content = ElementTree.fromstring(markup)[0]
    parts: list[list[Element]] = [[]]
    for child in content:
        if child.tag == "mo" and child.text in ("=", "→", "≤", "≥"):
            parts.append([])
        else:
            parts[-1].append(child)
    return parts


def shown(line: EquationLine, reader: Reader) -> tuple[float, float]:
    """Value of the substituted numbers of a line, and the value that the page shows for them."""
    (_, [formula]), (_, [first], *_) = sides(substituted(reader, line)), sides(result(reader, line))
    return worked_out(formula, reader), worked_out(first, reader)


# --- Tests ------------------------------------------------------------------------------------------------------------


BEHIND = worked_example(
    output_load={"radial_N": 600.0, "axial_N": 100.0, "radial_position_mm": -45.0}
    | {"axial_radius_mm": 40.0, "shaft_centre_mm": 21.0}
)


@given(applications())
@example(LOADED)
@example(PER_PHASE)
@example(BEHIND)
def test_substituted_numbers_give_the_result_that_is_printed_in_every_language_and_unit(application: Json) -> None:
    for designation in ("HPN-20A-5", "HPN-32A-25"):
        _, steps = steps_of(application, designation)
        for reader in READERS:
            for step in steps:
                for line in step.lines:
                    found, printed = shown(line, reader)
                    scale = max(abs(printed), 1e-9)
                    assert abs(found - printed) <= NINE_DIGITS * scale, (step.code, reader, found, printed)


@given(applications())
@example(LOADED)
@example(PER_PHASE)
def test_the_rows_of_a_sum_add_up_to_the_sum_that_its_equation_takes(application: Json) -> None:
    """Added up from the printed rows; the sum itself is worked out from all phases with every digit."""
    _, steps = steps_of(application, "HPN-20A-5")
    for reader in READERS:
        for step, sums in ((step, addition(reader, step)) for step in steps):
            if sums is None or sums.left_out:
                continue
            columns = zip(*(values for _, values in sums.rows), strict=True)
            for column, printed in zip(columns, sums.totals, strict=True):
                if printed:
                    found, given_sum = math.fsum(number(value, reader) for value in column), number(printed, reader)
                    assert math.isclose(found, given_sum, rel_tol=1e-8), (step.code, reader)  # nine digits each
                    equations = " ".join(substituted(reader, line) for line in step.lines)
                    assert f"<mn>{printed}</mn>" in equations


@given(applications())
@example(LOADED)
@example(PER_PHASE)
def test_every_line_gives_the_figure_of_the_reply(application: Json) -> None:
    entry, steps = steps_of(application, "HPN-20A-5")
    for step in steps:
        for line in step.lines:
            exact = value_of(line.formula)
            value = math.floor(exact * (1 + 1e-12)) if line.rounded_down else exact
            assert math.isclose(value, line.result.value, rel_tol=1e-11, abs_tol=1e-300), step.code
    results = {step.code: step.lines[-1].result.value for step in steps if step.lines}
    for code, name in (
        ("average_input_speed", "average_input_speed_rpm"),
        ("maximum_input_speed", "maximum_input_speed_rpm"),
        ("life", "life_L10_h"),
        ("momentary_peak_count", "momentary_peak_count"),
        ("motor_peak_torque", "motor_peak_torque_Nm"),
        ("motor_rated_torque", "motor_rated_torque_Nm"),
        ("bearing_life", "bearing_life_L10_h"),
    ):
        assert results.get(code) == entry[name], code


@pytest.mark.parametrize("name", STOPS)
def test_every_line_of_a_stop_by_the_brake_gives_its_result_and_the_figures_of_the_reply(name: str) -> None:
    entry, steps = steps_of(STOPS[name][0], "HPN-20A-5")
    lines = {step.code: step.lines for step in steps}
    for line in (*lines["stop"], *lines.get("stop_course", ())):
        assert value_of(line.formula) == pytest.approx(line.result.value, rel=1e-11), line.result
        for reader in READERS:
            found, printed = shown(line, reader)
            assert found == pytest.approx(printed, rel=NINE_DIGITS), (line.result, reader)
    assert (len(lines["stop"]), len(lines.get("stop_course", ()))) == STOPS[name][1:]
    assert lines["stop"][-1].result.value == entry["stop_torque_Nm"]
    course = [entry[figure] for figure in ("stopping_time_s", "stopping_angle_deg", "stop_energy_J")]
    shown_course = [line.result.value for line in lines.get("stop_course", ())[-3:]]
    assert shown_course == (course if shown_course else [])


@given(applications())
@example(LOADED)
@example(PER_PHASE)
def test_every_load_check_is_compared_once_with_the_figures_of_the_reply(application: Json) -> None:
    entry, steps = steps_of(application, "HPN-20A-5")
    properties = {"ambient_temperature", "backlash", "torsional_stiffness", "weight", "length"}
    expected = {
        check["code"]: (check["demand"], check["limit"])
        for check in entry["checks"]
        if check["code"] not in properties and None not in (check["demand"], check["limit"])
    }
    comparisons = [comparison for step in steps for comparison in step.comparisons]
    assert {c.code: (c.value, c.limit) for c in comparisons} == expected
    assert len(comparisons) == len(expected)
    for comparison in comparisons:
        markup = compared(READERS[0], comparison)
        *_, [limit] = sides(markup)
        assert worked_out(limit, READERS[0]) == pytest.approx(comparison.bound, rel=1e-8)


@given(applications())
@example(LOADED)
def test_every_equation_that_applies_is_there_in_symbols(application: Json) -> None:
    _, steps = steps_of(application, "HPN-20A-5")
    expected = ["17.2", "17.4", "17.5", "17.6", "17.7"]
    expected += ["17.8", "17.9"] if "emergency_stop" in application else []
    assert [step.equation for step in steps if step.equation] == [*expected, "17.10"]
    codes = [step.code for step in steps if not step.equation]
    bearing: list[Any] = ["output_bearing_load", "output_bearing_life", "bearing_life"]
    expected = [
        "motor_peak_torque",
        "motor_rated_torque",
        "torque_limit",
        *(bearing if "output_load" in application else []),
    ]
    expected += ["natural_frequency"] if "load_inertia_kgm2" in application.get("requirements", {}) else []
    assert codes == [*expected, "position_error"]
    for line in (line for step in steps for line in step.lines):
        letters = ElementTree.fromstring(in_symbols(READERS[0], line)).iter("mi")
        assert next(letters).text == line.result.symbol.letter

"""Equations 17.2 to 17.10 with the numbers of one gear, and the effect of intermediate rounding."""

import math
from collections.abc import Iterable

from hpn.explain.calculation.formula import TEN_THIRDS, Constant, Root, Term, Variable, over_phases, value_of
from hpn.explain.calculation.sheet import CalculationSheet, EquationLine, Step, step_of_check
from hpn.physics.equations import ROUNDING
from hpn.words.quantities import DUTY
from hpn.words.wording import N_, Quantity, Sentence

VARYING = N_(
    "Where torque and speed vary in a phase, T is the mean weighted as in this equation, |n| to the first power and "
    "|T| to the power 10/3, and n the mean speed."
)
PEAKS = N_("Where torque and speed vary in a phase, its peak counts here.")

LARGEST_WORTH_ROUNDING = 1e6
"""Upper limit of numbers that are rounded to whole numbers by hand."""


def _average_torque(sheet: CalculationSheet) -> Iterable[Step]:
    above = over_phases(lambda n, t, T: abs(n) * t * T**TEN_THIRDS, sheet.speed, sheet.time, sheet.torque)
    notes = [
        Sentence(
            N_(
                "The handbook tabulates no T_A: its worked example compares T_av with T_N (equation 18.2), and so does "
                "this tool. Equation 17.3 is a picture that could not be read."
            )
        )
    ]
    if any(phase.torque_Nm < 0 or phase.speed_rpm < 0 for phase in sheet.application.duty_cycle.load_phases):
        notes.append(Sentence(N_("Torques and speeds enter by magnitude, whatever their sign.")))
    if sheet.varies:
        notes.append(Sentence(VARYING))
    line = EquationLine(sheet.T_av, Root(above / sheet.travel, TEN_THIRDS))
    yield step_of_check("average_torque", (line,), sheet.compared("average_torque", sheet.T_av), tuple(notes))


def _average_output_speed(sheet: CalculationSheet) -> Iterable[Step]:
    named = DUTY["average_output_speed_rpm"]
    line = EquationLine(sheet.n_out_av, sheet.travel / sheet.cycle_time)
    yield Step("average_output_speed", named.name, named.equation, (line,))


# --- Input speeds -----------------------------------------------------------------------------------------------------


def _average_input_speed(sheet: CalculationSheet) -> Iterable[Step]:
    line = _average_input_speed_line(sheet)
    codes = ("average_input_speed", "motor_rated_speed")
    limits = tuple(limit for code in codes for limit in sheet.compared(code, line.result))
    yield step_of_check("average_input_speed", (line,), limits, _hand_input_speed(sheet, line))


def _average_input_speed_line(sheet: CalculationSheet) -> EquationLine:
    return EquationLine(sheet.n_in_av, sheet.i * sheet.n_out_av)


def _hand_input_speed(sheet: CalculationSheet, line: EquationLine) -> tuple[Sentence, ...]:
    if (speed := _hand(sheet.n_out_av.value)) is None:
        return ()
    by_hand = line.by_hand({sheet.n_out_av.symbol: speed})
    if math.isclose(by_hand, line.result.value, rel_tol=ROUNDING):
        return ()
    values = {"speed": Quantity(speed, "rpm", 6), "result": Quantity(by_hand, "rpm", 9)}
    text = N_("With n_out,av rounded to {speed} by hand you would get {result}; this tool rounds nothing in between.")
    return (Sentence(text, values),)


def _maximum_input_speed(sheet: CalculationSheet) -> Iterable[Step]:
    line = EquationLine(sheet.n_in_max, sheet.n_out_max * sheet.i)
    codes = ("maximum_input_speed", "motor_speed")
    limits = tuple(limit for code in codes for limit in sheet.compared(code, sheet.n_in_max))
    yield step_of_check("maximum_input_speed", (line,), limits, _on_peaks(sheet))


# --- Peaks ------------------------------------------------------------------------------------------------------------


def _peaks(sheet: CalculationSheet) -> Iterable[Step]:
    tested = {"repeated_peak_torque": sheet.T_max, "momentary_peak_torque": sheet.T_k}
    for code, torque in tested.items():
        if torque is not None and (limit := sheet.compared(code, torque)):
            notes = _on_peaks(sheet) if torque is sheet.T_max else ()
            yield step_of_check(code, (), limit, notes)


def _on_peaks(sheet: CalculationSheet) -> tuple[Sentence, ...]:
    return (Sentence(PEAKS),) if sheet.varies else ()


def _stops(sheet: CalculationSheet) -> Iterable[Step]:
    T_k, T_R = sheet.T_k, sheet.rating("repeated_peak_torque_Nm")
    if T_k is None or T_R is None:
        return
    allowed = sheet.figure("momentary_peak_count")
    if allowed is None:
        values = {"stop": Quantity(T_k.value, "Nm", 9), "limit": Quantity(T_R.value, "Nm", 9)}
        text = N_("The equation holds for T_k > T_R. Here T_k is {stop} and T_R is {limit}: it sets no limit.")
        yield step_of_check("momentary_peak_count", notes=(Sentence(text, values),))
        return
    exponent = 8.5 - 1.5 * (T_k / T_R)
    x = Term(Variable("x"), value_of(exponent))
    count = EquationLine(allowed, 10**x, rounded_down=True)
    expected = sheet.input_of("emergency_stop.count") or allowed
    limit = sheet.compared("momentary_peak_count", expected)
    yield step_of_check("momentary_peak_count", (EquationLine(x, exponent), count), limit, _hand_stops(x, count))


def _hand_stops(x: Term, count: EquationLine) -> tuple[Sentence, ...]:
    rounded = round(x.value, 2)
    by_hand = count.by_hand({x.symbol: rounded})
    if by_hand == count.result.value:
        return ()
    values = {"x": Quantity(rounded, "", 6), "result": Quantity(by_hand, "", 15)}
    return (Sentence(N_("With x rounded to {x} by hand you would get {result} stops."), values),)


# --- Life -------------------------------------------------------------------------------------------------------------


def _life(sheet: CalculationSheet) -> Iterable[Step]:
    T_N, L_10 = sheet.rating("rated_torque_Nm"), sheet.figure("life_L10_h")
    if T_N is None:
        return
    if L_10 is None:
        note = Sentence(N_("T_av is 0 or so small that the equation gives an unlimited life."))
        yield step_of_check("life", notes=(note,))
        return
    rated = Term(Variable("n", "rated"), sheet.catalogue.rated_input_speed_rpm, "rpm")
    life = Constant(sheet.catalogue.life_at_rated_torque_h, "h")
    formula = life * (rated / sheet.n_in_av) * (T_N / sheet.T_av) ** TEN_THIRDS
    basis = Sentence(
        N_(
            "n_rated is 3000 rpm for HPN (glossary). The equation calls its result L10; the glossary describes the "
            "rated torque on a basis of 50 % failures. The handbook leaves open which applies."
        )
    )
    line = EquationLine(L_10, formula)
    yield step_of_check("life", (line,), sheet.compared("life", L_10), (*_hand_life(sheet, line), basis))


def _hand_life(sheet: CalculationSheet, line: EquationLine) -> tuple[Sentence, ...]:
    torque, output_speed = _hand(sheet.T_av.value), _hand(sheet.n_out_av.value)
    if not torque or not output_speed:
        return ()
    speed = _average_input_speed_line(sheet).by_hand({sheet.n_out_av.symbol: output_speed})
    by_hand = line.by_hand({sheet.T_av.symbol: torque, sheet.n_in_av.symbol: speed})
    if math.isclose(by_hand, line.result.value, rel_tol=ROUNDING):
        return ()
    values = {
        "torque": Quantity(torque, "Nm", 6),
        "speed": Quantity(speed, "rpm", 6),
        "result": Quantity(round(by_hand), "h", 15),
    }
    text = N_("With T_av rounded to {torque} and n_in,av to {speed} by hand you would get {result}.")
    if _is_printed(sheet):
        text = N_(
            "With T_av rounded to {torque} and n_in,av to {speed} by hand you would get {result}, as the handbook does "
            "in equation 18.9."
        )
    return (Sentence(text, values),)


def _is_printed(sheet: CalculationSheet) -> bool:
    """True for the worked example of the handbook."""
    example = type(sheet.application).worked_example()
    return sheet.application.duty_cycle == example.duty_cycle and sheet.gear.designation == "HPN-20A-5"


def _hand(value: float) -> float | None:
    """Figure rounded by hand as in the worked example: whole, or two digits if small; None outside the range."""
    if not 0.01 <= value < LARGEST_WORTH_ROUNDING:
        return None
    return float(round(value)) if value >= 10 else float(f"{value:.2g}")


HANDBOOK = (
    *(_average_torque, _average_output_speed, _average_input_speed, _maximum_input_speed),
    *(_peaks, _stops, _life),
)
"""Steps in the order of the handbook's page 17."""

"""Equations 17.2 to 17.10 with the numbers of one gear, and what rounding in between would make of them."""

import math
from collections.abc import Iterable

from hpn.calculation.formula import (
    TEN_THIRDS,
    Constant,
    Difference,
    Magnitude,
    Power,
    Product,
    Quotient,
    Root,
    Symbol,
    Term,
)
from hpn.calculation.sheet import Line, Sheet, Step
from hpn.equations import ROUNDING
from hpn.wording import N_, Quantity, Sentence

LARGEST_WORTH_ROUNDING = 1e6
"""Beyond it nobody rounds to whole numbers by hand."""


def handbook_steps(sheet: Sheet) -> Iterable[Step]:
    """Steps in the order of the handbook's page 17."""
    yield _average_torque(sheet)
    yield _average_output_speed(sheet)
    yield _average_input_speed(sheet)
    yield _maximum_input_speed(sheet)
    yield from _peaks(sheet)
    yield from _stops(sheet)
    yield from _life(sheet)


def _average_torque(sheet: Sheet) -> Step:
    above = sheet.series(
        lambda index, k: Product(
            (
                Magnitude(Product((sheet.speed(index, k), sheet.time(index, k)))),
                Power(sheet.torque(index, k), TEN_THIRDS),
            )
        ),
        lambda: sheet.n * sheet.t * sheet.T ** (10 / 3),
    )
    notes = [
        Sentence(
            N_(
                "The handbook tabulates no T_A: its worked example compares T_av with T_N (equation 18.2), and so does "
                "this tool. Equation 17.3 is a picture that could not be read."
            )
        )
    ]
    if any(phase.torque_Nm < 0 or phase.speed_rpm < 0 for phase in sheet.application.duty_cycle.phases):
        notes.append(Sentence(N_("Torques and speeds enter by magnitude, whatever their sign.")))
    return Step(
        "average_torque",
        N_("Load limit 1: average output torque"),
        "17.2",
        (Line(sheet.T_av, Root(Quotient(above, sheet.travel), TEN_THIRDS)),),
        sheet.compared("average_torque", sheet.T_av, Symbol("T", "A"), Symbol("T", "N"), figure="rated_torque_Nm"),
        tuple(notes),
    )


def _average_output_speed(sheet: Sheet) -> Step:
    line = Line(sheet.n_out_av, Quotient(sheet.travel, sheet.cycle_time))
    return Step("average_output_speed", N_("Average output speed"), "17.4", (line,))


def _average_input_speed(sheet: Sheet) -> Step:
    limit = sheet.compared(
        "average_input_speed", sheet.n_in_av, Symbol("n", "av(max)"), figure="average_input_speed_rpm"
    )
    line = Line(sheet.n_in_av, Product((sheet.i, sheet.n_out_av)))
    return Step(
        "average_input_speed", N_("Average input speed"), "17.5", (line,), limit, _hand_input_speed(sheet), trivial=True
    )


def _hand_input_speed(sheet: Sheet) -> tuple[Sentence, ...]:
    speed = _hand(sheet.n_out_av.value)
    if speed is None or speed * sheet.gear.ratio == sheet.n_in_av.value:
        return ()
    values = {"speed": Quantity(speed, "rpm", 6), "result": Quantity(speed * sheet.gear.ratio, "rpm", 9)}
    text = N_("With n_out_av rounded to {speed} by hand you would get {result}; this tool rounds nothing in between.")
    return (Sentence(text, values),)


def _maximum_input_speed(sheet: Sheet) -> Step:
    limits = (
        *sheet.compared(
            "maximum_input_speed", sheet.n_in_max, Symbol("n", "in(max)"), figure="maximum_input_speed_rpm"
        ),
        *sheet.compared("motor_speed", sheet.n_in_max, Symbol("n", "motor")),
    )
    line = Line(sheet.n_in_max, Product((sheet.n_out_max, sheet.i)))
    return Step("maximum_input_speed", N_("Maximum input speed"), "17.6", (line,), limits, trivial=True)


def _peaks(sheet: Sheet) -> Iterable[Step]:
    limit = sheet.compared("repeated_peak_torque", sheet.T_max, Symbol("T", "R"), figure="repeated_peak_torque_Nm")
    if limit:
        yield Step("repeated_peak_torque", N_("Load limit 2: T_R"), "17.7", (), limit, trivial=True)
    if sheet.T_k is None:
        return
    limit = sheet.compared("momentary_peak_torque", sheet.T_k, Symbol("T", "M"), figure="momentary_peak_torque_Nm")
    if limit:
        yield Step("momentary_peak_torque", N_("Load limit 3: T_M"), "17.8", (), limit, trivial=True)


def _stops(sheet: Sheet) -> Iterable[Step]:
    T_k, T_R = sheet.T_k, sheet.gear.repeated_peak_torque_Nm
    if T_k is None or T_R is None:
        return
    title = N_("Allowable number of momentary peak torques")
    if T_k.value <= T_R:
        values = {"stop": Quantity(T_k.value, "Nm", 9), "limit": Quantity(T_R, "Nm", 9)}
        note = Sentence(
            N_("The equation holds for T_k > T_R. Here T_k is {stop} and T_R is {limit}: it sets no limit."), values
        )
        yield Step("momentary_peak_count", title, "17.9", notes=(note,))
        return
    x = 8.5 - 1.5 * (T_k.value / T_R)
    exponent = Term(Symbol("x"), x)
    ratio = Quotient(T_k, Term(Symbol("T", "R"), T_R, "Nm"))
    allowed = Term(Symbol("N", "k max"), sheet.candidate["momentary_peak_count"])
    lines = (
        Line(exponent, Difference(Constant(8.5), Product((Constant(1.5), ratio)))),
        Line(allowed, Power(Constant(10), exponent), rounded_down=True),
    )
    stop = sheet.application.emergency_stop
    count = Term(Symbol("N", "k"), stop.count) if stop and stop.count is not None else allowed
    limit = sheet.compared("momentary_peak_count", count, allowed.symbol, figure="repeated_peak_torque_Nm")
    yield Step("momentary_peak_count", title, "17.9", lines, limit, _hand_stops(x, allowed.value))


def _hand_stops(x: float, allowed: float) -> tuple[Sentence, ...]:
    by_hand = float(math.floor(10.0 ** round(x, 2) * (1 + ROUNDING)))
    if by_hand == allowed:
        return ()
    values = {"x": Quantity(round(x, 2), "", 6), "result": Quantity(by_hand, "", 15)}
    return (Sentence(N_("With x rounded to {x} by hand you would get {result} stops."), values),)


def _life(sheet: Sheet) -> Iterable[Step]:
    T_N, life = sheet.gear.rated_torque_Nm, sheet.candidate["life_L10_h"]
    if T_N is None:
        return
    L_10 = Term(Symbol("L", "10"), 0.0 if life is None else life, "h")
    limit = sheet.compared("life", L_10, Symbol("L", "required"))
    if life is None:
        note = Sentence(N_("T_av is 0 or so small that the equation gives a life without limit."))
        yield Step("life", N_("Life"), "17.10", notes=(note,))
        return
    rated = Term(Symbol("n", "rated"), sheet.catalogue.rated_input_speed_rpm, "rpm")
    formula = Product(
        (
            Constant(sheet.catalogue.life_at_rated_torque_h, "h"),
            Quotient(rated, sheet.n_in_av),
            Power(Quotient(Term(Symbol("T", "N"), T_N, "Nm"), sheet.T_av), TEN_THIRDS),
        )
    )
    basis = Sentence(
        N_(
            "n_rated is 3000 rpm for HPN (glossary). The equation calls its result L10; the glossary describes the "
            "rated torque on a basis of 50 % failures. The handbook does not settle which holds."
        )
    )
    notes = (*_hand_life(sheet, T_N, life), basis)
    yield Step("life", N_("Life"), "17.10", (Line(L_10, formula),), limit, notes)


def _hand_life(sheet: Sheet, T_N: float, life: float) -> tuple[Sentence, ...]:
    torque, speed = _hand(sheet.T_av.value), _hand_speed(sheet)
    if not torque or not speed:
        return ()
    catalogue = sheet.catalogue
    rated = catalogue.life_at_rated_torque_h * catalogue.rated_input_speed_rpm
    by_hand = rated / speed * (T_N / torque) ** (10 / 3)
    if math.isclose(by_hand, life, rel_tol=ROUNDING):
        return ()
    values = {
        "torque": Quantity(torque, "Nm", 6),
        "speed": Quantity(speed, "rpm", 6),
        "result": Quantity(round(by_hand), "h", 15),
    }
    text = N_("With T_av rounded to {torque} and n_in_av to {speed} by hand you would get {result}.")
    if _is_printed(sheet):
        text = N_(
            "With T_av rounded to {torque} and n_in_av to {speed} by hand you would get {result}, as the handbook does "
            "in equation 18.9."
        )
    return (Sentence(text, values),)


def _is_printed(sheet: Sheet) -> bool:
    """Whether the handbook works this very example out."""
    example = type(sheet.application).worked_example()
    return sheet.application.duty_cycle == example.duty_cycle and sheet.gear.designation == "HPN-20A-5"


def _hand(value: float) -> float | None:
    """A figure as somebody would round it by hand, as the worked example does: whole, or two digits where small."""
    if not 0.01 <= value < LARGEST_WORTH_ROUNDING:
        return None
    return float(round(value)) if value >= 10 else float(f"{value:.2g}")


def _hand_speed(sheet: Sheet) -> float | None:
    """Average input speed from the rounded average output speed."""
    speed = _hand(sheet.n_out_av.value)
    return None if speed is None else speed * sheet.gear.ratio

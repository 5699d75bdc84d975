"""The output bearing: equivalent load of each phase and of the cycle, the load that its life allows, and its life."""

from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

from hpn import bearing
from hpn.application import OutputLoad
from hpn.calculation.formula import (
    Constant,
    Formula,
    Largest,
    Power,
    Product,
    Quotient,
    Root,
    Series,
    Sum,
    Symbol,
    Term,
)
from hpn.calculation.sheet import Line, Sheet, Step
from hpn.wording import N_, Sentence

SHOWN_LOADS = 6
STANDING = Sentence(N_("Computed between the two published limits; the handbook's printed curve was not available."))
SUPPLIED = Sentence(
    N_("P is the factor by which the load exceeds the curve that you supplied, along the load's own direction.")
)
EXPONENT = Constant(3)


def bearing_steps(sheet: Sheet) -> Iterable[Step]:
    """Steps of the output bearing where loads are given and its limits are known."""
    load = sheet.application.loads
    P = None if load is None else _equivalent_loads(sheet, load)
    if load is None or P is None or sheet.candidate["checks"] == []:
        return
    f_w = Term(Symbol("f", "w"), load.load_coefficient)
    yield _largest(sheet, load, P, f_w)
    mean = bearing.mean_equivalent_load(equivalent_load=P, speed_rpm=sheet.n, duration_s=sheet.t).item()
    P_m = Term(Symbol("P", "m"), mean)
    yield _mean(sheet, load, P, P_m, f_w)
    yield from _life(sheet, P_m, f_w)


def _equivalent_loads(sheet: Sheet, load: OutputLoad) -> NDArray[np.float64] | None:
    """Equivalent load P of every phase; None where it is not rated."""
    radial, axial = (values[0] for values in sheet.duty.loads_N)
    if load.model == "digitised":
        curve = sheet.catalogue.curves.get(sheet.gear.size)
        return None if curve is None else curve.equivalent_load(radial, axial)
    F_R, F_A = sheet.gear.dynamic_radial_load_N, sheet.gear.dynamic_axial_load_N
    if F_R is None or F_A is None:
        return None
    model = bearing.iso281_load if load.model == "iso281" else bearing.linear_load
    return model(radial=radial / F_R, axial=axial / F_A)


# --- Largest load -----------------------------------------------------------------------------------------------------


def _largest(sheet: Sheet, load: OutputLoad, P: NDArray[np.float64], f_w: Term) -> Step:
    """Equivalent load of each different load, and the largest one against the published maxima."""
    radial, axial = (values[0].tolist() for values in sheet.duty.loads_N)
    first: dict[tuple[float, float], int] = {}
    for k in range(sheet.count):
        first.setdefault((radial[k], axial[k]), k)
    phases = list(first.values())
    worst = max(phases, key=lambda k: P.item(k))
    shown = sorted({*phases[: SHOWN_LOADS - 1], worst})
    notes = [SUPPLIED] if load.model == "digitised" else [STANDING]
    lines: list[Line] = []
    if load.model != "digitised":
        lines = [_equivalent_load(sheet, load.model, k, P.item(k), len(phases) == 1) for k in shown]
        if len(shown) < len(phases):
            values = {"shown": len(shown), "all": len(phases)}
            text = N_("{shown} of {all} different loads are shown, the largest among them.")
            notes.append(Sentence(text, values))
    tested = Product((f_w, _symbol_of_phase("P", worst, P.item(worst), len(phases) == 1)))
    limit = sheet.compared("output_bearing_load", tested, figure="dynamic_radial_load_N")
    title = N_("Output bearing: equivalent load")
    return Step("output_bearing_load", title, None, tuple(lines), limit, tuple(notes))


def _symbol_of_phase(letter: str, k: int, value: float, alone: bool, unit: str = "") -> Term:
    """Quantity of a phase; without an index where all phases are alike."""
    index = letter.partition("_")[2]
    place = "" if alone else str(k + 1)
    return Term(Symbol(letter.partition("_")[0], f"{index} {place}".strip()), value, unit)


def _equivalent_load(sheet: Sheet, model: str, k: int, P: float, alone: bool) -> Line:
    radial, axial = (values[0].item(k) for values in sheet.duty.loads_N)
    gear = sheet.gear
    assert gear.dynamic_radial_load_N is not None and gear.dynamic_axial_load_N is not None  # P was worked out
    r = Quotient(
        _symbol_of_phase("F_R", k, radial, alone, "N"), Term(Symbol("F", "R dyn(max)"), gear.dynamic_radial_load_N, "N")
    )
    a = Quotient(
        _symbol_of_phase("F_A", k, axial, alone, "N"), Term(Symbol("F", "A dyn(max)"), gear.dynamic_axial_load_N, "N")
    )
    formula: Formula = Sum((r, a))
    if model == "iso281":
        formula = Largest((r, Sum((Product((Constant(bearing.RADIAL_FACTOR), r)), a))))
    return Line(_symbol_of_phase("P", k, P, alone), formula)


# --- Life -------------------------------------------------------------------------------------------------------------


def _mean(sheet: Sheet, load: OutputLoad, P: NDArray[np.float64], P_m: Term, f_w: Term) -> Step:
    """Equivalent load of the cycle, and the load k that the required life allows."""
    reference_speed, reference_life = sheet.catalogue.bearing_reference
    required: Formula = Term(Symbol("L", "required"), load.life_h, "h")
    if load.life_basis == "L10":
        required = Product((Constant(bearing.L50_PER_L10), required))
    k = Term(Symbol("k"), sheet.checks["output_bearing_life"]["limit"])
    above = Product((Constant(reference_speed, "rpm"), Constant(reference_life, "h")))
    lines = (
        Line(P_m, Root(Quotient(_damage(sheet, P), sheet.travel), EXPONENT)),
        Line(k, Root(Quotient(above, Product((sheet.n_out_av, required))), EXPONENT)),
    )
    limit = sheet.compared("output_bearing_life", Product((f_w, P_m)), k.symbol, figure="dynamic_radial_load_N")
    note = Sentence(N_("ISO 281, ball bearings, exponent 3; the published loads hold for L50 = 20000 h at 100 rpm."))
    return Step("output_bearing_life", N_("Output bearing: load that its life allows"), None, lines, limit, (note,))


def _damage(sheet: Sheet, P: NDArray[np.float64]) -> Series:
    return sheet.series(
        lambda index, k: Product(
            (sheet.speed(index, k), sheet.time(index, k), Power(Term(Symbol("P", index), P.item(k)), EXPONENT))
        ),
        lambda: sheet.n * sheet.t * P**3,
    )


def _life(sheet: Sheet, P_m: Term, f_w: Term) -> Iterable[Step]:
    title = N_("Output bearing: life")
    L50, L10 = sheet.candidate["bearing_life_L50_h"], sheet.candidate["bearing_life_L10_h"]
    if L50 is None or L10 is None:
        note = Sentence(N_("The equivalent load is 0 or so small that the bearing life has no limit."))
        yield Step("bearing_life", title, None, notes=(note,))
        return
    speed, life = sheet.catalogue.bearing_reference
    half = Term(Symbol("L", "50"), L50, "h")
    by_speed = Quotient(Constant(speed, "rpm"), sheet.n_out_av)
    lines = (
        Line(half, Quotient(Product((Constant(life, "h"), by_speed)), Power(Product((f_w, P_m)), EXPONENT))),
        Line(Term(Symbol("L", "10"), L10, "h"), Quotient(half, Constant(bearing.L50_PER_L10))),
    )
    note = Sentence(
        N_(
            "L10 = L50 / 5 is the relation of the maker's other handbooks, not printed in this one; a Weibull slope "
            "of 10/9 gives 5.45."
        )
    )
    yield Step("bearing_life", title, None, lines, (), (note,))

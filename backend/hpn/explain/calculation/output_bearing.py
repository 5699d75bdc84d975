"""The output bearing: equivalent load of each phase and of the cycle, the load that its life allows, and its life."""

from collections.abc import Iterable

from hpn.application import OutputLoad
from hpn.engine.figures import phase_loads
from hpn.explain.calculation.formula import (
    Constant,
    Formula,
    Largest,
    PhaseValues,
    Power,
    Product,
    Quotient,
    Root,
    Sum,
    Term,
    Variable,
    over_phases,
)
from hpn.explain.calculation.sheet import Line, Sheet, Step, known, step_of_check
from hpn.physics import bearing
from hpn.words.quantities import CANDIDATE, ENVELOPE_BASIS
from hpn.words.wording import N_, Sentence

SHOWN_LOADS = 6
SUPPLIED = Sentence(
    N_("P is the factor by which the load exceeds the curve that you supplied, along the load’s own direction.")
)
EXPONENT = Constant(3)
P = Variable("P")


def bearing_steps(sheet: Sheet) -> Iterable[Step]:
    """Steps of the output bearing where loads are given and its limits are known."""
    load, life = sheet.application.loads, sheet.candidate.check("output_bearing_life")
    if load is None or life is None or life.demand is None or life.limit is None:
        return
    f_w = known(sheet.given("output_load.load_coefficient"))
    of_phases = PhaseValues(P, phase_loads(sheet.duty, sheet.gears)[0, 0] / f_w.value)
    mean, k = Term(P.of_phase("m"), life.demand / f_w.value), Term(Variable("k"), life.limit)
    yield _largest(sheet, load, of_phases, f_w)
    yield _mean(sheet, load, of_phases, mean, k, f_w)
    yield _life(sheet, mean, f_w)


# --- Largest load -----------------------------------------------------------------------------------------------------


def _largest(sheet: Sheet, load: OutputLoad, loads: PhaseValues, f_w: Term) -> Step:
    """Step of the equivalent load of each different load, the largest one compared with the published maxima."""
    first: dict[tuple[float, float], int] = {}
    for place, pair in enumerate(zip(sheet.radial.values.tolist(), sheet.axial.values.tolist(), strict=True)):
        first.setdefault(pair, place)
    phases = list(first.values())
    worst = max(phases, key=loads.values.item)
    index = {place: "" if len(phases) == 1 else str(place + 1) for place in phases}
    notes = [SUPPLIED if load.model == "digitised" else Sentence(ENVELOPE_BASIS[load.model])]
    lines: list[Line] = []
    if load.model != "digitised":
        shown = sorted({*phases[: SHOWN_LOADS - 1], worst})
        lines = [_equivalent_load(sheet, load.model, place, loads.term(index[place], place)) for place in shown]
        if len(shown) < len(phases):
            values = {"shown": len(shown), "all": len(phases)}
            text = N_("{shown} of {all} different loads are shown, the largest among them.")
            notes.append(Sentence(text, values))
    limit = sheet.compared("output_bearing_load", Product((f_w, loads.term(index[worst], worst))))
    return step_of_check("output_bearing_load", tuple(lines), limit, tuple(notes))


def _equivalent_load(sheet: Sheet, model: str, place: int, P: Term) -> Line:
    r = Quotient(sheet.radial.term(P.symbol.index, place), known(sheet.rating("dynamic_radial_load_N")))
    a = Quotient(sheet.axial.term(P.symbol.index, place), known(sheet.rating("dynamic_axial_load_N")))
    formula: Formula = Sum((r, a))
    if model == "iso281":
        formula = Largest((r, Sum((Product((Constant(bearing.RADIAL_FACTOR), r)), a))))
    return Line(P, formula)


# --- Life -------------------------------------------------------------------------------------------------------------


def _mean(sheet: Sheet, load: OutputLoad, loads: PhaseValues, mean: Term, k: Term, f_w: Term) -> Step:
    """Step of the cycle's equivalent load and of the load k that the required life allows."""
    speed, life = sheet.catalogue.bearing_reference
    damage = over_phases(lambda n, t, P: Product((n, t, Power(P, EXPONENT))), sheet.speed, sheet.time, loads)
    above = Product((Constant(speed, "rpm"), Constant(life, "h")))
    lines = (
        Line(mean, Root(Quotient(damage, sheet.travel), EXPONENT)),
        Line(k, Root(Quotient(above, Product((sheet.n_out_av, _required(sheet, load)))), EXPONENT)),
    )
    limit = sheet.compared("output_bearing_life", Product((f_w, mean)))
    note = Sentence(N_("ISO 281, ball bearings, exponent 3; the published loads hold for L50 = 20000 h at 100 rpm."))
    return step_of_check("output_bearing_life", lines, limit, (note,))


def _required(sheet: Sheet, load: OutputLoad) -> Formula:
    """Required life as L50."""
    life = known(sheet.given("output_load.life_h"))
    return Product((Constant(bearing.L50_PER_L10), life)) if load.life_basis == "L10" else life


def _life(sheet: Sheet, mean: Term, f_w: Term) -> Step:
    title = CANDIDATE["bearing_life_L10_h"].name
    L_50, L_10 = sheet.figure("bearing_life_L50_h"), sheet.figure("bearing_life_L10_h")
    if L_50 is None or L_10 is None:
        note = Sentence(N_("The equivalent load is 0 or so small that the bearing life has no limit."))
        return Step("bearing_life", title, None, notes=(note,))
    speed, life = sheet.catalogue.bearing_reference
    by_speed = Quotient(Constant(speed, "rpm"), sheet.n_out_av)
    lines = (
        Line(L_50, Quotient(Product((Constant(life, "h"), by_speed)), Power(Product((f_w, mean)), EXPONENT))),
        Line(L_10, Quotient(L_50, Constant(bearing.L50_PER_L10))),
    )
    note = Sentence(
        N_(
            "L10 = L50 / 5 is the relation of the maker’s other handbooks, not printed in this one; a Weibull slope "
            "of 10/9 gives 5.45."
        )
    )
    return Step("bearing_life", title, None, lines, (), (note,))

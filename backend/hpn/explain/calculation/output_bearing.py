"""The output bearing: equivalent load of each phase and of the cycle, the load permitted by its life, and its life."""

import math
from collections.abc import Iterable

from hpn.application import OutputLoad
from hpn.application.shaft_centre import by_size
from hpn.engine.figures import phase_loads, radial_at_centre, shaft_centre_mm
from hpn.explain.calculation.formula import Constant, Formula, Largest, PhaseValues, Root, Term, Variable, over_phases
from hpn.explain.calculation.shaft import notes_on_shaft, of_shaft
from hpn.explain.calculation.sheet import CalculationSheet, EquationLine, Step, known, step_of_check
from hpn.physics import bearing
from hpn.words.quantities import CANDIDATE, INPUTS
from hpn.words.terms import ENVELOPE_BASIS
from hpn.words.wording import N_, Sentence

SHOWN_LOADS = 6
SUPPLIED = Sentence(N_("P is the ratio of the load to the curve that you supplied, in the load’s own direction."))
P, CUBE = Variable("P"), Constant(3)

CENTRE = "output_load.shaft_centre_mm"
CENTRE_OF_CATALOGUE = N_("x_c is the figure of {name} in your catalogue supplement, which goes before a typed one.")
CENTRE_OF_SIZE = N_("x_c is the distance that you gave for {name}.")
CENTRE_OF_OTHERS = N_("x_c is the distance that you gave for all sizes without one of their own.")


def bearing_steps(sheet: CalculationSheet) -> Iterable[Step]:
    """Steps of the output bearing if loads are given and its limits are known."""
    load, life = sheet.application.loads, sheet.candidate.check("output_bearing_life")
    if load is None or life is None or life.demand is None or life.limit is None:
        return
    f_w = known(sheet.input_of("output_load.load_coefficient"))
    of_phases = PhaseValues(P, phase_loads(sheet.duty, sheet.gears)[0, 0] / f_w.value)
    mean, k = Term(P.of_phase("m"), life.demand / f_w.value), Term(Variable("k"), life.limit)
    yield _largest(sheet, load, of_phases, f_w)
    yield _mean(sheet, load, of_phases, mean, k, f_w)
    yield _life(sheet, mean, f_w)


# --- Largest load -----------------------------------------------------------------------------------------------------


def _largest(sheet: CalculationSheet, load: OutputLoad, loads: PhaseValues, f_w: Term) -> Step:
    """Step of the equivalent load of each different load, with the largest compared to the published maxima."""
    first: dict[tuple[float, float], int] = {}
    for place, pair in enumerate(zip(sheet.radial.values.tolist(), sheet.axial.values.tolist(), strict=True)):
        first.setdefault(pair, place)
    phases = list(first.values())
    worst = max(phases, key=loads.values.item)
    index = {place: "" if len(phases) == 1 else str(place + 1) for place in phases}
    basis = SUPPLIED if load.model == "digitised" else Sentence(ENVELOPE_BASIS[load.model])
    notes = [basis, *notes_on_shaft(sheet), *_note_on_centre(sheet, load)]
    lines: list[EquationLine] = []
    if load.model != "digitised":
        rows = sorted({*phases[: SHOWN_LOADS - 1], worst})
        for place in rows:
            P_i = loads.term(index[place], place)
            lines += [*of_shaft(sheet, P_i.symbol.index, place), *_at_centre(sheet, P_i, place)]
            lines.append(_equivalent_load(sheet, load.model, place, P_i))
        if len(rows) < len(phases):
            values = {"shown": len(rows), "all": len(phases)}
            text = N_("{shown} of {all} different loads are shown, the largest among them.")
            notes.append(Sentence(text, values))
    limit = sheet.compared("output_bearing_load", f_w * loads.term(index[worst], worst))
    return step_of_check("output_bearing_load", tuple(lines), limit, tuple(notes))


def _at_centre(sheet: CalculationSheet, P: Term, place: int) -> Iterable[EquationLine]:
    """Radial load at the shaft's centre equivalent to loads that act elsewhere."""
    x, y = sheet.duty.inputs["output_load.radial_position_mm"].item(), sheet.input_of("output_load.axial_radius_mm")
    x_c = _centre(sheet)
    if x_c is None or y is None or (math.isnan(x) and not y.value):
        return
    F_R, F_A = (values.term(P.symbol.index, place) for values in (sheet.radial, sheet.axial))
    formula: Formula = F_R
    if abs(x) > x_c.value:
        formula = F_R * (abs(Term(Variable("x"), x, "mm")) / x_c)
    if y.value:
        formula = formula + F_A * (y / x_c)
    yield EquationLine(_equivalent_radial(sheet, P, place), formula)


def _centre(sheet: CalculationSheet) -> Term | None:
    """Distance of the shaft's centre for the gear; None if unknown."""
    x_c = shaft_centre_mm(sheet.duty, sheet.gears).item()
    return None if math.isnan(x_c) else Term(Variable.of(INPUTS[CENTRE].symbol), x_c, "mm")


def _note_on_centre(sheet: CalculationSheet, load: OutputLoad) -> list[Sentence]:
    """Note on the origin of this distance, where a lever acts."""
    if _centre(sheet) is None or radial_at_centre(sheet.duty, sheet.gears) is sheet.duty.phases.radial_N:
        return []
    own = CENTRE_OF_SIZE if sheet.gear.size in by_size(load.shaft_centre_mm) else CENTRE_OF_OTHERS
    text = own if sheet.gear.shaft_centre_mm is None else CENTRE_OF_CATALOGUE
    return [Sentence(text, {"name": sheet.gear.name})]


def _equivalent_radial(sheet: CalculationSheet, P: Term, place: int) -> Term:
    radial = radial_at_centre(sheet.duty, sheet.gears)
    if radial is sheet.duty.phases.radial_N:
        return sheet.radial.term(P.symbol.index, place)
    return Term(Variable("F", "eq").of_phase(P.symbol.index), radial[0, 0].item(place), "N")


def _equivalent_load(sheet: CalculationSheet, model: str, place: int, P: Term) -> EquationLine:
    r = _equivalent_radial(sheet, P, place) / known(sheet.rating("dynamic_radial_load_N"))
    a = sheet.axial.term(P.symbol.index, place) / known(sheet.rating("dynamic_axial_load_N"))
    return EquationLine(P, Largest((r, bearing.RADIAL_FACTOR * r + a)) if model == "iso281" else r + a)


# --- Life -------------------------------------------------------------------------------------------------------------


def _mean(sheet: CalculationSheet, load: OutputLoad, loads: PhaseValues, mean: Term, k: Term, f_w: Term) -> Step:
    """Step of the cycle's equivalent load and of the load k that the required life permits."""
    speed, life = sheet.catalogue.bearing_reference
    damage = over_phases(lambda n, t, P: abs(n) * t * P**3, sheet.speed, sheet.time, loads)
    above, below = Constant(speed, "rpm") * Constant(life, "h"), sheet.n_out_av * _required(sheet, load)
    lines = EquationLine(mean, Root(damage / sheet.travel, CUBE)), EquationLine(k, Root(above / below, CUBE))
    limit = sheet.compared("output_bearing_life", f_w * mean)
    note = Sentence(N_("ISO 281, ball bearings, exponent 3; the published loads hold for L50 = 20000 h at 100 rpm."))
    return step_of_check("output_bearing_life", lines, limit, (note,))


def _required(sheet: CalculationSheet, load: OutputLoad) -> Formula:
    """Required life as L50."""
    life = known(sheet.input_of("output_load.life_h"))
    return bearing.L50_PER_L10 * life if load.life_basis == "L10" else life


def _life(sheet: CalculationSheet, mean: Term, f_w: Term) -> Step:
    title = CANDIDATE["bearing_life_L10_h"].name
    L_50, L_10 = sheet.figure("bearing_life_L50_h"), sheet.figure("bearing_life_L10_h")
    if L_50 is None or L_10 is None:
        note = Sentence(N_("The equivalent load is 0 or so small that the bearing life is unlimited."))
        return Step("bearing_life", title, None, notes=(note,))
    speed, life = sheet.catalogue.bearing_reference
    by_speed = Constant(speed, "rpm") / sheet.n_out_av
    lines = (
        EquationLine(L_50, Constant(life, "h") * by_speed / (f_w * mean) ** 3),
        EquationLine(L_10, L_50 / bearing.L50_PER_L10),
    )
    note = Sentence(
        N_(
            "L10 = L50 / 5 is taken from the manufacturer’s other handbooks, not printed in this one; a Weibull slope "
            "of 10/9 gives 5.45."
        )
    )
    return Step("bearing_life", title, None, lines, (), (note,))

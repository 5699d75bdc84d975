"""Torques at the motor: peak without the emergency stop, and RMS over the cycle with its pause. Not in the handbook."""

from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

from hpn.calculation.formula import Constant, Formula, Power, Product, Quotient, Root, Symbol, Term
from hpn.calculation.sheet import Line, Sheet, Step
from hpn.wording import N_, Sentence


def motor_steps(sheet: Sheet) -> Iterable[Step]:
    """Peak and RMS torque, loss-free where no efficiency is known."""
    curve = sheet.catalogue.efficiency.get(sheet.gear.designation)
    stated = sheet.application.requirements.efficiency
    if stated is None and curve is not None:
        yield from _by_curve(sheet, np.interp(sheet.T, *curve, left=1.0, right=1.0))
        return
    eta = Term(Symbol("η"), stated or 1.0)
    note = Sentence(
        N_("η as you state it.") if stated else N_("η = 1, since no efficiency is known: loss-free, a lower bound.")
    )
    shaft = Product((sheet.i, eta))
    squares = sheet.series(
        lambda index, k: Product((Power(sheet.torque(index, k), Constant(2)), sheet.time(index, k))),
        lambda: sheet.T**2 * sheet.t,
    )
    yield _peak(sheet, Quotient(sheet.T_max, shaft), note)
    yield _rated(sheet, Quotient(Root(Quotient(squares, sheet.cycle_time)), shaft), note)


def _by_curve(sheet: Sheet, eta: NDArray[np.float64]) -> Iterable[Step]:
    """Motor torques phase by phase, each with its own efficiency."""
    torque = sheet.T / (sheet.gear.ratio * eta)
    k = int(torque.argmax())
    note = Sentence(N_("η of every phase from the efficiency curve that you supplied; 1 where the curve says nothing."))
    peak = Quotient(sheet.torque(str(k + 1), k), Product((sheet.i, Term(Symbol("η", str(k + 1)), eta.item(k)))))
    squares = sheet.series(
        lambda index, k: Product(
            (
                Power(
                    Quotient(sheet.torque(index, k), Product((sheet.i, Term(Symbol("η", index), eta.item(k))))),
                    Constant(2),
                ),
                sheet.time(index, k),
            )
        ),
        lambda: torque**2 * sheet.t,
    )
    yield _peak(sheet, peak, note)
    yield _rated(sheet, Root(Quotient(squares, sheet.cycle_time)), note)


def _peak(sheet: Sheet, formula: Formula, note: Sentence) -> Step:
    peak = Term(Symbol("T", "motor"), sheet.candidate["motor_peak_torque_Nm"], "Nm")
    limit = sheet.compared("motor_peak_torque", peak, Symbol("T", "motor peak"))
    return Step(
        "motor_peak_torque", N_("Peak torque at the motor"), None, (Line(peak, formula),), limit, (note,), trivial=True
    )


def _rated(sheet: Sheet, formula: Formula, note: Sentence) -> Step:
    rated = Term(Symbol("T", "motor rms"), sheet.candidate["motor_rated_torque_Nm"], "Nm")
    limit = sheet.compared("motor_rated_torque", rated, Symbol("T", "motor rated"))
    return Step("motor_rated_torque", N_("RMS torque at the motor"), None, (Line(rated, formula),), limit, (note,))

"""Allowed number of emergency stops against their torque, with the user's stop, as a drawing and in words."""

from math import inf, log10

from hpn.explain.drawings.chart import ChartAxes, LimitCurve, Mark, Scene
from hpn.explain.drawings.subject import Subject
from hpn.explain.drawings.words import share
from hpn.physics import equations
from hpn.words.quantities import CANDIDATE, GEAR, INPUTS
from hpn.words.reader import DEFAULT, Reader
from hpn.words.wording import N_, Quantity, Sentence, Value

TOP = 8.0
"""Power of ten at which a stop without a limit of its number is drawn."""

AXES = ChartAxes(N_("emergency-stop torque"), "Nm", N_("number of stops"), "", powers=True)


def stop_scene(subject: Subject, reader: Reader = DEFAULT) -> Scene | None:
    """Allowed number of emergency stops against their torque (equation 17.9), with the user's stop on it.

    Numbers are powers of ten, so that the equation is a straight line. None if the gear's ratings are not published.
    """
    T_R, T_M = subject.gear.repeated_peak_torque_Nm, subject.gear.momentary_peak_torque_Nm
    if T_R is None or T_M is None:
        return None
    one_stop = equations.emergency_stop_torque_for(momentary_peak_count=1, repeated_peak_torque_Nm=T_R).item()
    start, end = ((torque, _power(torque, T_R)) for torque in (T_R, min(max(T_M, T_R), one_stop)))
    lines = [
        LimitCurve("region", "", [(0.0, inf), (T_R, inf), start, end, (end[0], 0.0)], strong=True),
        LimitCurve("limit", CANDIDATE["momentary_peak_count"].symbol, [start, end]),
        LimitCurve("mean", GEAR["repeated_peak_torque_Nm"].symbol, [(T_R, inf), start]),
        LimitCurve("mean", GEAR["momentary_peak_torque_Nm"].symbol, [end, (end[0], 0.0)]),
    ]
    return Scene(lines, _stop(subject, T_M, reader), None, AXES)


def _power(torque_Nm: float, T_R: float) -> float:
    """Decimal logarithm of the number of stops at a torque."""
    return log10(equations.momentary_peaks_at(emergency_stop_torque_Nm=torque_Nm, repeated_peak_torque_Nm=T_R).item())


def _stop(subject: Subject, T_M: float, reader: Reader) -> list[Mark]:
    """The user's stop at its expected, else its allowed number; empty if none is allowed."""
    stop, torque = subject.application.emergency_stop, subject.emergency_stop_torque_Nm
    allowed = allowed_stops(subject)
    if stop is None or torque is None or allowed is None or max(stop.count or 0, allowed) < 1:
        return []
    count = stop.count or min(allowed, 10**TOP)
    outside = torque > T_M * (1 + equations.ROUNDING) or count > allowed
    named = INPUTS["emergency_stop.count" if stop.count else "emergency_stop.torque_Nm"]
    return [Mark("load", named.symbol, (torque, log10(count)), reader.text(named.name), 1.0, outside)]


def allowed_stops(subject: Subject) -> float | None:
    """Allowed number at the user's torque, infinite at or below T_R; None without a stop or a rating."""
    torque, T_R = subject.emergency_stop_torque_Nm, subject.gear.repeated_peak_torque_Nm
    if torque is None or T_R is None:
        return None
    return equations.allowed_momentary_peaks(emergency_stop_torque_Nm=torque, repeated_peak_torque_Nm=T_R).item()


# --- In words ---------------------------------------------------------------------------------------------------------


def emergency_stop_words(subject: Subject) -> list[Sentence]:
    """Number of allowed stops at the user's torque, and the share of it that the user's stops use, in words."""
    gear, stop, torque = subject.gear, subject.application.emergency_stop, subject.emergency_stop_torque_Nm
    T_R, T_M, allowed = gear.repeated_peak_torque_Nm, gear.momentary_peak_torque_Nm, allowed_stops(subject)
    if T_R is None or T_M is None:
        return [
            Sentence("Not rated: the peak torques of {gear} are not in this catalogue’s source.", {"gear": gear.name})
        ]
    if stop is None or torque is None or allowed is None:
        return [Sentence("Enter an emergency-stop torque to see how many such stops this gear permits.")]
    terms: dict[str, Value] = {"torque": Quantity(torque, "Nm", 6)}
    if allowed == inf:
        return [
            Sentence(
                "{torque} is at or below T_R = {limit}: equation 17.9 sets no limit to the number.",
                terms | {"limit": Quantity(T_R, "Nm", 6)},
            )
        ]
    budget = _budget(stop.count, allowed, terms)
    if torque <= T_M * (1 + equations.ROUNDING):
        return [budget]
    values = terms | {"limit": Quantity(T_M, "Nm", 6)}
    return [Sentence("{torque} is above T_M = {limit}, whatever the number.", values), budget]


def _budget(count: int | None, allowed: float, torque: dict[str, Value]) -> Sentence:
    if allowed < 1:
        return Sentence("At {torque} no emergency stop is permitted (eq. 17.9).", torque)
    values = torque | {"allowed": Quantity(allowed, "", 12)}
    if count is None:
        return Sentence("At {torque} equation 17.9 permits {allowed} stops over the life.", values)
    used: dict[str, Value] = {"count": Quantity(count, "", 16), "used": share(count / allowed)}
    return Sentence(
        "At {torque} equation 17.9 permits {allowed} stops over the life; your {count} use {used} of them.",
        values | used,
    )

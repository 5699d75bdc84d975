"""A check as a table entry: its comparison, its power of each driver of an application, and its texts."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from hpn.catalogue import GearColumns
from hpn.engine.duty import Duty
from hpn.engine.figures import Figures
from hpn.engine.input_arrays import InputArrays
from hpn.physics.equations import FloatArray
from hpn.words.wording import N_

Kind = Literal["maximum", "minimum", "range"]
Group = Literal["load", "property"]
Driver = Literal["torque", "speed", "load"]

DRIVERS: tuple[Driver, ...] = ("torque", "speed", "load")
"""Drivers: utilisations are powers of all torques of the duty cycle, of all speeds, and of all loads on the output."""


RATING_TABLES = N_("rating tables 10.1 to 12.2")
"""Source of most limits."""


@dataclass(frozen=True, slots=True)
class Case:
    """Arguments of every check: duty, published figures and computed figures."""

    duty: Duty
    gears: GearColumns
    figures: Figures

    @property
    def inputs(self) -> InputArrays:
        """Inputs besides the phases."""
        return self.duty.inputs


Values = Callable[[Case], FloatArray]

Dependence = Literal["rising", "falling", "ends", "weight", "unproven"]
"""Dependence of a utilisation on one input, the others fixed. It rises or falls with the input, or is largest at one of
its ends; `weight`: the input is a factor of the weights w of a share Σ w d / (Σ w + c); unproven: none of these.
"""


@dataclass(frozen=True)
class Check:
    """One check. Its texts are English msgids; `name` is its name inside a sentence.

    A check applies where the input `asked` is present (always if that is blank), or the input `instead`, but never
    beside the input `unless`. Without a `limit` the input `asked` is the limit. Utilisation is demand over limit, for a
    minimum limit over demand, or the result of `share`. `at_least` is a lower bound of it where an input is missing,
    NaN elsewhere. `limited_by` is the catalogue figure behind the limit, None for the user's own limit. `relation` is
    the check in the handbook's symbols. `moves` gives the power with which the utilisation grows with each driver.
    `accepted` names the {value} of the input `asked` at which the check passes, for checks that no driver moves, or
    none in closed form.

    `over` gives the dependence of the utilisation on each of its inputs: an input by its path, of a phase by its field,
    and of a motion with fixed times and speeds by `motion`; with None nothing is proven. Where inputs are weights,
    `weighted` gives the d of each phase, shape (N, groups of gears, phases), and c is the pause if the utilisation
    depends on the pause. `proven` is False where this dependence doesn't hold, broadcasting to (N, G). Beside the input
    `sampled_beside` nothing is proven.
    """

    code: str
    name: str
    title: str
    unit: str
    kind: Kind
    group: Group
    limit_name: str
    source: str
    tests: str
    consequence: str
    basis: str
    remedy: str
    demand: Values
    relation: str
    trigger: str = ""
    instead: str = ""
    unless: str = ""
    sampled_beside: str = ""
    limit: Values | None = None
    share: Values | None = None
    at_least: Values | None = None
    equation: str | None = None
    limited_by: str | None = None
    moves: Mapping[Driver, float] = field(default_factory=dict)
    accepted: str = ""
    over: Mapping[str, Dependence] | None = None
    weighted: Values | None = None
    proven: Callable[[Case], NDArray[np.bool_]] | None = None

    def limit_of(self, case: Case) -> FloatArray:
        """Limit in the unit of the check; broadcasts to (N, G), NaN if not published or not asked for."""
        return self.limit(case) if self.limit else case.inputs[self.trigger]

    def utilisation(self, case: Case) -> FloatArray:
        """Used share of the limit; broadcasts to (N, G), infinite where a check fails without a number. [-]

        NaN beside the input `unless`.
        """
        if self.share is not None:
            return self.share(case)
        demand, limit = self.demand(case), self.limit_of(case)
        if self.unless:
            limit = np.where(np.isnan(case.inputs[self.unless]), limit, np.nan)
        return limit / demand if self.kind == "minimum" else demand / limit

    def allowed(self, utilisation: float) -> float:
        """Largest utilisation at which it passes: the user's own u for a load check, 1 for a property check."""
        return utilisation if self.group == "load" else 1.0

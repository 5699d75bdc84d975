"""A check as a table entry: its comparison, its power of each driver of an application, and its texts."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from hpn.catalogue import GearColumns
from hpn.engine.duty import Duty, InputArrays
from hpn.engine.figures import Figures
from hpn.physics.equations import FloatArray
from hpn.words.wording import N_

Kind = Literal["maximum", "minimum", "range"]
Group = Literal["load", "property"]
Driver = Literal["torque", "speed", "load"]

DRIVERS: tuple[Driver, ...] = ("torque", "speed", "load")
"""Quantities that utilisations are powers of: all torques of the duty cycle, all speeds, all loads on the output."""


RATING_TABLES = N_("rating tables 10.1 to 12.2")
"""Source of most limits."""


@dataclass(frozen=True, slots=True)
class Case:
    """Arguments of every check: duty, published figures and computed figures."""

    duty: Duty
    gears: GearColumns
    figures: Figures

    @property
    def asked(self) -> InputArrays:
        """Inputs besides the phases."""
        return self.duty.asked


Values = Callable[[Case], FloatArray]

Dependence = Literal["rising", "falling", "ends", "weight", "unproven"]
"""How a utilisation depends on one input while the others stay: it rises or falls with it, or is largest at one of its
ends; `weight`: the input is a factor of the weights w of a share Σ w d / (Σ w + c); unproven: in no such way."""


@dataclass(frozen=True)
class Check:
    """One check. Its texts are English msgids; `name` is how it stands inside a sentence.

    `asked` is the input whose presence asks for it, blank for a check that is always made; `instead` is another input
    that asks for it as well. Without a `limit` that input is the limit. Utilisation is demand over limit, limit over
    demand for a minimum, or what `share` gives. `at_least` is a lower bound of it where
    an input is missing, NaN elsewhere. `limited_by` is the catalogue figure behind the limit, None where that
    is the user's own. `relation` is the check in the handbook's symbols. `moves` gives the power with which the
    utilisation grows with each driver; `accepted` says which {value} of the input `asked` lets it pass where none of
    them moves it, or none in closed form.

    `over` says of each input that the utilisation depends on how it does, an input by its path, of a phase by its
    field, and of a motion with fixed times and speeds by `motion`; None: nothing is proven of it. Where inputs are
    weights, `weighted` gives the d of each phase, shape (N, groups of gears, phases), and c is the pause where the
    utilisation depends on it. `proven` is False where that doesn't hold, broadcasting to (N, G).
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
    asked: str = ""
    instead: str = ""
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
        """Limit in the unit of the check; broadcasts to (N, G), NaN where it is not published or not asked."""
        return self.limit(case) if self.limit else case.asked[self.asked]

    def utilisation(self, case: Case) -> FloatArray:
        """Share of the limit that is used, [-]; broadcasts to (N, G), infinite where a check fails without a number."""
        if self.share is not None:
            return self.share(case)
        demand, limit = self.demand(case), self.limit_of(case)
        return limit / demand if self.kind == "minimum" else demand / limit

    def allowed(self, utilisation: float) -> float:
        """Largest utilisation with which it passes: the user's own u for a load check, 1 for a property check."""
        return utilisation if self.group == "load" else 1.0

"""Radial load of a belt on the shaft of its pulley, from the forces in its strands or from its power."""

from math import cos, radians, sqrt
from typing import Annotated, Self

from pydantic import Field, model_validator
from pydantic_core import PydanticCustomError

from hpn.words.fields import Model, Number, Positive, refused
from hpn.words.wording import N_

Force = Annotated[Number, Field(ge=0, le=1e9)]


def radial_load(*, tight_N: float, slack_N: float, wrap_deg: float) -> float:
    """Resultant √(F1² + F2² - 2 F1 F2 cos β) in N of two strands that leave a pulley with a wrap angle of β.

    Half a turn adds the forces up, by the law of cosines.
    """
    return sqrt(max(tight_N**2 + slack_N**2 - 2 * tight_N * slack_N * cos(radians(wrap_deg)), 0.0))


class Strands(Model):
    """Strands of a belt: their forces, or power, speed and pretension factor (F1 + F2) / (F1 - F2)."""

    tight_strand_N: Force | None = Field(None, description="Force in the tight strand F1.")
    slack_strand_N: Force | None = Field(None, description="Force in the slack strand F2.")
    power_W: Positive | None = Field(None, description="Transmitted power, in place of the forces.")
    speed_m_per_s: Positive | None = Field(None, description="Speed of the belt.")
    pretension_factor: Annotated[Number, Field(ge=1, le=10)] | None = Field(
        None, description="Sum of the strands’ forces over their difference."
    )
    wrap_deg: Annotated[Number, Field(gt=0, le=360)] = Field(180.0, description="Wrap angle on the pulley.")

    @model_validator(mode="after")
    def _one_way(self) -> Self:
        forces, power = ("tight_strand_N", "slack_strand_N"), ("power_W", "speed_m_per_s", "pretension_factor")
        given = [[name for name in names if getattr(self, name) is not None] for names in (forces, power)]
        if all(given):
            text = N_("give either the forces in the strands or power, speed and pretension factor")
            raise refused(self, ((given[1][0],), PydanticCustomError("belt_twice", text)))
        names = power if given[1] else forces
        missing = [name for name in names if getattr(self, name) is None]
        if missing:
            raise refused(self, *(((name,), PydanticCustomError("missing", N_("is required"))) for name in missing))
        return self

    @property
    def radial_N(self) -> float:
        """Radial load of the belt on its shaft."""
        tight, slack = self.tight_strand_N or 0.0, self.slack_strand_N or 0.0
        if self.power_W is not None:
            turning = self.power_W / (self.speed_m_per_s or 1.0)
            factor = self.pretension_factor or 1.0
            tight, slack = turning * (factor + 1) / 2, turning * (factor - 1) / 2
        return radial_load(tight_N=tight, slack_N=slack, wrap_deg=self.wrap_deg)

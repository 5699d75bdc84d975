"""One load phase of a duty cycle, typed or from a motion."""

from pydantic import Field, ValidationInfo, field_validator
from pydantic_core import PydanticCustomError, PydanticKnownError

from hpn.words.fields import Duration, Load, Model, Speed, SpeedMagnitude, Torque, TorqueMagnitude
from hpn.words.titles import Name

ROOM = 1e-9
"""Relative tolerance of a peak's comparison: clients send rounded peaks, means and RMS."""


class Phase(Model):
    """One load phase of the duty cycle (handbook, illustration 17.1).

    Where torque or speed vary in a phase, `torque_Nm` is the mean weighted as in equation 17.2, and `speed_rpm` the
    mean of |n|; the peaks and the RMS are magnitudes, by default those of torque and speed. The least torque is by
    default the phase's own where peak and RMS equal it, else 0.
    """

    torque_Nm: Torque = Field(description="Output torque T; its magnitude counts.", examples=[40.0])
    speed_rpm: Speed = Field(description="Output speed n; 0 is a holding phase.", examples=[250.0])
    duration_s: Duration = Field(description="Duration t of the phase.", examples=[0.3])
    radial_N: Load | None = Field(
        None, description="Radial load on the shaft centre in this phase; by default the cycle’s.", examples=[500.0]
    )
    axial_N: Load | None = Field(
        None, description="Axial load on the shaft axis in this phase; by default the cycle’s.", examples=[200.0]
    )
    peak_torque_Nm: TorqueMagnitude | None = Field(
        None, description="Largest torque in the phase; by default the phase’s own torque.", examples=[55.0]
    )
    peak_speed_rpm: SpeedMagnitude | None = Field(
        None, description="Largest speed in the phase; by default the phase’s own speed.", examples=[500.0]
    )
    rms_torque_Nm: TorqueMagnitude | None = Field(
        None, description="RMS of the torque over the phase; by default the phase’s own torque.", examples=[42.0]
    )
    least_torque_Nm: TorqueMagnitude | None = Field(
        None,
        description="Least magnitude of the torque in the phase; by default the phase’s own torque where peak and RMS "
        "equal it, else 0.",
        examples=[30.0],
    )
    name: Name | None = Field(None, description="Your name for the phase.", examples=["lift"])

    @field_validator("peak_torque_Nm", "peak_speed_rpm")
    @classmethod
    def _reaches(cls, peak: float | None, info: ValidationInfo) -> float | None:
        own = info.data.get(str(info.field_name).removeprefix("peak_"))
        if peak is None or own is None:
            return peak
        if own == 0 and peak > 0 and info.field_name == "peak_speed_rpm":
            raise PydanticCustomError(
                "peak_at_rest", "a phase with speed 0 has no peak speed: give it a speed, or leave peak_speed_rpm out"
            )
        if peak < abs(own) * (1 - ROOM):
            raise PydanticKnownError("greater_than_equal", {"ge": abs(own)})
        return peak

    @field_validator("rms_torque_Nm")
    @classmethod
    def _within_the_peak(cls, rms: float | None, info: ValidationInfo) -> float | None:
        if rms is None or not {"torque_Nm", "peak_torque_Nm"} <= info.data.keys():
            return rms
        outer, own = info.data["peak_torque_Nm"], info.data["torque_Nm"]
        peak = abs(own) if outer is None else outer
        if rms > peak * (1 + ROOM):
            raise PydanticKnownError("less_than_equal", {"le": peak})
        return rms

    @field_validator("least_torque_Nm")
    @classmethod
    def _below_all(cls, least: float | None, info: ValidationInfo) -> float | None:
        if least is None or not {"torque_Nm", "rms_torque_Nm"} <= info.data.keys():
            return least
        rms, own = info.data["rms_torque_Nm"], abs(info.data["torque_Nm"])
        most = own if rms is None else min(own, rms)
        if least > most * (1 + ROOM):
            raise PydanticKnownError("less_than_equal", {"le": most})
        return least

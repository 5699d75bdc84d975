"""The phases that a check goes by, so that table, chart and drawing can mark them alike."""

from hpn.explain.drawings.picture import BearingPicture
from hpn.explain.drawings.subject import Subject
from hpn.physics.equations import FloatArray

_EXTREME = {
    "repeated_peak_torque": "peak_torque_Nm",
    "motor_peak_torque": "peak_torque_Nm",
    "maximum_input_speed": "peak_speed_rpm",
    "motor_speed": "peak_speed_rpm",
}
"""Checks of the largest value of a phase."""


def governing_phases(subject: Subject, check: str | None, picture: BearingPicture | None) -> tuple[int, ...]:
    """Places of the phases that a check goes by; none where it goes by an average, a stop or a property."""
    if check in ("output_bearing_load", "output_bearing_life"):
        return tuple(picture.worst.places) if picture and picture.loads else ()
    if check not in _EXTREME:
        return ()
    values: FloatArray = getattr(subject.duty.phases, _EXTREME[check])[0, 0]
    return tuple((values == values.max()).nonzero()[0].tolist())

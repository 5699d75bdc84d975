"""The reply of `POST /api/v1/select`, typed."""

from typing import Any

import msgspec

from hpn.wording import N_

REASONS = {
    "suitable": N_("Every check passes; the closest is {check} at {percent} of its limit."),
    "unsuitable": N_("{check} is at {percent} of its limit."),
    "unsuitable_more": N_("{check} is at {percent} of its limit; checks that fail: {failed}."),
    "no_stop_allowed": N_("The emergency stop is so hard that not one is allowed (equation 17.9)."),
    "unrated": N_("Not rated: figures of {name} that the checks need are not published."),
}
"""Why a candidate stands where it does: templates of sentences."""


class CheckRow(msgspec.Struct):
    """One check of one candidate."""

    code: str
    demand: float | None
    limit: float | None
    utilisation: float | None
    status: str


class ReserveRow(msgspec.Struct):
    """How far each driver may grow (above 1) or must shrink (below 1) on one candidate, the others as given."""

    torque_factor: float | None
    speed_factor: float | None
    load_factor: float | None
    emergency_stop_torque_Nm: float | None


class GearRow(msgspec.Struct):
    """Which gear a candidate is."""

    designation: str
    size: str
    ratio: int
    stages: int


class CandidateRow(GearRow):
    """One gear, its verdict and why."""

    status: str
    rank: int | None
    utilisation: float | None
    governing_check: str | None
    reason: str
    average_input_speed_rpm: float
    maximum_input_speed_rpm: float
    life_L10_h: float | None
    momentary_peak_count: float | None
    bearing_life_L50_h: float | None
    bearing_life_L10_h: float | None
    motor_peak_torque_Nm: float
    motor_rated_torque_Nm: float
    reserve: ReserveRow
    checks: list[CheckRow]


class DutyRow(msgspec.Struct):
    """What the duty cycle comes to."""

    average_torque_Nm: float
    average_output_speed_rpm: float
    maximum_torque_Nm: float
    maximum_output_speed_rpm: float


class SelectReply(msgspec.Struct):
    """The whole reply."""

    engine_version: str
    catalogue_version: str
    link: str
    duty: DutyRow
    selected: str | None
    candidates: msgspec.Raw
    check_definitions: msgspec.Raw
    notices: list[dict[str, Any]]


encode = msgspec.json.Encoder().encode
"""Encode as JSON; NaN and infinity, which stand for unpublished and unlimited, become null."""

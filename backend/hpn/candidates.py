"""What the candidates of a reply say together: which stands first, which are judged, and what nothing limits."""

from collections.abc import Mapping, Sequence
from typing import Any

Candidate = Mapping[str, Any]
"""An entry of a reply's `candidates`; see `reply.CandidateRow`."""

_UNLIMITED_BY = {
    "life_L10_h": ("average_torque", "average_torque"),
    "momentary_peak_count": ("momentary_peak_torque", "repeated_peak_torque"),
    "bearing_life_L50_h": ("output_bearing_life", "output_bearing_life"),
}
"""Figures that may be without limit: the check that stands there where they are asked for, and the one that says
whether the gear has the rating that they come from."""


def is_unlimited(candidate: Candidate, name: str) -> bool:
    """Whether a figure of a reply is empty because nothing limits it, and not because nobody asked or a rating lacks.

    The candidate's own status doesn't tell: a gear that fails a check is unsuitable, whether it is rated or not.
    """
    asked, rated = _UNLIMITED_BY[name]
    status = {check["code"]: check["status"] for check in candidate["checks"]}
    return candidate.get(name) is None and asked in status and status.get(rated, "not_rated") != "not_rated"


def is_judged(candidate: Candidate) -> bool:
    """Whether every check of a candidate could be judged. One that is unsuitable needs not be rated for that."""
    return all(check["status"] != "not_rated" for check in candidate["checks"])


def foremost(candidates: Sequence[Candidate]) -> Candidate:
    """The selected gear, else the nearest miss among those that could be judged, if any could."""
    return next(filter(is_judged, candidates), candidates[0])

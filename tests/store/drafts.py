"""Drafts to save in tests."""

from typing import Any

from hpn.store import Draft


def draft(**parts: Any) -> Draft:
    """A draft with whatever is not given filled in."""
    fields = {
        "application": b'{"duty_cycle":{"phases":[]}}',
        "result": b'{"selected":"HPN-20A-5"}',
        "engine_version": "1.0.0",
        "catalogue_version": "0123456789abcdef",
        "selected": "HPN-20A-5",
    }
    return Draft(**(fields | parts))


WEAKER = """\
size,ratio,repeated_peak_torque_Nm,rated_torque_Nm,momentary_peak_torque_Nm,source
20A,5,,30,,test
"""
"""Ratings with which HPN-20A-5 no longer suits the worked example."""

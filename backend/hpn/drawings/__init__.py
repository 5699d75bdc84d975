"""Pictures of a selection as plain data: Plotly figures, steps of the duty cycle, and what they say in words.

Data and axes are made here; colours are names of the page's theme (`var(--plot-own)`), which the browser fills in.
"""

from hpn.drawings.bearing import bearing_figure, sizes_figure
from hpn.drawings.cycle import CyclePicture, cycle_picture
from hpn.drawings.layout import Figure
from hpn.drawings.picture import (
    BearingPicture,
    NamedCurve,
    SizeUse,
    bearing_picture,
    bearing_verdict,
    picture_of,
    size_uses,
)
from hpn.drawings.stops import emergency_stop_figure, emergency_stop_words
from hpn.drawings.subject import Subject

__all__ = [
    "BearingPicture",
    "CyclePicture",
    "Figure",
    "NamedCurve",
    "SizeUse",
    "Subject",
    "bearing_figure",
    "bearing_picture",
    "bearing_verdict",
    "cycle_picture",
    "emergency_stop_figure",
    "emergency_stop_words",
    "picture_of",
    "size_uses",
    "sizes_figure",
]

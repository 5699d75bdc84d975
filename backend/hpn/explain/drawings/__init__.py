"""Pictures of a selection as plain data: SVG drawings, Plotly figures, and what they say in words.

Data and axes are made here. Colours are those of a style sheet, or names of the page's theme (`var(--ink)`), which
the browser fills in.
"""

from hpn.explain.drawings.bearing import bearing_figure, sizes_figure
from hpn.explain.drawings.chart import LARGE, SMALL, Scene, chart
from hpn.explain.drawings.cycle import CyclePicture, cycle_picture
from hpn.explain.drawings.envelope import GearEnvelope, envelope_scene, gear_envelope, sizes_scene
from hpn.explain.drawings.layout import Figure
from hpn.explain.drawings.picture import BearingPicture, NamedCurve, bearing_picture
from hpn.explain.drawings.pictures import Pictures, governing_phases
from hpn.explain.drawings.plane import Plane, gear_plane, motor_plane
from hpn.explain.drawings.sizes import SizeUse, size_uses
from hpn.explain.drawings.stops import emergency_stop_figure, emergency_stop_words
from hpn.explain.drawings.subject import Subject
from hpn.explain.drawings.verdict import bearing_verdict, bearing_words, carries

__all__ = [
    "LARGE",
    "SMALL",
    "BearingPicture",
    "CyclePicture",
    "Figure",
    "GearEnvelope",
    "NamedCurve",
    "Pictures",
    "Plane",
    "Scene",
    "SizeUse",
    "Subject",
    "bearing_figure",
    "bearing_picture",
    "bearing_verdict",
    "bearing_words",
    "carries",
    "chart",
    "cycle_picture",
    "emergency_stop_figure",
    "emergency_stop_words",
    "envelope_scene",
    "gear_envelope",
    "gear_plane",
    "governing_phases",
    "motor_plane",
    "size_uses",
    "sizes_figure",
    "sizes_scene",
]

"""Pictures of a selection as plain data: SVG drawings, Plotly figures, and their contents in words.

This package makes data and axes. Colours come from a style sheet, or are names of the page's theme (`var(--ink)`) that
the browser fills in.
"""

from hpn.explain.drawings.chart import chart
from hpn.explain.drawings.cycle import cycle_picture
from hpn.explain.drawings.envelope import gear_envelope, published_condition
from hpn.explain.drawings.layout import Figure
from hpn.explain.drawings.picture import default_condition
from hpn.explain.drawings.pictures import Pictures
from hpn.explain.drawings.plane import Plane
from hpn.explain.drawings.subject import Subject

__all__ = [
    "Figure",
    "Pictures",
    "Plane",
    "Subject",
    "chart",
    "cycle_picture",
    "default_condition",
    "gear_envelope",
    "published_condition",
]

"""Pictures of the candidate that the page looks at, in the language and units of its reader."""

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import orjson
from jinja2 import pass_context
from jinja2.runtime import Context
from markupsafe import Markup

from hpn import drawings
from hpn.application import Application
from hpn.catalogue import Catalogue
from hpn.drawings import BearingPicture, CyclePicture, Figure, NamedCurve, SizeUse, Subject
from hpn.gear import Gear
from hpn.reader import Reader
from hpn.web.door.visit import current
from hpn.wording import Sentence

DASHES = {"dot": "2 3", "dash": "7 4", "longdash": "11 4", "dashdot": "7 3 2 3", "longdashdot": "11 3 2 3"}
"""Plotly's dashes as `stroke-dasharray` of a sample in the legend."""


@dataclass(frozen=True)
class Pictures:
    """What the templates draw or hand to Plotly; each is made when a template asks for it."""

    subject: Subject
    reader: Reader

    @cached_property
    def cycle(self) -> CyclePicture:
        """Steps of the duty cycle."""
        return drawings.cycle_picture(self.subject, self.reader)

    @cached_property
    def bearing(self) -> BearingPicture | None:
        """Loads on the output bearing, or None without loads or where it is not rated."""
        return drawings.bearing_picture(self.subject)

    @cached_property
    def bearing_figure(self) -> Figure:
        """Plotly figure of `bearing`, which must be there."""
        assert self.bearing is not None
        return drawings.bearing_figure(self.bearing, self.reader)

    @property
    def legend(self) -> list[tuple[NamedCurve, Figure]]:
        """Curves of `bearing`, each with its trace in the figure."""
        assert self.bearing is not None
        traces = {(t["meta"]["kind"], t["meta"].get("load_coefficient")): t for t in self.bearing_figure["data"]}
        return [(named, traces[named.kind, named.curve.load_coefficient]) for named in self.bearing.named_curves]

    @cached_property
    def sizes_figure(self) -> Figure:
        """Plotly figure of all sizes, where loads are given."""
        return drawings.sizes_figure(self.subject, self.reader)

    @property
    def sizes(self) -> list[tuple[SizeUse, Figure | None]]:
        """Use of the bearing of every size, each with its trace in `sizes_figure`."""
        traces = {trace["name"]: trace for trace in self.sizes_figure["data"] if trace["meta"]["kind"] == "size"}
        return [(use, traces.get(use.gear.name)) for use in drawings.size_uses(self.subject)]

    @property
    def verdict(self) -> list[Sentence]:
        """`bearing` in words."""
        assert self.bearing is not None
        return drawings.bearing_verdict(self.bearing)

    @cached_property
    def stop_figure(self) -> Figure | None:
        """Plotly figure of the emergency stops, or None where the gear is not rated."""
        return drawings.emergency_stop_figure(self.subject, self.reader)

    @property
    def stop_words(self) -> list[Sentence]:
        """The emergency stops in words."""
        return drawings.emergency_stop_words(self.subject)


@pass_context
def pictures_of(_: Context, application: Application, gear: Gear, catalogue: Catalogue) -> Pictures:
    """Pictures of one gear under an application, for whoever reads the page."""
    return Pictures(Subject(application, gear, catalogue), current())


def as_attribute(figure: Figure) -> Markup:
    """A figure as JSON in a single-quoted attribute, where its many double quotes may stand as they are."""
    text = orjson.dumps(figure).decode()
    return Markup(text.replace("&", "&amp;").replace("'", "&#39;").replace("<", "&lt;"))


def sample(trace: dict[str, Any]) -> Markup:
    """Attributes of the line that stands for a trace in the legend."""
    line = trace["line"]
    dash = DASHES.get(line["dash"], "none")
    return Markup(f'stroke-width="{line["width"]}" stroke-dasharray="{dash}" stroke="{line["color"]}"')


GLOBALS = {"pictures_of": pictures_of}
FILTERS = {"as_attribute": as_attribute, "sample": sample}

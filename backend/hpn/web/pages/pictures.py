"""Pictures of the candidate that the page looks at, in the language and units of its reader."""

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import orjson
from jinja2 import pass_context
from jinja2.runtime import Context
from markupsafe import Markup

from hpn import drawings as plots
from hpn.gear import Gear
from hpn.selection import Selection
from hpn.web.reader import Reader, reader_of
from hpn.wording import Sentence

DASHES = {"dot": "2 3", "dash": "7 4", "longdash": "11 4", "dashdot": "7 3 2 3", "longdashdot": "11 3 2 3"}
"""Plotly's dashes as `stroke-dasharray` of a sample in the legend."""


@dataclass(frozen=True)
class Pictures:
    """What the templates draw or hand to Plotly; each is made when a template asks for it."""

    selection: Selection
    gear: Gear
    words: plots.Words

    @cached_property
    def cycle(self) -> plots.CyclePicture:
        """Steps of the duty cycle."""
        return plots.cycle_picture(self.selection, self.gear, self.words)

    @cached_property
    def bearing(self) -> plots.BearingPicture | None:
        """Loads on the output bearing, or None without loads or where it is not rated."""
        return plots.bearing_picture(self.selection, self.gear)

    @cached_property
    def bearing_figure(self) -> plots.Figure:
        """Plotly figure of `bearing`, which must be there."""
        assert self.bearing is not None
        return plots.bearing_figure(self.bearing, self.words)

    @property
    def legend(self) -> list[tuple[plots.NamedCurve, plots.Figure]]:
        """Curves of `bearing`, each with its trace in the figure."""
        assert self.bearing is not None
        traces = {(t["meta"]["kind"], t["meta"].get("load_coefficient")): t for t in self.bearing_figure["data"]}
        return [(named, traces[named.kind, named.curve.load_coefficient]) for named in self.bearing.named_curves]

    @cached_property
    def sizes_figure(self) -> plots.Figure:
        """Plotly figure of all sizes."""
        return plots.sizes_figure(self.selection, self.words)

    @property
    def sizes(self) -> list[tuple[plots.SizeUse, plots.Figure | None]]:
        """Use of the bearing of every size, each with its trace in `sizes_figure`."""
        traces = {trace["name"]: trace for trace in self.sizes_figure["data"] if trace["meta"]["kind"] == "size"}
        return [(use, traces.get(use.gear.name)) for use in plots.size_uses(self.selection)]

    @property
    def verdict(self) -> list[Sentence]:
        """`bearing` in words."""
        assert self.bearing is not None
        return plots.bearing_verdict(self.bearing)

    @cached_property
    def stop_figure(self) -> plots.Figure | None:
        """Plotly figure of the emergency stops, or None where the gear is not rated."""
        return plots.emergency_stop_figure(self.selection, self.gear, self.words)

    @property
    def stop_words(self) -> list[Sentence]:
        """The emergency stops in words."""
        return plots.emergency_stop_words(self.selection, self.gear)


@pass_context
def pictures_of(context: Context, selection: Selection, gear: Gear) -> Pictures:
    """Pictures of one gear among the candidates of a selection, for whoever reads the page."""
    return Pictures(selection, gear, words_of(reader_of(context)))


def words_of(reader: Reader) -> plots.Words:
    """Language and units of a reader, as plots take them."""
    return plots.Words(
        translate=reader.text,
        show=reader.quantity,
        number=reader.figure,
        unit=reader.unit,
        convert=lambda value, unit: reader.measure(unit).shown(value),
        separators=reader.decimal + reader.group,
    )


def as_attribute(figure: plots.Figure) -> Markup:
    """A figure as JSON in a single-quoted attribute, where its many double quotes may stand as they are."""
    text = orjson.dumps(figure).decode()
    return Markup(text.replace("&", "&amp;").replace("'", "&#39;").replace("<", "&lt;"))


def sample(trace: dict[str, Any]) -> Markup:
    """Attributes of the line that stands for a trace in the legend."""
    line = trace["line"]
    dash = DASHES.get(line["dash"], "none")
    return Markup(f'stroke-width="{line["width"]}" stroke-dasharray="{dash}" style="stroke: {line["color"]}"')


GLOBALS = {"pictures_of": pictures_of}
FILTERS = {"as_attribute": as_attribute, "sample": sample}

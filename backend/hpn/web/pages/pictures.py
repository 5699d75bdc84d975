"""Pictures of the candidate that the page looks at, in the language and units of its reader."""

from dataclasses import dataclass
from functools import cached_property
from xml.etree.ElementTree import Element

import orjson
from markupsafe import Markup

from hpn.application import Application
from hpn.catalogue import Catalogue
from hpn.catalogue.gear import Gear
from hpn.engine.selection import Candidate
from hpn.explain import drawings
from hpn.explain.drawings import BearingPicture, CyclePicture, Figure, Plane, Scene, SizeUse, Subject
from hpn.explain.drawings.svg import markup
from hpn.web.door.visit import current
from hpn.words.reader import Reader
from hpn.words.wording import Sentence


@dataclass(frozen=True)
class Pictures:
    """Pictures that the templates draw or hand to Plotly; each is made when a template asks for it.

    `chosen` is the candidate that is looked at, as it was judged just now or when it was saved.
    """

    subject: Subject
    chosen: Candidate
    reader: Reader

    @cached_property
    def cycle(self) -> CyclePicture:
        """Duty cycle or motion over time."""
        subject, check = self.subject, self.chosen.governing_check
        return drawings.cycle_picture(subject.application, subject, self.reader, self.governing, check)

    @cached_property
    def governing(self) -> tuple[int, ...]:
        """Places of the phases that the governing check of the candidate goes by."""
        return drawings.governing_phases(self.subject, self.chosen.governing_check, self.bearing)

    @cached_property
    def bearing(self) -> BearingPicture | None:
        """Permitted and given loads of the output bearing, or None where it is not rated."""
        return drawings.bearing_picture(self.subject, self.chosen.check("output_bearing_life"))

    @cached_property
    def _envelope(self) -> Scene:
        assert self.bearing is not None
        return drawings.envelope_scene(self.bearing, self.reader, self.governing, self.chosen.governing_check)

    @cached_property
    def envelope(self) -> list[Element]:
        """Drawings of `bearing`, which must be there, for a narrow and for a wide place."""
        return self._drawn(self._envelope)

    @property
    def bearing_figure(self) -> Figure:
        """Plotly figure of `bearing`, which must be there."""
        assert self.bearing is not None
        return drawings.bearing_figure(self._envelope, self.bearing, self.reader)

    def _drawn(self, scene: Scene) -> list[Element]:
        return [drawings.chart(scene, self.reader, size) for size in (drawings.SMALL, drawings.LARGE)]

    @cached_property
    def sizes(self) -> list[SizeUse]:
        """Bearing of every size under the conditions of `bearing`, which must be there."""
        assert self.bearing is not None
        return drawings.size_uses(self.subject, self.bearing)

    @property
    def sizes_drawing(self) -> list[Element]:
        """Drawings of all sizes, likewise."""
        return self._drawn(self._all_sizes)

    @property
    def sizes_figure(self) -> Figure:
        """Plotly figure of all sizes."""
        assert self.bearing is not None
        return drawings.sizes_figure(self._all_sizes, self.sizes, self.bearing, self.reader)

    @cached_property
    def _all_sizes(self) -> Scene:
        assert self.bearing is not None
        return drawings.sizes_scene(self.sizes, self.bearing, self.reader, self.governing)

    @property
    def carries(self) -> bool:
        """True where the bearing carries the loads, which must be given."""
        assert self.bearing is not None
        return drawings.carries(self.bearing)

    @property
    def verdict(self) -> Sentence:
        """Verdict on `bearing`, which must have loads."""
        assert self.bearing is not None
        return drawings.bearing_verdict(self.bearing)

    @property
    def words(self) -> list[Sentence]:
        """Grounds of the verdict."""
        assert self.bearing is not None
        return drawings.bearing_words(self.bearing)

    @cached_property
    def gear_plane(self) -> Plane:
        """Output torque against output speed, with the gear's limits."""
        return drawings.gear_plane(self.subject, self.reader, self.governing)

    @cached_property
    def motor_plane(self) -> Plane:
        """Motor torque against motor speed, with the motor's limits."""
        return drawings.motor_plane(self.subject, self.reader, self.governing)

    @cached_property
    def stop_figure(self) -> Figure | None:
        """Plotly figure of the emergency stops, or None where the gear is not rated."""
        return drawings.emergency_stop_figure(self.subject, self.reader)

    @property
    def stop_words(self) -> list[Sentence]:
        """The emergency stops in words."""
        return drawings.emergency_stop_words(self.subject)


def pictures_of(application: Application, gear: Gear, chosen: Candidate, catalogue: Catalogue) -> Pictures:
    """Pictures of one gear under an application, for whoever reads the page."""
    return Pictures(Subject(application, gear, catalogue), chosen, current())


def inline(drawing: Element | list[Element]) -> Markup:
    """A drawing, or one for each kind of place, as part of a page; an XML library made it, which escapes its texts."""
    return Markup("".join(map(markup, drawing if isinstance(drawing, list) else [drawing])))


def as_attribute(figure: Figure) -> Markup:
    """A figure as JSON in a single-quoted attribute, where its many double quotes may stand as they are."""
    text = orjson.dumps(figure).decode()
    return Markup(text.replace("&", "&amp;").replace("'", "&#39;").replace("<", "&lt;"))


FILTERS = {"as_attribute": as_attribute, "inline": inline}

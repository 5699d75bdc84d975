"""Pictures of a candidate in a reader's language and units, for the page and the report."""

from dataclasses import dataclass
from functools import cached_property
from xml.etree.ElementTree import Element

from hpn.engine.candidates import Candidate
from hpn.engine.centres import NeededCentre, needed_centres
from hpn.engine.envelopes import EnvelopeQuery
from hpn.explain.drawings.bearing import bearing_figure, sizes_figure
from hpn.explain.drawings.chart import LARGE, PLANE, SMALL, Scene, chart
from hpn.explain.drawings.cycle import CyclePicture, cycle_picture
from hpn.explain.drawings.envelope import envelope_scene, sizes_scene
from hpn.explain.drawings.layout import Figure
from hpn.explain.drawings.picture import BearingPicture, bearing_picture
from hpn.explain.drawings.plane import Plane, gear_plane, motor_plane
from hpn.explain.drawings.sizes import SizeUse, size_uses
from hpn.explain.drawings.stops import emergency_stop_words, stop_scene
from hpn.explain.drawings.subject import Subject
from hpn.explain.drawings.verdict import bearing_verdict, bearing_words, carries
from hpn.physics.equations import FloatArray
from hpn.words.reader import Reader
from hpn.words.wording import Sentence

_EXTREME = {
    "repeated_peak_torque": "peak_torque_Nm",
    "motor_peak_torque": "peak_torque_Nm",
    "maximum_input_speed": "peak_speed_rpm",
    "motor_speed": "peak_speed_rpm",
}
"""Checks of a phase's largest value -> that value."""


def governing_phases(subject: Subject, check: str | None, picture: BearingPicture | None) -> tuple[int, ...]:
    """Places of the phases that determine a check; empty for an average, a stop or a property."""
    if check in ("output_bearing_load", "output_bearing_life"):
        return tuple(picture.worst.places) if picture and picture.loads else ()
    if check not in _EXTREME:
        return ()
    values: FloatArray = getattr(subject.duty.phases, _EXTREME[check])[0, 0]
    return tuple((values == values.max()).nonzero()[0].tolist())


@dataclass(frozen=True)
class Pictures:
    """Pictures that page and report contain or pass to Plotly; each is made on first use.

    `chosen` is the selected candidate, of this moment or of a saved answer. Without a load the bearing is shown under a
    `condition`.
    """

    subject: Subject
    chosen: Candidate
    reader: Reader
    condition: EnvelopeQuery | None = None

    @cached_property
    def cycle(self) -> CyclePicture:
        """Duty cycle or motion over time."""
        subject, check = self.subject, self.chosen.governing_check
        return cycle_picture(subject.application, subject, self.reader, self.governing, check)

    @cached_property
    def governing(self) -> tuple[int, ...]:
        """Places of the phases that determine the governing check of the candidate."""
        return governing_phases(self.subject, self.chosen.governing_check, self.bearing)

    @property
    def governing_rows(self) -> tuple[int, ...]:
        """Numbers of these phases, or of their moves; empty if all are alike."""
        cycle = self.subject.application.duty_cycle
        of_motion = cycle.motion.course.move.tolist() if cycle.motion else range(len(cycle.load_phases))
        places = dict.fromkeys(of_motion[place] for place in self.governing)
        return () if len(places) == len({*of_motion}) else tuple(place + 1 for place in places)

    @cached_property
    def bearing(self) -> BearingPicture | None:
        """Permissible and given loads of the output bearing, or None if it is not rated."""
        return bearing_picture(self.subject, self.chosen.check("output_bearing_life"), self.condition)

    @property
    def without_lever(self) -> list[Element]:
        """Drawings of the loads at their own places while their lever is unknown; empty if nothing is rated."""
        life = self.chosen.check("output_bearing_life")
        picture = bearing_picture(self.subject, life, without_lever=True) if life and life.demand is None else None
        return self._draw(envelope_scene(picture, self.reader)) if picture else []

    @property
    def needed_centres(self) -> list[NeededCentre]:
        """Distance of the shaft's centre that each size needs if loads act off it."""
        return needed_centres(self.subject.of_sizes)

    @cached_property
    def envelope_scene(self) -> Scene:
        """Envelopes and loads of `bearing`, which must exist."""
        assert self.bearing is not None
        return envelope_scene(self.bearing, self.reader, self.governing, self.chosen.governing_check)

    @cached_property
    def envelope(self) -> list[Element]:
        """Drawings of `bearing`, which must exist, for a narrow and for a wide place."""
        return self._draw(self.envelope_scene)

    @property
    def bearing_figure(self) -> Figure:
        """Plotly figure of `bearing`, which must exist."""
        assert self.bearing is not None
        return bearing_figure(self.envelope_scene, self.bearing, self.reader)

    def _draw(self, scene: Scene) -> list[Element]:
        return [chart(scene, self.reader, size) for size in (SMALL, LARGE)]

    @cached_property
    def sizes(self) -> list[SizeUse]:
        """Bearing of every size under the conditions of `bearing`, which must exist."""
        assert self.bearing is not None
        return size_uses(self.subject, self.bearing)

    @property
    def sizes_figure(self) -> Figure:
        """Plotly figure of all sizes."""
        assert self.bearing is not None
        return sizes_figure(
            sizes_scene(self.sizes, self.bearing, self.reader, self.governing), self.sizes, self.bearing, self.reader
        )

    @property
    def carries(self) -> bool:
        """True if the bearing carries the loads, which must be given."""
        assert self.bearing is not None
        return carries(self.bearing)

    @property
    def verdict(self) -> Sentence:
        """Verdict on `bearing`, which must have loads."""
        assert self.bearing is not None
        return bearing_verdict(self.bearing)

    @property
    def words(self) -> list[Sentence]:
        """Grounds of the verdict."""
        assert self.bearing is not None
        return bearing_words(self.bearing)

    @cached_property
    def gear_plane(self) -> Plane:
        """Output torque against output speed, with the gear's limits."""
        return gear_plane(self.subject, self.reader, self.governing)

    @cached_property
    def motor_plane(self) -> Plane:
        """Motor torque against motor speed, with the motor's limits."""
        return motor_plane(self.subject, self.reader, self.governing)

    @cached_property
    def stops_drawing(self) -> Element | None:
        """Drawing of the emergency stops, or None if the gear is not rated."""
        scene = stop_scene(self.subject, self.reader)
        return chart(scene, self.reader, PLANE) if scene else None

    @property
    def stop_words(self) -> list[Sentence]:
        """The emergency stops in words."""
        return emergency_stop_words(self.subject)

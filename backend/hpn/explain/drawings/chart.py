"""The drawing of points within limits: loads in their envelopes, torques at their speeds, bars of how far they go.

One description for every page and for the report: `chart` makes it, a style sheet gives it its colours.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from math import isfinite
from xml.etree.ElementTree import Element, SubElement

from hpn.explain.drawings.axis import round_numbers
from hpn.explain.drawings.placing import LETTERS, Box, Places, around
from hpn.explain.drawings.svg import LETTER, Point, add, canvas, path, text, width_of
from hpn.explain.drawings.words import axis_title
from hpn.words.reader import Reader
from hpn.words.wording import N_

WIDTH, HEIGHT = 440.0, 250.0
"""Size of the drawing; each bar below it adds ROW to its height."""

TOP, RIGHT, BOTTOM, ROW = 8.0, 16.0, 40.0, 22.0
ROOM = 1.15
"""Axes reach this far beyond the largest value."""

MOST_SPACES, GAP = 6, 8.0
"""Most spaces between round numbers, and the least one between two of them, in units of the drawing."""

RADIUS, DOT, RING = 10.5, 2.5, 13.5
MARGIN = 3.5
SAME, REACH = 0.1, 130.0
"""Loads nearer than the first are one to the eye; those beyond the second are out of reach of a disc."""
BAR_END = 1.5
"""Utilisation at which a bar ends."""

LEAST_BAR = 24.0
TICK, CROSS = "M0 5l3 4l5 -9", "M0 0l8 8m0 -8l-8 8"
ALONG = (0.5, 0.42, 0.58, 0.34, 0.66, 0.26, 0.74, 0.18, 0.82)
ENDS = (0.12, 0.88, 0.16, 0.84, 0.2, 0.8, 0.08, 0.92, *ALONG)
"""Shares of the way along a line at which its name may stand, the best first."""


@dataclass(frozen=True, slots=True)
class Axes:
    """Quantities to the right and upwards: name (an English msgid) and unit of each."""

    across: str
    across_unit: str
    up: str
    up_unit: str


LOADS = Axes(N_("radial load"), "N", N_("axial load"), "N")


@dataclass(frozen=True, slots=True)
class Line:
    """A limit by its corners (across, up), from one axis to the other, or a curve.

    A strong one has its label on it and an area below it, others their label at their end; `kind` is what the style
    sheet calls it.
    """

    kind: str
    label: str
    corners: Sequence[Point]
    strong: bool = False


@dataclass(frozen=True, slots=True)
class Mark:
    """A load or another point: a dot at its exact place, and where it has a label, a disc with it there or beside it.

    `phases` are the places of the phases marked together with it, `told` is what it is in words, `used` its share of
    its limit.
    """

    kind: str
    label: str
    place: Point
    told: str
    used: float = 0.0
    outside: bool = False
    phases: Sequence[int] = ()


@dataclass(frozen=True, slots=True)
class Bar:
    """How far a limit is used, and how far it may be."""

    label: str
    used: float
    allowed: float
    outside: bool
    told: str


@dataclass(frozen=True, slots=True)
class Frame:
    """Where points stand in the drawing, whose axes end at `across` and `up`."""

    axes: Axes
    left: float
    across: float
    up: float

    @property
    def box(self) -> Box:
        """The part of the drawing between the axes."""
        return Box(self.left, TOP, WIDTH - RIGHT, HEIGHT - BOTTOM)

    @property
    def room(self) -> Box:
        """The part that discs and names may use: a little beyond the axes, up to their numbers."""
        box = self.box
        return Box(box.left - MARGIN, box.top, box.right + MARGIN, box.bottom + MARGIN)

    def at(self, point: Point) -> Point:
        """Where a point stands."""
        box = self.box
        x = box.left + min(point[0] / self.across, 1.0) * (box.right - box.left)
        return x, box.bottom - min(point[1] / self.up, 1.0) * (box.bottom - box.top)


def chart(
    lines: Sequence[Line],
    marks: Sequence[Mark],
    bars: Sequence[Bar],
    reader: Reader,
    ray: Point | None = None,
    axes: Axes = LOADS,
    beyond: Sequence[str] = (),
) -> Element:
    """Limits, points and bars. `ray` is a point whose direction from the origin is drawn.

    `beyond` are rows that name limits outside of what is drawn; a corner at infinity is at the end of its axis.
    """
    points = [*(corner for line in lines for corner in line.corners), *(mark.place for mark in marks)]
    frame = _frame(points, axes, reader)
    drawing = canvas("plane", WIDTH, HEIGHT + ROW * (len(bars) + len(beyond)))
    still = add(drawing, "g", "still", aria_hidden="true")
    _axes(still, frame, reader)
    places = Places(frame.room)
    for line in lines:
        corners = [frame.at(corner) for corner in line.corners]
        if line.strong:
            add(still, "path", "area", d=path([frame.at((0, 0)), *corners], closed=True))
        places.lines.append(corners)
    for line in sorted(lines, key=lambda line: line.strong):
        add(still, "path", f"line {line.kind}", d=path(frame.at(corner) for corner in line.corners))
    if ray:
        add(still, "path", "ray", d=path([frame.at((0, 0)), frame.at(ray)]))
    _marks(drawing, frame, marks, places)
    _labels(drawing, frame, lines, places)
    _bars(drawing, bars)
    for row, names in enumerate(beyond, len(bars)):
        text(still, "beyond", (WIDTH - RIGHT, HEIGHT + ROW * row + 14), names, "end")
    return drawing


# --- Axes -------------------------------------------------------------------------------------------------------------


def _frame(points: Sequence[Point], axes: Axes, reader: Reader) -> Frame:
    across, up = (ROOM * max(filter(isfinite, values)) or 1.0 for values in zip(*points, strict=True))
    numbers = _numbers(up, axes.up_unit, MOST_SPACES - 1, reader)
    return Frame(axes, LETTER + 12 + max(width_of(label) for _, label in numbers), across, up)


def _numbers(largest: float, unit: str, spaces: int, reader: Reader) -> list[tuple[float, str]]:
    """Round numbers of the reader's unit along an axis: each in the unit of the wire, and as it is written."""
    end = reader.measure(unit).shown(largest)
    return [(largest * number / end, reader.tick(number)) for number in round_numbers(0.0, end, spaces)] or [(0.0, "0")]


def _axes(drawing: Element, frame: Frame, reader: Reader) -> None:
    box = frame.box
    axes = frame.axes
    for value, label in _numbers(frame.up, axes.up_unit, MOST_SPACES - 1, reader):
        _, y = frame.at((0.0, value))
        add(drawing, "path", "grid", d=path([(box.left, y), (box.right, y)]))
        text(drawing, "tick", (box.left - 5, y + 4.5), label, "end")
    for value, label in _spread(frame, reader):
        x, _ = frame.at((value, 0.0))
        add(drawing, "path", "grid", d=path([(x, box.top), (x, box.bottom)]))
        text(drawing, "tick", (min(x, WIDTH - width_of(label) / 2), box.bottom + 16), label, "middle")
    add(drawing, "path", "axis", d=path([(box.left, box.top), (box.left, box.bottom), (box.right, box.bottom)]))
    middle = (box.left + box.right) / 2, HEIGHT - 7
    text(drawing, "title", middle, axis_title(axes.across, axes.across_unit, reader), "middle")
    title = text(drawing, "title", (0, 0), axis_title(axes.up, axes.up_unit, reader), "middle")
    title.set("transform", f"translate({LETTER - 1:g} {(box.top + box.bottom) / 2:g}) rotate(-90)")


def _spread(frame: Frame, reader: Reader) -> list[tuple[float, str]]:
    """Numbers of the axis to the right, as many as have room beside each other."""
    for spaces in range(MOST_SPACES, 1, -1):
        numbers = _numbers(frame.across, frame.axes.across_unit, spaces, reader)
        widest = max(width_of(label) for _, label in numbers)
        steps = [frame.at((value, 0.0))[0] for value, _ in numbers]
        if all(after - before >= widest + GAP for before, after in pairwise(steps)):
            return numbers
    return numbers[:1]


# --- Points -----------------------------------------------------------------------------------------------------------


def _marks(drawing: Element, frame: Frame, marks: Sequence[Mark], places: Places) -> None:
    """Dots first, so that no disc hides one that is not its own; then the discs, the most used load first, P_m last."""
    named = sorted((place for place, mark in enumerate(marks) if mark.label), key=lambda place: -marks[place].used)
    dots = [Box.around(frame.at(mark.place), 2 * DOT, 2 * DOT) for mark in marks]
    centred: list[Box] = []
    leaders = add(drawing, "g", "still", aria_hidden="true")
    groups = [_group(drawing, mark) for mark in marks]
    circles = [
        add(group, "circle", "dot", cx=dot.centre[0], cy=dot.centre[1], r=DOT)
        for group, dot in zip(groups, dots, strict=True)
    ]
    for place in named:
        mark, dot = marks[place], dots[place]
        others = [other for other in dots if SAME < _apart(other, dot) < REACH]
        taken = places.taken
        places.taken = [*taken, *others]
        size = _size(mark)
        spot = places.first(around(dot.centre, *size))
        places.taken = [*taken, *([spot] if spot else [])]
        if spot and spot.centre == dot.centre:
            centred.append(dot)
        elif spot and any(_apart(other, dot) <= SAME for other in centred):
            groups[place].remove(circles[place])  # it would lie on the number of that disc
        if spot:
            _disc(groups[place], leaders, mark, dot.centre, spot)
    places.taken += dots


def _apart(one: Box, other: Box) -> float:
    return max(abs(one.left - other.left), abs(one.top - other.top))


def _group(drawing: Element, mark: Mark) -> Element:
    state = " outside" if mark.outside else ""
    group = add(drawing, "g", f"mark {mark.kind}{state}", data_phase=" ".join(map(str, mark.phases)))
    if mark.told:
        group.set("role", "img")
        SubElement(group, "title").text = mark.told
    return group


def _size(mark: Mark) -> tuple[float, float]:
    """Room for a disc, and for the ring and the cross of a load beyond its limit."""
    ring = RING if mark.outside else RADIUS
    return 2 * ring + _excess(mark.label) + 1, 2 * ring + 1


def _excess(label: str) -> float:
    """Width of a label beyond two digits, which a disc is made for."""
    return max(width_of(label) - width_of("00"), 0.0)


def _disc(group: Element, leaders: Element, mark: Mark, dot: Point, spot: Box) -> None:
    (x, y), half = spot.centre, RADIUS + _excess(mark.label) / 2
    if (x, y) != dot:
        add(leaders, "path", "leader", d=path([dot, (x, y)]))
    if mark.outside:
        wide = half + RING - RADIUS
        add(group, "rect", "ring", x=x - wide, y=y - RING, width=2 * wide, height=2 * RING, rx=RING)
        across, up = x + wide - 4, y - RING + 4
        add(group, "path", "cross", d=CROSS, transform=f"translate({across - 4:.1f} {up - 4:.1f})")
    group.set("tabindex", "0")
    add(group, "rect", "disc", x=x - half, y=y - RADIUS, width=2 * half, height=2 * RADIUS, rx=RADIUS)
    text(group, "number", (x, y + 4.3), mark.label, "middle")


# --- Names of the lines -----------------------------------------------------------------------------------------------


def _labels(drawing: Element, frame: Frame, lines: Sequence[Line], places: Places) -> None:
    """Each line has its name on it, where the fewest lines cross it: a strong one in its middle, others at an end."""
    group = add(drawing, "g", "still", aria_hidden="true")
    for line in sorted((line for line in lines if line.label), key=lambda line: not line.strong):
        corners = [frame.at(corner) for corner in line.corners]
        size = width_of(line.label) + 4, LETTER + 2
        shares = ALONG if line.strong else ENDS
        boxes = [Box.around(_along(corners, share), *size) for share in shares]
        spot = places.clearest(boxes) or places.clearest(_shifted(box, places.frame) for box in boxes)
        if spot:
            _name(group, line, spot)


def _shifted(box: Box, room: Box) -> Box:
    """A box that stands beside its line, at the edge of the room, where it has none on the line."""
    width = box.right - box.left
    left = max(min(box.left, room.right - width), room.left)
    return Box(left, box.top, left + width, box.bottom)


def _name(group: Element, line: Line, spot: Box) -> None:
    width, height = LETTERS * (spot.right - spot.left), spot.bottom - spot.top - 2
    back = Box.around(spot.centre, width, height)
    add(group, "rect", "back", x=back.left, y=back.top, width=width, height=height)
    text(group, f"name {line.kind}", (spot.centre[0], spot.bottom - 4), line.label, "middle")


def _along(corners: Sequence[Point], share: float) -> Point:
    """Point at a share of the way along a line, by its extent across and down."""
    lengths = [abs(x1 - x0) + abs(y1 - y0) for (x0, y0), (x1, y1) in pairwise(corners)]
    rest = share * sum(lengths)
    for length, (start, end) in zip(lengths, pairwise(corners), strict=True):
        if rest <= length:
            part = rest / length if length else 0.0
            return start[0] + part * (end[0] - start[0]), start[1] + part * (end[1] - start[1])
        rest -= length
    return corners[-1]


# --- Bars -------------------------------------------------------------------------------------------------------------


def _bars(drawing: Element, bars: Sequence[Bar]) -> None:
    """Name, bar on a scale to BAR_END with a tick at what is allowed, and the numbers."""
    if not bars:
        return
    left = 16 + max(width_of(bar.label) for bar in bars)
    right = max(WIDTH - 26 - max(width_of(bar.told) for bar in bars), left + LEAST_BAR)
    unit = (right - left) / BAR_END
    for place, bar in enumerate(bars):
        top = HEIGHT + 4 + ROW * place
        outside = bar.outside
        group = add(drawing, "g", "gauge outside" if outside else "gauge")
        text(group, "name", (8, top + 12), bar.label)
        add(group, "rect", "track", x=left, y=top + 1, width=right - left, height=13)
        add(group, "rect", "used", x=left, y=top + 1, width=unit * min(bar.used, BAR_END), height=13)
        tick = left + unit * bar.allowed
        add(group, "path", "allowed", d=path([(tick, top - 2), (tick, top + 17)]))
        add(group, "path", "sign", d=CROSS if outside else TICK, transform=f"translate({right + 8:.1f} {top + 3:.1f})")
        text(group, "told", (right + 22, top + 12), bar.told)

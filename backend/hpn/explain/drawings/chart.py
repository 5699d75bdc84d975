"""The drawing of points within limits: loads in their envelopes, torques at their speeds.

One description for every page and for the report: `chart` draws it, a style sheet colours it.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise
from math import atan2, degrees, hypot, isfinite
from xml.etree.ElementTree import Element, SubElement

from hpn.explain.drawings.axis import round_numbers
from hpn.explain.drawings.placing import LabelRoom, Rectangle, Spot, around
from hpn.explain.drawings.svg import LETTER, Point, add, canvas, path, text, width_of
from hpn.explain.drawings.words import axis_title
from hpn.words.reader import Reader
from hpn.words.wording import N_

SMALL, LARGE, PLANE, PAPER = (348.0, 400.0), (560.0, 420.0), (400.0, 260.0), (400.0, 300.0)
"""Sizes of a drawing: in a narrow and in a wide place, lower in a narrow place, and on paper."""

KINDS = {SMALL: "plane small", LARGE: "plane large", PLANE: "plane beside", PAPER: "plane"}

TOP, RIGHT, BOTTOM, ROW = 26.0, 12.0, 38.0, 20.0
"""Room above, beside and below the axes, and for a row of limits beyond them."""

ROOM = 1.15
"""Reach of the axes, as a multiple of the largest value."""

MOST_SPACES, GAP = 6, 8.0
"""Largest number of spaces between round numbers, and the least space between two numbers, in units of the drawing."""

RADIUS, DOT, RING = 9.0, 2.5, 12.0
MARGIN = 3.5
SAME, REACH = 0.1, 130.0
"""Distances: loads nearer than the first look like one; loads beyond the second are out of a disc's reach."""

MOST_NUMBERS = 24
"""Phases or loads, at most, with numbered discs, those nearest to their limit; others are dots."""

LAST = -1.0
"""Value of `used` for a mark whose disc gives way to all others."""

ASIDE = 10.0
"""Distance of the middle of a name from its line."""

CROSS = "M0 0l8 8m0 -8l-8 8"
ALONG = (0.5, 0.42, 0.58, 0.34, 0.66, 0.26, 0.74, 0.18, 0.82)
ENDS = (0.12, 0.88, 0.16, 0.84, 0.2, 0.8, 0.08, 0.92, *ALONG)
"""Shares of the way along a line at which its name may stand, the best first."""


@dataclass(frozen=True, slots=True)
class ChartAxes:
    """Quantities to the right and upwards: name (an English msgid) and unit of each.

    With `powers` the upward axis has powers of ten.
    """

    across: str
    across_unit: str
    up: str
    up_unit: str
    powers: bool = False


LOADS = ChartAxes(N_("radial load"), "N", N_("axial load"), "N")


@dataclass(frozen=True, slots=True)
class LimitCurve:
    """A limit by its corners (across, up), from one axis to the other, or a curve.

    A strong limit has its label in its middle and an area below it, others have their label at their end; `kind` is its
    class in the style sheet, `full_name` its name in full, and `load_coefficient` its load coefficient.
    """

    kind: str
    label: str
    corners: Sequence[Point]
    strong: bool = False
    full_name: str = ""
    load_coefficient: float | None = None


@dataclass(frozen=True, slots=True)
class Mark:
    """A load or another point: a dot at its exact place, and for a label a disc there or beside it.

    `phases` are the places of the phases marked together with it, `full_name` describes it in words, `used` is its
    share of its limit.
    """

    kind: str
    label: str
    place: Point
    full_name: str
    used: float = 0.0
    outside: bool = False
    phases: Sequence[int] = ()


@dataclass(frozen=True, slots=True)
class Scene:
    """Content of a plane: limits, points, and a ray.

    The ray leads from the origin to its first point, and on to the limit in its direction. A lever leads from a load at
    its own place to its equivalent. `beyond` are rows with the names of limits outside the drawing; a corner at
    infinity is at the end of its axis.
    """

    lines: Sequence[LimitCurve]
    marks: Sequence[Mark]
    ray: tuple[Point, Point] | None = None
    axes: ChartAxes = LOADS
    beyond: Sequence[str] = ()
    levers: Sequence[tuple[Point, Point]] = ()


@dataclass(frozen=True, slots=True)
class Frame:
    """Places of points in a drawing of a size, whose axes end at `across` and `up`."""

    axes: ChartAxes
    size: Point
    left: float
    across: float
    up: float

    @property
    def box(self) -> Rectangle:
        """Part of the drawing between the axes."""
        return Rectangle(self.left, TOP, self.size[0] - RIGHT, self.size[1] - BOTTOM)

    @property
    def room(self) -> Rectangle:
        """Part of the drawing for discs and names: a little beyond the axes, up to their numbers."""
        box = self.box
        return Rectangle(box.left - MARGIN, box.top, box.right + MARGIN, box.bottom + MARGIN)

    def at(self, point: Point) -> Point:
        """Place of a point in the drawing."""
        box = self.box
        x = box.left + min(point[0] / self.across, 1.0) * (box.right - box.left)
        return x, box.bottom - min(point[1] / self.up, 1.0) * (box.bottom - box.top)


def chart(scene: Scene, reader: Reader, size: Point = SMALL) -> Element:
    """A scene as an SVG drawing."""
    lines, marks, ray, axes = scene.lines, scene.marks, scene.ray, scene.axes
    points = [*(corner for line in lines for corner in line.corners), *(mark.place for mark in marks)]
    bold = list(_bold(lines))
    frame = _frame(points, [corner for corner, _ in bold], axes, size, reader)
    drawing = canvas(KINDS[size], size[0], size[1] + ROW * len(scene.beyond))
    still = add(drawing, "g", "still", aria_hidden="true")
    places = LabelRoom(frame.room)
    for line in lines:
        corners = [frame.at(corner) for corner in line.corners]
        if line.strong:
            add(still, "path", "area", d=path([frame.at((0, 0)), *corners], closed=True))
        places.lines.append(corners)
    _axes(still, frame, bold, reader)
    for line in sorted(lines, key=lambda line: line.strong):
        add(still, "path", f"line {line.kind}", d=path(frame.at(corner) for corner in line.corners))
    if ray:
        add(still, "path", "ray", d=path([frame.at((0, 0)), frame.at(ray[0])]))
        add(still, "path", "ray rest", d=path([frame.at(ray[0]), frame.at(_within(frame, ray[1]))]))
    for lever in scene.levers:
        add(still, "path", "lever", d=path(frame.at(point) for point in lever))
    _marks(drawing, frame, marks, places)
    _labels(drawing, frame, lines, places)
    for row, names in enumerate(scene.beyond):
        text(still, "beyond", (size[0] - RIGHT, size[1] + ROW * row + 12), names, "end")
    return drawing


def _bold(lines: Sequence[LimitCurve]) -> Iterator[tuple[Point, str]]:
    """Ends of the lines with values in bold on the axes, the governing line first, with the kind of their number."""
    for kind, of_kind in (("tick own governing", True), ("tick own", False)):
        for line in lines:
            if line.label and ("governing" in line.kind) == of_kind and (of_kind or line.strong):
                yield from ((line.corners[end], kind) for end in (0, -1))


def _within(frame: Frame, point: Point) -> Point:
    """A point, or the place where its direction leaves the axes."""
    factor = max(1.0, point[0] / frame.across, point[1] / frame.up)
    return point[0] / factor, point[1] / factor


# --- Axes -------------------------------------------------------------------------------------------------------------


def _frame(points: Sequence[Point], bold: Sequence[Point], axes: ChartAxes, size: Point, reader: Reader) -> Frame:
    across, up = (ROOM * max(filter(isfinite, values)) or 1.0 for values in zip(*points, strict=True))
    labels = [label for _, label in _upwards(up, axes, reader)]
    labels += [reader.figure(corner[1], axes.up_unit) for corner in bold]
    return Frame(axes, size, 12 + max(map(width_of, labels)), across, up)


def _numbers(largest: float, unit: str, spaces: int, reader: Reader) -> list[tuple[float, str]]:
    """Round numbers of the reader's unit along an axis: each in the unit of the wire, and as written."""
    end = reader.measure(unit).number(largest)
    return [(largest * number / end, reader.tick(number)) for number in round_numbers(0.0, end, spaces)] or [(0.0, "0")]


def _upwards(largest: float, axes: ChartAxes, reader: Reader) -> list[tuple[float, str]]:
    """Round numbers of the axis upwards."""
    numbers = _numbers(largest, axes.up_unit, MOST_SPACES, reader)
    return [(number, reader.power_of_ten(round(number))) for number, _ in numbers] if axes.powers else numbers


def _axes(drawing: Element, frame: Frame, bold: Sequence[tuple[Point, str]], reader: Reader) -> None:
    """Draw both axes with titles and round numbers, and in bold the values where the corners of a limit meet them."""
    box, axes = frame.box, frame.axes
    strokes = [path([(box.left, box.top), (box.left, box.bottom), (box.right, box.bottom)])]
    own = [(corner[1], reader.figure(corner[1], axes.up_unit), kind) for corner, kind in bold if corner[0] == 0]
    stretches: list[Point] = []
    for value, label, kind in (*own, *((*number, "tick") for number in _upwards(frame.up, axes, reader))):
        _, y = frame.at((0.0, value))
        if _is_free(stretches, y, LETTER / 2):
            strokes.append(path([(box.left - 4, y), (box.left, y)]))
            text(drawing, kind, (box.left - 7, y + 4.5), label, "end")
    own = [(corner[0], reader.figure(corner[0], axes.across_unit), kind) for corner, kind in bold if corner[1] == 0]
    stretches = []
    for value, label, kind in (*own, *((*number, "tick") for number in _spread(frame, reader))):
        x, half = frame.at((value, 0.0))[0], width_of(label) / 2
        if _is_free(stretches, x, half + GAP / 2):
            strokes.append(path([(x, box.bottom), (x, box.bottom + 4)]))
            text(drawing, kind, (min(x, frame.size[0] - half), box.bottom + 18.5), label, "middle")
    add(drawing, "path", "axis", d="".join(strokes))
    text(drawing, "title", (0.0, 11.0), axis_title(axes.up, axes.up_unit, reader))
    text(
        drawing,
        "title",
        (frame.size[0] - 2, frame.size[1] - 4),
        axis_title(axes.across, axes.across_unit, reader),
        "end",
    )


def _is_free(stretches: list[Point], at: float, half: float) -> bool:
    """True for a free stretch around a place, which is then taken."""
    if any(start < at + half and at - half < end for start, end in stretches):
        return False
    stretches.append((at - half, at + half))
    return True


def _spread(frame: Frame, reader: Reader) -> list[tuple[float, str]]:
    """Numbers of the axis to the right, as many as fit beside each other."""
    for spaces in range(MOST_SPACES, 1, -1):
        numbers = _numbers(frame.across, frame.axes.across_unit, spaces, reader)
        widest = max(width_of(label) for _, label in numbers)
        steps = [frame.at((value, 0.0))[0] for value, _ in numbers]
        if all(after - before >= widest + GAP for before, after in pairwise(steps)):
            return numbers
    return numbers[:1]


# --- Points -----------------------------------------------------------------------------------------------------------


def _marks(drawing: Element, frame: Frame, marks: Sequence[Mark], places: LabelRoom) -> None:
    """Draw dots first, so that no disc hides another's dot; then the discs, the most used load first, P_m last."""
    named = sorted((place for place, mark in enumerate(marks) if mark.label), key=lambda place: -marks[place].used)
    dots = [Rectangle.around(frame.at(mark.place), 2 * DOT, 2 * DOT) for mark in marks]
    centred: list[Rectangle] = []
    leaders = add(drawing, "g", "still", aria_hidden="true")
    groups = [_group(drawing, mark) for mark in marks]
    circles = [
        add(group, "circle", "dot", cx=dot.centre[0], cy=dot.centre[1], r=DOT)
        for group, dot in zip(groups, dots, strict=True)
    ]
    for place in named:
        mark, dot = marks[place], dots[place]
        others = [other for other in dots if SAME < _apart(other, dot) < REACH]
        boxes = places.boxes
        places.boxes = [*boxes, *others]
        size = _size(mark)
        spot = places.first(around(dot.centre, *size))
        places.boxes = [*boxes, *([spot] if spot else [])]
        if spot:
            _disc(groups[place], leaders, mark, dot.centre, spot)
            centred += [dot] if spot.centre == dot.centre else []
    for group, circle, dot in zip(groups, circles, dots, strict=True):
        if any(other is not dot and _apart(other, dot) <= SAME for other in centred):
            group.remove(circle)  # it would cover the number of that disc
    places.boxes += dots


def _apart(one: Rectangle, other: Rectangle) -> float:
    return max(abs(one.left - other.left), abs(one.top - other.top))


def _group(drawing: Element, mark: Mark) -> Element:
    state = " outside" if mark.outside else ""
    group = add(drawing, "g", f"mark {mark.kind}{state}", data_phase=" ".join(map(str, mark.phases)))
    if mark.label and mark.full_name:
        group.set("role", "img")
        SubElement(group, "title").text = mark.full_name
    return group


def _size(mark: Mark) -> tuple[float, float]:
    """Room for a disc, and for the ring and the cross of a load beyond its limit."""
    ring = RING if mark.outside else RADIUS
    return 2 * ring + _excess(mark.label) + 1, 2 * ring + 1


def _excess(label: str) -> float:
    """Width of a label beyond the two digits of a disc."""
    return max(width_of(label) - width_of("00"), 0.0)


def _disc(group: Element, leaders: Element, mark: Mark, dot: Point, spot: Rectangle) -> None:
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


def _labels(drawing: Element, frame: Frame, lines: Sequence[LimitCurve], places: LabelRoom) -> None:
    """Draw each line's name along it, where the fewest lines cross: a strong one in its middle, others at an end."""
    group = add(drawing, "g", "still", aria_hidden="true")
    for line in sorted((line for line in lines if line.label), key=lambda line: not line.strong):
        corners = [frame.at(corner) for corner in line.corners]
        shares = [(share, side) for share in (ALONG if line.strong else ENDS) for side in (1, -1)]
        spots = (_beside(corners, share, side, line, turned) for turned in (True, False) for share, side in shares)
        if spot := places.clearest(spots):
            at = f"translate({spot.at[0]:.1f} {spot.at[1]:.1f}) rotate({spot.turn:.1f})"
            text(group, f"name {line.kind}", (0.0, 4.5), line.label, "middle").set("transform", at)


def _beside(corners: Sequence[Point], share: float, side: int, line: LimitCurve, turned: bool) -> Spot:
    """Place of a line's name at a share of the way along it, turned above or below it, or level beside it."""
    (x, y), (across, down) = _along(corners, share)
    length, half = hypot(across, down) or 1.0, width_of(line.label) / 2
    across, down = across / length, down / length
    if turned:
        at = x + side * ASIDE * down, y - side * ASIDE * across
    else:
        at, (across, down) = (x + side * (half + ASIDE / 2), y), (1.0, 0.0)
    count = max(round(2 * half / LETTER), 1)
    steps = [half * (2 * k + 1 - count) / count for k in range(count)]
    boxes = [Rectangle.around((at[0] + step * across, at[1] + step * down), LETTER, LETTER) for step in steps]
    return Spot(at, degrees(atan2(down, across)), boxes)


def _along(corners: Sequence[Point], share: float) -> tuple[Point, Point]:
    """Point at a share of the way along a line, by its extent across and down, and the direction at that point."""
    lengths = [abs(x1 - x0) + abs(y1 - y0) for (x0, y0), (x1, y1) in pairwise(corners)]
    rest = share * sum(lengths)
    for length, (start, end) in zip(lengths, pairwise(corners), strict=True):
        step = end[0] - start[0], end[1] - start[1]
        if rest <= length or end is corners[-1]:
            part = min(rest / length, 1.0) if length else 0.0
            return (start[0] + part * step[0], start[1] + part * step[1]), step
        rest -= length
    raise ValueError("a line has two corners")

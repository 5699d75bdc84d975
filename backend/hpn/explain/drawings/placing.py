"""Places for labels: none covers another, and of the free places the first with the fewest crossing lines is taken."""

from collections.abc import Iterable
from dataclasses import dataclass
from itertools import pairwise
from math import cos, inf, pi, sin

from hpn.explain.drawings.svg import Point

DISTANCES = (21.0, 29.0, 39.0, 52.0, 70.0)
LETTERS = 0.75
"""Part of a label's room that its letters fill in most fonts: a line may run beside them."""

DIRECTIONS = tuple((cos(turn * pi / 6), -sin(turn * pi / 6)) for turn in (1, 2, 0, 3, 11, 5, 10, 4, 9, 6, 8, 7))
"""Directions about a point; upwards to the right first, where a load has room beyond it."""


@dataclass(frozen=True, slots=True)
class Rectangle:
    """A rectangle with its sides along the axes, y downwards."""

    left: float
    top: float
    right: float
    bottom: float

    @classmethod
    def around(cls, centre: Point, width: float, height: float) -> "Rectangle":
        """Box of a size about its centre."""
        x, y = centre
        return cls(x - width / 2, y - height / 2, x + width / 2, y + height / 2)

    @property
    def centre(self) -> Point:
        """Its middle."""
        return (self.left + self.right) / 2, (self.top + self.bottom) / 2

    def meets(self, other: "Rectangle") -> bool:
        """True for rectangles with more than an edge in common."""
        across = self.left < other.right and other.left < self.right
        return across and self.top < other.bottom and other.top < self.bottom

    def within(self, other: "Rectangle") -> bool:
        """True for a rectangle wholly inside the other."""
        across = other.left <= self.left and self.right <= other.right
        return across and other.top <= self.top and self.bottom <= other.bottom

    def is_crossed(self, start: Point, end: Point) -> bool:
        """True for a line from start to end with a part inside (Liang and Barsky)."""
        if max(start[0], end[0]) <= self.left or min(start[0], end[0]) >= self.right:
            return False
        low, high = 0.0, 1.0
        edges = ((self.left, self.right), (self.top, self.bottom))
        for at, to, (first, last) in zip(start, end, edges, strict=True):
            if at == to:
                if not first < at < last:
                    return False
                continue
            enter, leave = sorted(((first - at) / (to - at), (last - at) / (to - at)))
            low, high = max(low, enter), min(high, leave)
        return low < high


@dataclass(frozen=True, slots=True)
class Spot:
    """Place of a text along a line: its middle, its turn in degrees, and boxes around its letters."""

    at: Point
    turn: float
    boxes: list[Rectangle]


class LabelRoom:
    """Room inside a frame: taken boxes, and lines that a label should avoid."""

    def __init__(self, frame: Rectangle) -> None:
        self.frame = frame
        self.boxes: list[Rectangle] = []
        self.lines: list[list[Point]] = []

    def is_free(self, box: Rectangle) -> bool:
        """True for a box inside the frame that covers no taken one."""
        return box.within(self.frame) and all(not box.meets(other) for other in self.boxes)

    def first(self, candidates: Iterable[Rectangle]) -> Rectangle | None:
        """Take the first free one of some boxes; None without one."""
        return self._take(next(filter(self.is_free, candidates), None))

    def clearest(self, spots: Iterable[Spot]) -> Spot | None:
        """Take the first of the free spots with the fewest crossing lines; None if none is free."""
        best, least = None, inf
        for spot in spots:
            if not all(map(self.is_free, spot.boxes)):
                continue
            crossings = sum(map(self._crossings, spot.boxes))
            if crossings < least:
                best, least = spot, crossings
            if least == 0:
                break
        self.boxes += best.boxes if best else []
        return best

    def _take(self, box: Rectangle | None) -> Rectangle | None:
        if box is not None:
            self.boxes.append(box)
        return box

    def _crossings(self, box: Rectangle) -> int:
        letters = Rectangle.around(box.centre, LETTERS * (box.right - box.left), LETTERS * (box.bottom - box.top))
        return sum(letters.is_crossed(start, end) for line in self.lines for start, end in pairwise(line))


def around(point: Point, width: float, height: float) -> Iterable[Rectangle]:
    """Yield boxes of a size at a point and around it, the nearest first."""
    yield Rectangle.around(point, width, height)
    for distance in DISTANCES:
        for across, down in DIRECTIONS:
            reach = distance + abs(across) * (width - height) / 2
            yield Rectangle.around((point[0] + reach * across, point[1] + distance * down), width, height)

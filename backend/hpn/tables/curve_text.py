"""Torque over speed as typed text: a point per line or between semicolons, `3000 : 2.4 : 7.2`."""

from collections.abc import Callable, Iterable, Iterator

UNITS = ("rpm", "Nm", "Nm")
"""Units of the numbers of a point: speed, continuous and peak torque."""


class CurveText(str):
    """Points in one text, `0:2.8:7.2;3000:2.4:7.2`, with their numbers as texts."""

    points: tuple[tuple[str, ...], ...]

    def __new__(cls, points: Iterable[tuple[str, ...]]) -> "CurveText":
        """A text equal to its points as a link writes them."""
        own = tuple(points)
        text = super().__new__(cls, ";".join(":".join(point) for point in own))
        text.points = own
        return text

    @property
    def cells(self) -> Iterator[tuple[str, str]]:
        """Its numbers with their units; a fourth number of a point is one too many and has a blank unit."""
        for point in self.points:
            for place, number in enumerate(point):
                yield number, UNITS[place] if place < len(UNITS) else ""

    def over(self, entry: Callable[[str, str], str]) -> "CurveText":
        """The same points, each number replaced by `entry(number, unit)`."""
        texts = iter([entry(number, unit) for number, unit in self.cells])
        return CurveText(tuple(next(texts) for _ in point) for point in self.points)

    @property
    def for_field(self) -> str:
        """The text for a field: a line per point."""
        return "\n".join(" : ".join(point) for point in self.points)


def curve_text(text: str) -> CurveText:
    """Points of a text."""
    if isinstance(text, CurveText):
        return text
    points = filter(str.strip, text.replace(";", "\n").replace("\r", "\n").split("\n"))
    return CurveText(tuple(number.strip() for number in point.split(":")) for point in points)

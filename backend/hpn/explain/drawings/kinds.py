"""The drawing of fewest kinds: mass of all gears over the number of kinds."""

from collections.abc import Sequence
from xml.etree.ElementTree import Element

from hpn.explain.drawings.svg import Point, add, canvas, path, text
from hpn.words.reader import DEFAULT, Reader
from hpn.words.wording import N_

WIDTH, HEIGHT = 296.0, 180.0
LEFT, RIGHT, TOP, BOTTOM = 12.0, 18.0, 42.0, 36.0
MOST_STEPS, APART = 8, 46.0
"""Numbers on the axis, at most, and room for the mass beside a point."""

STEEP = 3.0
"""Ratio to the least mass above which a mass lies outside the scale and is written above it."""


def kinds_curve(steps: Sequence[tuple[int, float]], reader: Reader = DEFAULT) -> Element | None:
    """Curve of mass in kg over numbers of kinds, the present number last; None with fewer than two."""
    places = sorted(steps)[-MOST_STEPS:]
    if len(places) < 2:
        return None
    drawing = canvas("kinds", WIDTH, HEIGHT)
    least = min(mass for _, mass in places)
    inside = [(count, mass) for count, mass in places if mass <= STEEP * least]
    low, high = least, max(max(mass for _, mass in inside), 1.01 * least)
    first, last = places[0][0], places[-1][0]

    def place(count: int, mass: float) -> Point:
        across = LEFT + (WIDTH - LEFT - RIGHT) * (count - first) / (last - first)
        return across, HEIGHT - BOTTOM - (HEIGHT - TOP - BOTTOM) * min((mass - low) / (high - low), 1.0)

    floor = HEIGHT - BOTTOM + 8
    add(drawing, "path", "axis", d=path([(LEFT - 8, floor), (WIDTH - RIGHT + 8, floor)]))
    points = [place(*step) for step in places]
    beyond = len(places) - len(inside)
    if beyond:
        add(drawing, "path", "line beyond", d=path([(points[beyond - 1][0], TOP - 6), points[beyond]]))
    add(drawing, "path", "line", d=path(points[beyond:]))
    written_at = WIDTH + APART
    for (count, mass), (x, y) in reversed(list(zip(places, points, strict=True))):
        is_inside, is_now = mass <= STEEP * least, count == last
        text(drawing, "name", (x, HEIGHT - 14), str(count), "middle")
        if is_inside:
            add(drawing, "circle", "disc now" if is_now else "disc", cx=x, cy=y, r=4.0)
        if is_now or written_at - x >= APART:
            label = reader.mass(mass)
            mark, height = (label, y) if is_inside else (f"↑ {label}", TOP)
            text(drawing, "phase", (WIDTH if is_now else x + 4, height - 9), mark, "end" if is_now else "start")
            written_at = WIDTH - APART + 4 if is_now else x + 4
    text(drawing, "title", (0, 12), reader.unit("kg"))
    text(drawing, "title", (WIDTH, HEIGHT - 1), reader.text(N_("kinds")), "end")
    return drawing

"""Values over time as one drawing: panels above each other on one time axis, with the names of limits at the right."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from xml.etree.ElementTree import Element, SubElement

import numpy as np

from hpn.explain.drawings.svg import Point, add, canvas, path, runs, text, width_of
from hpn.explain.drawings.words import axis_title
from hpn.physics.equations import FloatArray
from hpn.words.reader import Reader

WIDTH, RIGHT = 344.0, 234.0
"""Width of the drawing, and right end of its time axis: names of limits stand beyond it."""

LETTER, TITLE, ROW, BETWEEN = 13.0, 19.0, 25.0, 8.0
"""Least distance of two texts below each other, and heights of a title, of the row of phase numbers, and of a gap."""

RADIUS, APART, SHIFTS = 9.0, 18.0, (0.0, 2.0, -2.0, 4.0, -4.0, 6.0, -6.0, 8.0)
"""Radius of a phase number's disc, the least distance of two, and possible shifts from the phase's middle."""

CAPITAL = 9.0
"""Height of a figure."""

NAME = LETTER + 3
"""Least distance of the names of two levels: an index reaches below its line."""

NAMED_LETTERS = 14.8
"""Letters of a limit and its value that fit at the right; those of an index count four fifths."""

SMALLER = 0.82
"""Letter size here, as a share of the size that `width_of` assumes."""

HEADROOM, OUT_OF_SCALE = 1.08, 2.2
"""Reach of an axis beyond its values, and multiple of the values beyond which a limit is only named, with an arrow."""

MOST_BOUNDARIES = 24
"""Largest number of stretches of time with a number each, and a line at each start."""

STRAIGHT = 0.05
"""Deviation, in units of the drawing, up to which a piece is drawn as a straight line."""


@dataclass(frozen=True, slots=True)
class Level:
    """A limit or an average to compare a curve with; `kind` is its class in the style sheet."""

    symbol: str
    value: float
    kind: str


@dataclass(frozen=True, eq=False)
class Panel:
    """One diagram: a curve of values, shape (pieces, instants), and the peaks of each piece beyond them.

    For a case within tolerances, `band` has the given values, and the smallest and largest within their tolerance.
    """

    quantity: str
    unit: str
    height: float
    values: FloatArray
    levels: Sequence[Level] = ()
    peaks: FloatArray | None = None
    band: Sequence[FloatArray] = ()

    @cached_property
    def extremes(self) -> Point:
        """Smallest and largest value, 0 included."""
        peaks = () if self.peaks is None else (self.peaks,)
        known = np.concatenate((self.values, *peaks, *self.band))
        return min(known.min().item(), 0.0), max(known.max().item(), 0.0)

    @cached_property
    def range(self) -> Point:
        """Ends of the axis: the smallest and the largest value, levels near to them included."""
        low, high = self.extremes
        reach = max(-low, high) * OUT_OF_SCALE
        high = max(high, *(level.value for level in self.levels if level.value <= reach), 0.0)
        return (low, high) if high > low else (0.0, 1.0)

    def is_beyond(self, level: Level) -> bool:
        """True for a level beyond the scale."""
        return level.value > self.range[1] * (1 + 1e-9)


@dataclass(frozen=True, slots=True)
class Stretch:
    """A part of the time axis in units of the drawing, its phases, and their name, if any."""

    start: float
    end: float
    phases: Sequence[int]
    name: str = ""

    @property
    def middle(self) -> float:
        """Place of its number."""
        return (self.start + self.end) / 2


@dataclass(frozen=True, eq=False)
class TimeAxis:
    """The time axis: places of all instants, stretches of phases, stretches with a number, and the pause.

    `times` are numbers along the axis by their places; `row` is the panel above the phase numbers.
    """

    x: FloatArray
    phases: Sequence[Stretch]
    numbered: Sequence[Stretch]
    pause: Stretch | None
    row: int
    times: Sequence[tuple[float, str]] = ()


def axis_left(panels: Sequence[Panel], reader: Reader) -> float:
    """Left end of the time axis, with room for the numbers of all panels beside it."""
    return 8 + SMALLER * max(width_of(_figure(value, panel, reader)) for panel in panels for value in _ticks(panel))


def over_time(panels: Sequence[Panel], axis: TimeAxis, reader: Reader, governing: Sequence[int] = ()) -> Element:
    """Drawing of panels on one time axis; governing phases stand out."""
    tops = _tops(panels, axis, reader)
    bottom = tops[-1] + panels[-1].height
    drawing = canvas("over-time", WIDTH, bottom + (ROW if axis.row == len(panels) - 1 else 0.0) + 8)
    _stretches(drawing, axis, (tops[0], bottom), governing)
    for top, panel in zip(tops, panels, strict=True):
        _panel(drawing, panel, top, axis, reader)
    _numbers(drawing, axis, tops[axis.row] + panels[axis.row].height + ROW / 2, governing)
    return drawing


def _tops(panels: Sequence[Panel], axis: TimeAxis, reader: Reader) -> list[float]:
    """Upper end of each panel, below its title and the row of levels beyond its scale."""
    tops, y = [], 0.0
    for place, panel in enumerate(panels):
        y += TITLE + (LETTER if _is_crowded(panel, reader) else 0.0)
        tops.append(y)
        y += panel.height + (ROW if place == axis.row else BETWEEN)
    return tops


def _is_crowded(panel: Panel, reader: Reader) -> bool:
    """True if the title leaves no room beside it for levels beyond the scale."""
    names = "  ".join(f"↑ {_named(level, panel, reader)}" for level in panel.levels if panel.is_beyond(level))
    return bool(names) and SMALLER * width_of(axis_title(panel.quantity, panel.unit, reader) + names) > WIDTH


def _stretches(drawing: Element, axis: TimeAxis, span: Point, governing: Sequence[int]) -> None:
    """Draw the pause and the phases across all panels, and lines at the start of numbered stretches."""
    top, height = span[0], span[1] - span[0]
    if axis.pause:
        across = {"x": axis.pause.start, "width": axis.pause.end - axis.pause.start}
        add(drawing, "rect", "pause", y=top, height=height, **across)
    for stretch in axis.phases:
        state = " governing" if set(stretch.phases) & set(governing) else ""
        across = {"x": stretch.start, "width": stretch.end - stretch.start}
        step = add(drawing, "rect", f"phase-step{state}", data_phase=_of(stretch), y=top, height=height, **across)
        if stretch.name:
            SubElement(step, "title").text = stretch.name
    for stretch in axis.numbered[1:] if len(axis.numbered) <= MOST_BOUNDARIES else ():
        add(drawing, "path", "boundary", d=path([(stretch.start, top), (stretch.start, span[1])]))


def _of(stretch: Stretch) -> str:
    return " ".join(map(str, stretch.phases))


# --- One panel --------------------------------------------------------------------------------------------------------


def _panel(drawing: Element, panel: Panel, top: float, axis: TimeAxis, reader: Reader) -> None:
    x, left = axis.x, axis.x.item(0)
    title = axis_title(panel.quantity, panel.unit, reader)
    text(drawing, "title", (0.0, top - 6 - (LETTER if _is_crowded(panel, reader) else 0.0)), title)
    ticks = _ticks(panel)
    for value, at in zip(ticks, _heights(panel, top, np.array(ticks)).tolist(), strict=True):
        add(drawing, "path", "axis", d=path([(left - 3, at), (left, at)]))
        text(drawing, "tick own" if value else "tick", (left - 6, at + 4.0), _figure(value, panel, reader), "end")
    zero = _heights(panel, top, np.zeros(1)).item()
    points = _thinned(x, _heights(panel, top, panel.values))
    outline = [(left, zero), *points, (points[-1][0], zero)]
    add(drawing, "path", "area", d=path(outline, closed=True))
    add(drawing, "path", "zero", d=path([(left, zero), (RIGHT, zero)]))
    if panel.band:
        nominal, *ends = (_thinned(x, _heights(panel, top, each)) for each in panel.band)
        add(drawing, "path", "band", d=path([*ends[0], *reversed(ends[1])], closed=True))
        add(drawing, "path", "given", d=path(nominal))
    if panel.peaks is not None:
        add(drawing, "path", "peaks", d=path(_thinned(x, _heights(panel, top, panel.peaks))))
    add(drawing, "path", "steps worst" if panel.band else "steps", d=path(outline))
    _levels(drawing, panel, top, left, reader)
    _peaks(drawing, panel, top, axis, reader)


def _heights(panel: Panel, top: float, values: FloatArray) -> FloatArray:
    """Places of values in a panel whose upper end is at `top`."""
    low, high = (HEADROOM * end for end in panel.range)
    return top + panel.height * ((high - values) / (high - low))


def _ticks(panel: Panel) -> list[float]:
    """Peaks and 0, as many as fit: the largest first, then 0."""
    low, high = panel.range if panel.extremes == (0.0, 0.0) else panel.extremes
    apart = LETTER / panel.height * HEADROOM * (panel.range[1] - panel.range[0])
    ticks = list[float]()
    for value in (max(low, high, key=abs), 0.0, min(low, high, key=abs)):
        if all(abs(value - other) >= apart for other in ticks):
            ticks.append(value)
    return ticks


def _figure(value: float, panel: Panel, reader: Reader) -> str:
    """A value as written on an axis or at its step."""
    number = reader.measure(panel.unit).number(value)
    return reader.figure(value, panel.unit) if 1e-3 <= abs(number) < 1e6 else reader.tick(number)


def _peaks(drawing: Element, panel: Panel, top: float, axis: TimeAxis, reader: Reader) -> None:
    """Draw peaks that the axis does not name at their places of the curve, clear of levels and of one another."""
    if len(axis.numbered) > MOST_BOUNDARIES:
        return
    peaks = [_peak(panel, axis.x, stretch) for stretch in axis.numbered]
    levels = [level.value for level in panel.levels if not panel.is_beyond(level)]
    lines = _heights(panel, top, np.array([0.0, *levels])).tolist()
    named = {_figure(value, panel, reader) for value in _ticks(panel)}
    end = axis.x.item(0) + 1
    for k, (x, value) in enumerate(peaks):
        beside = [other for _, other in (*peaks[max(k - 1, 0) : k], *peaks[k + 1 : k + 2]) if other * value > 0]
        label = _figure(value, panel, reader)
        half = SMALLER / 2 * width_of(label)
        baseline = _baseline(_heights(panel, top, np.array([value])).item(), value, (top, top + panel.height), lines)
        if label in named or any(abs(other) >= abs(value) for other in beside) or baseline is None:
            continue
        if end <= x - half and x + half <= RIGHT + 4:
            text(drawing, "peak", (x, baseline), label, "middle")
            end = x + half + 4


def _peak(panel: Panel, x: FloatArray, stretch: Stretch) -> Point:
    """Place and value of a stretch's peak; the middle of equal peaks."""
    values = panel.values if panel.peaks is None else panel.peaks
    own = (stretch.start <= x.mean(axis=1)) & (x.mean(axis=1) <= stretch.end)
    sizes = np.abs(values[own])
    highest = sizes >= sizes.max() * (1 - 1e-9)
    return x[own][highest].mean().item(), values[own][highest].item(0)


def _baseline(at: float, value: float, ends: Point, lines: Sequence[float]) -> float | None:
    """Baseline of a peak's figure: beyond the curve, within its panel, and clear of all lines; None without one."""
    baseline = at - 4 if value > 0 else at + 4 + CAPITAL
    inside = ends[0] - 1 <= baseline - CAPITAL and baseline <= ends[1] + 2
    clear = all(line <= baseline - CAPITAL - 1 or baseline + 1 <= line for line in lines)
    return baseline if inside and clear else None


def _named(level: Level, panel: Panel, reader: Reader) -> str:
    return f"{level.symbol} {reader.figure(level.value, panel.unit)}"


def _levels(drawing: Element, panel: Panel, top: float, left: float, reader: Reader) -> None:
    """Draw levels as lines with their names at the right, clear of one another; levels beyond the scale in the title's
    line.
    """
    levels = sorted(panel.levels, key=lambda level: -level.value)
    inside = [level for level in levels if not panel.is_beyond(level)]
    lines = _heights(panel, top, np.array([level.value for level in inside])).tolist()
    beyond = [(level.kind, f"↑ {_named(level, panel, reader)}") for level in levels if panel.is_beyond(level)]
    first = top + (11 if beyond else 0)
    for level, line, place in zip(inside, lines, _spread(lines, first, top + panel.height + 4), strict=True):
        add(drawing, "path", f"level {level.kind}", d=path([(left, line), (RIGHT + 4, line)]))
        name = _named(level, panel, reader)
        index = len(level.symbol.partition("_")[2].partition("/")[0])
        fits = len(name) - (index and 1 + 0.2 * index) <= NAMED_LETTERS
        text(drawing, f"name {level.kind}", (RIGHT + 8, place), name if fits else level.symbol)
    if beyond:
        runs(drawing, "beyond", (WIDTH, top - 6), beyond[::-1], "end")


def _spread(lines: Sequence[float], first: float, last: float) -> list[float]:
    """Baselines of names as near to their lines as the letters permit, between `first` and `last`."""
    places: list[float] = []
    for line in lines:
        places.append(max(line + 4, places[-1] + NAME if places else first))
    for k in reversed(range(len(places))):
        places[k] = last = min(places[k], last)
        last -= NAME
    return places


def _thinned(x: FloatArray, y: FloatArray) -> list[Point]:
    """Points of a curve: both ends of every piece, and the points between them unless they lie on a straight line."""
    share = (x - x[:, :1]) / np.where(x[:, -1:] > x[:, :1], x[:, -1:] - x[:, :1], 1.0)
    bent = (np.abs(y[:, :1] + share * (y[:, -1:] - y[:, :1]) - y) > STRAIGHT).any(axis=1)
    mask = np.zeros(x.shape, np.bool_)
    mask[:, (0, -1)] = True
    mask[bent] = True
    if mask.sum() > 4 * WIDTH:
        mask &= _extremes(x, y)
    points = list(zip(x[mask].tolist(), y[mask].tolist(), strict=True))
    return [point for place, point in enumerate(points) if not place or point != points[place - 1]]


def _extremes(x: FloatArray, y: FloatArray) -> np.ndarray:
    """True for the first, last, lowest and highest point in each slice of width 1: no others are visible in a line."""
    slices, heights = x.ravel().astype(np.intp), y.ravel()
    mask = np.zeros(len(heights), np.bool_)
    starts = np.flatnonzero(np.diff(slices, prepend=-1))
    order = np.lexsort((heights, slices))  # slices ascend, so that each keeps its place
    ends = np.append(starts[1:], len(heights)) - 1
    mask[starts] = mask[ends] = mask[order[starts]] = mask[order[ends]] = True
    return mask.reshape(x.shape)


# --- Numbers of phases and times --------------------------------------------------------------------------------------


def _numbers(drawing: Element, axis: TimeAxis, y: float, governing: Sequence[int]) -> None:
    """Draw numbers of stretches, the pause's name, and times, clear of one another, in this order of priority."""
    stretches: list[Point] = []

    def first_free(half: float, *places: float) -> float | None:
        free = (x for x in places if all(end <= x - half or x + half <= start for start, end in stretches))
        if (place := next(free, None)) is not None:
            stretches.append((place - half, place + half))
        return place

    def put(kind: str, label: str, half: float, *places: float) -> None:
        if (x := first_free(half, *places)) is not None:
            text(drawing, kind, (x, y + 4.2), label, "middle")

    if len(axis.numbered) > MOST_BOUNDARIES:
        middle = (axis.numbered[0].start + axis.numbered[-1].end) / 2
        put("phase", f"1 … {len(axis.numbered)}", width_of("1 … 10000") / 2, middle)
    else:
        for number, stretch in enumerate(axis.numbered, 1):
            places = (stretch.middle + shift for shift in SHIFTS)
            if (x := first_free(APART / 2, *places)) is not None:
                _number(drawing, stretch, number, (x, y), governing)
    times = [(x, label, SMALLER / 2 * width_of(label) + 1) for x, label in axis.times]
    for x, label, half in times[-1:]:
        put("tick", label, half, x, x + half)
    if axis.pause:
        put("phase", "t_p", APART / 2, axis.pause.middle, axis.pause.end + APART / 2, axis.pause.end + APART)
    for x, label, half in times[:-1]:
        put("tick", label, half, x)


def _number(drawing: Element, stretch: Stretch, number: int, at: Point, governing: Sequence[int]) -> None:
    """Draw the number of a stretch in a disc, with its name beside it if both fit."""
    state = " governing" if set(stretch.phases) & set(governing) else ""
    group = add(drawing, "g", f"mark{state}", data_phase=_of(stretch))
    needed = 2 * RADIUS + 4 + SMALLER * width_of(stretch.name)
    (middle, y), named = at, stretch.name and needed + 4 <= stretch.end - stretch.start
    x = middle - (needed / 2 - RADIUS if named else 0.0)
    add(group, "circle", "disc", cx=x, cy=y, r=RADIUS)
    text(group, "number", (x, y + 4.2), str(number), "middle")
    if named:
        text(group, "phase-name", (x + RADIUS + 4, y + 4.2), stretch.name)


def stretches(edges: Sequence[float], names: Sequence[str] = ()) -> list[Stretch]:
    """A stretch of one phase from each edge to the next."""
    return [Stretch(*ends, (k,), names[k] if names else "") for k, ends in enumerate(pairwise(edges))]

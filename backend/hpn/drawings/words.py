"""In which language and units a picture speaks, and the parts of a Plotly layout that all plots share."""

import re
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Any

from hpn.checks import telling_decimals
from hpn.units import SYMBOLS
from hpn.wording import N_, Quantity, Sentence

Figure = dict[str, Any]

STEPS = (1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0)
"""Axes widen by these factors where a value lies outside, so that a plot doesn't jump while somebody types."""

STANDING = N_("Computed between the two published limits; the handbook’s printed curve was not available.")
STANDING_SUPPLIED = N_("Along curve points that you supplied; the handbook’s printed curve was not available.")


def _as_it_is(value: float, _unit: str) -> float:
    return value


def _plain(value: float, _unit: str) -> str:
    return f"{value:.4g}"


@dataclass(frozen=True, slots=True)
class Words:
    """Language and units of whoever looks at a picture; without a reader English and the units of the wire."""

    translate: Callable[[str], str] = str
    show: Callable[[Quantity], str] = str
    number: Callable[[float, str], str] = _plain
    unit: Callable[[str], str] = SYMBOLS.__getitem__
    convert: Callable[[float, str], float] = _as_it_is
    separators: str = ".\N{NARROW NO-BREAK SPACE}"

    def say(self, sentence: Sentence) -> str:
        """A sentence as Plotly sets it: the handbook's symbols with their index below."""
        return _SYMBOL.sub(r"\1<sub>\2</sub>", sentence.render(self.translate, self.show))

    def axis(self, quantity: str, unit: str) -> str:
        """Title of an axis."""
        return self.say(
            Sentence(N_("{quantity} in {unit}"), {"quantity": quantity, "unit": self.unit(unit)}, ("quantity",))
        )

    def convert_all(self, values: Iterable[float], unit: str) -> list[float]:
        """Values in the reader's unit."""
        return [self.convert(value, unit) for value in values]


ENGLISH = Words()

_SYMBOL = re.compile(r"\b([A-Za-z])_([A-Za-z]+(?:\([a-z]+\))?)")


def layout(words: Words, x: str, y: str, *, title: str, note: str = "", revision: str = "") -> Figure:
    """Layout of a plot. `title` and `note` stand on what is saved as a picture, where the page is not around it."""
    axis = {
        "tickmode": "auto",
        "rangemode": "tozero",
        "zeroline": False,
        "showline": True,
        "linecolor": "var(--edge)",
        "gridcolor": "var(--line)",
        "ticks": "outside",
        "tickcolor": "var(--edge)",
        "separatethousands": True,
    }
    return {
        "xaxis": {**axis, "title": {"text": x, "standoff": 10}},
        "yaxis": {**axis, "title": {"text": y, "standoff": 12}, "automargin": True},
        "showlegend": False,
        "legend": {"orientation": "h", "x": 0, "y": -0.16, "xanchor": "left", "yanchor": "top"},
        "margin": {"l": 68, "r": 18, "t": 22, "b": 52},
        "paper_bgcolor": "rgba(0,0,0,0)",
        "plot_bgcolor": "rgba(0,0,0,0)",
        "font": {"color": "var(--ink)", "size": 13},
        "hoverlabel": {"bgcolor": "var(--card)", "bordercolor": "var(--edge)", "font": {"color": "var(--ink)"}},
        "hovermode": "closest",
        "separators": words.separators,
        "uirevision": revision,
        "meta": {"title": title, "note": note},
    }


def widened(limit: float, values: Iterable[float]) -> float:
    """The limit times the smallest step that holds all values; beyond the last step just what holds them."""
    largest = max(values, default=0.0)
    return next((limit * step for step in STEPS if largest <= limit * step), largest)


def share(used: float) -> Quantity:
    """A utilisation in percent, with as many digits as it takes to tell it from 100 %."""
    decimals = telling_decimals(100 * used, 100.0, 0)
    return Quantity(100 * used, "percent", 3 + decimals if used > 1 else max(3, 2 + decimals))


def numbers(places: list[int]) -> str:
    """Phase numbers from their places, three or more in a row as a range: `1–3`."""
    if len(places) > 2 and places[-1] - places[0] == len(places) - 1:
        return f"{places[0] + 1}–{places[-1] + 1}"
    shown = ", ".join(str(place + 1) for place in places[:6])
    return shown if len(places) <= 6 else shown + " …"

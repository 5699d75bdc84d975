"""Parts of a Plotly layout that all plots share."""

from typing import Any

from hpn.words.reader import Reader

Figure = dict[str, Any]

LETTER = 12.5
"""Size of all letters in pixels, the smallest of the page."""

_AXIS = {
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


def layout(reader: Reader, x: str, y: str, *, title: str, note: str = "", revision: str = "") -> Figure:
    """Layout of a plot. `title` and `note` appear on a saved picture, which has no page around it."""
    return {
        "xaxis": {**_AXIS, "title": {"text": x, "standoff": 10, "font": {"size": LETTER}}},
        "yaxis": {**_AXIS, "title": {"text": y, "standoff": 12, "font": {"size": LETTER}}, "automargin": True},
        "showlegend": False,
        "margin": {"l": 68, "r": 18, "t": 22, "b": 52},
        "paper_bgcolor": "rgba(0,0,0,0)",
        "plot_bgcolor": "rgba(0,0,0,0)",
        "font": {"color": "var(--ink)", "size": LETTER},
        "hoverlabel": {"bgcolor": "var(--card)", "bordercolor": "var(--edge)", "font": {"color": "var(--ink)"}},
        "hovermode": "closest",
        "separators": reader.decimal + reader.group,
        "uirevision": revision,
        "meta": {"title": title, "note": note},
    }


def points(kind: str, *, size: int, colour: str = "var(--ink)") -> Figure:
    """Trace of points as diamonds, without places and texts yet."""
    return {
        "type": "scatter",
        "cliponaxis": False,
        "marker": {
            "size": size,
            "color": colour,
            "symbol": "diamond",
            "line": {"color": "var(--card)", "width": 1},
        },
        "hoverinfo": "text",
        "meta": {"kind": kind},
    }

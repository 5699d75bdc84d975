"""HTML tables for notebooks: without style sheets, scripts or anything to load."""

from collections.abc import Iterable, Sequence
from html import escape

CELL = "text-align:left;vertical-align:top"
NUMBER = "text-align:right;vertical-align:top;font-variant-numeric:tabular-nums"


def table(caption: str, heads: Sequence[str], rows: Iterable[Sequence[object]]) -> str:
    """Table with its caption; None is a dash, and numbers are aligned right with six digits."""
    head = "".join(f'<th scope="col" style="{CELL}">{escape(name)}</th>' for name in heads)
    body = "".join(f"<tr>{''.join(map(_cell, row))}</tr>" for row in rows)
    title = f'<caption style="{CELL};caption-side:top">{escape(caption)}</caption>'
    return f"<table>{title}<thead><tr>{head}</tr></thead><tbody>{body}</tbody></table>"


def _cell(value: object) -> str:
    if isinstance(value, float | int) and not isinstance(value, bool):
        return f'<td style="{NUMBER}">{escape(figure(value))}</td>'
    return f'<td style="{CELL}">{escape("–" if value is None else str(value))}</td>'


def figure(value: float) -> str:
    """Number with six digits, large ones in full."""
    return f"{value:.6g}" if abs(value) < 1e6 or abs(value) >= 1e15 else f"{value:.0f}"

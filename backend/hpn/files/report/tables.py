"""Tables of the report: inputs, figures of cycle and gear, and the gear's published figures."""

from collections.abc import Iterable
from typing import Any

from hpn.account.account import Account
from hpn.account.lines import Line, LineTable, QuantityColumn, with_values
from hpn.words.reader import Reader
from hpn.words.symbols import formula, sentence
from hpn.words.wording import N_, Sentence

MOST_PHASES = 20
"""Most phases that are listed one by one; beyond, the report shows their range and sum."""


def lines(items: Iterable[Line], reader: Reader) -> list[dict[str, Any]]:
    """Lines with a value: label, symbol, text, and the source of a published figure."""
    return [_row(line, reader) for line in with_values(items)]


def _row(line: Line, reader: Reader) -> dict[str, Any]:
    row = {
        "code": line.code,
        "label": sentence(_label(line, reader)),
        "symbol": formula(line.named.symbol),
        "text": line.text(reader),
    }
    return row | {"where": line.where(reader)} if line.kind == "published" else row


def _label(line: Line, reader: Reader) -> str:
    return f"{line.label(reader)}, {reader.text(N_('lower bound'))}" if line.is_lower_bound else line.label(reader)


def derived(account: Account, reader: Reader) -> list[dict[str, Any]]:
    """Figures of the cycle and of the gear under it; entered values stand with the inputs."""
    return lines((line for line in (*account.cycle, *account.figures) if line.kind == "computed"), reader)


def phases(account: Account, reader: Reader) -> dict[str, Any]:
    """Duty cycle: each phase, or for a long cycle the least and largest values and the sum."""
    table = account.phases
    assert table is not None
    if len(table) <= MOST_PHASES:
        return _table(table, reader)
    text = N_("{count} phases, summarised here; each is listed on the last pages.")
    blank = [""] * (len(table.labels) - 1)
    return _table(table, reader, text) | {"rows": [[label, *blank, *row] for label, row in _summary(table, reader)]}


def motion(account: Account, reader: Reader) -> dict[str, Any] | None:
    """Mechanism and moves as they were given; of many moves only their number. None where phases were given."""
    table = account.moves
    if table is None:
        return None
    moves = _table(table, reader, N_("{count} moves; each is listed on the last pages."))
    return {"mechanism": lines(account.mechanism, reader), "moves": moves | {"words": 2}}


def _table(table: LineTable, reader: Reader, beyond: str = "") -> dict[str, Any]:
    """Headings and cells of a table, the labels of its rows in front; a long table has a note in place of the rows."""
    is_long = len(table) > MOST_PHASES
    cells = [] if is_long else [*table.labels.values(), *(column.numbers(reader) for column in table.columns)]
    return {
        "header": [*([[], reader.text(head)] for head in table.labels), *(_head(c, reader) for c in table.columns)],
        "rows": [[*row] for row in zip(*cells, strict=True)],
        "note": reader.sentence(Sentence(beyond, {"count": reader.exact(len(table))})) if is_long else "",
        "words": len(table.labels),
    }


def _head(column: QuantityColumn, reader: Reader) -> list[Any]:
    line = column.head
    return [formula(line.named.symbol), reader.unit(line.unit) if line.named.symbol else line.label(reader)]


def _summary(table: LineTable, reader: Reader) -> list[tuple[str, list[str]]]:
    """Least and largest value of each column, and the sum of the durations."""
    rows: list[tuple[str, list[str]]] = []
    numbers = [(c.head, [value for value in c.values if isinstance(value, float | int)]) for c in table.columns]
    for title, of in ((N_("least"), min), (N_("largest"), max)):
        rows.append((reader.text(title), [reader.figure(of(values), head.unit) for head, values in numbers]))
    sums = [reader.figure(sum(values)) if head.code == "phase.duration_s" else "" for head, values in numbers]
    return [*rows, (reader.text(N_("sum")), sums)]

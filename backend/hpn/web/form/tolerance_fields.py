"""Fields of the form for tolerances: one beside each value, and one for each column of the duty table.

A row's fields are in the row and move with it. A number alone is percent, `0.5 Nm` an amount, `+5 −2` unequal on both
sides. A link writes tolerances as `tol`: `T:10p`, `T.2:0.5`, `tp:2p/5p`.
"""

import re
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass

from hpn.links.row_symbols import MOVE_BY_NAME, PHASE_BY_NAME
from hpn.links.rows import ROWS_IN_TABLE, FormTable
from hpn.links.symbols import BY_NAME
from hpn.links.tolerances import LONGEST, WRITTEN, Side, Sides, sides_of
from hpn.tables.cells import DASHES
from hpn.tables.numbers import Notation, read_decimal
from hpn.words.patterns import Pattern
from hpn.words.reader import MINUS, Reader

COLUMN, ROW = "tol_", "tols_"
"""Prefixes of field names: for a single input or a whole column, and for the cells of each row."""

EXACT = "exact"
"""Field that switches tolerances off."""

OF_ROW: Mapping[str, str] = {
    f"{ROW}{name}": name
    for name, symbol in (PHASE_BY_NAME | MOVE_BY_NAME).items()
    if symbol.kind == "number" and not symbol.choices
}
"""Fields of rows, and the symbols of their inputs, in the order of the columns."""

OF_COLUMN: Mapping[str, str] = {
    f"{COLUMN}{name}": name
    for name, symbol in (PHASE_BY_NAME | BY_NAME).items()
    if symbol.kind == "number" and not symbol.many and not symbol.choices
}
"""Fields of single inputs and of columns, and the symbols of their inputs."""

INPUT_OF: Mapping[str, str] = {**OF_COLUMN, **OF_ROW}

TOLERANCE_INPUTS = (
    "u",
    "uw",
    "Lh",
    "Lb",
    "bl",
    "K3",
    "m",
    "L",
    "fn",
    "pe",
    "pem",
    "pr",
    "Jr",
    "nm",
    "Tm",
    "Tmn",
    "nmr",
    "Tst",
    "mmo",
)
"""Requirements on the gear and data of the motor: they get a field only if they have a tolerance already."""

OFFERED = frozenset(name for name in BY_NAME if name not in TOLERANCE_INPUTS and f"{COLUMN}{name}" in OF_COLUMN)
"""Inputs that always have a field for their tolerance."""

_LONGEST = 80
_PLUS_MINUS = Pattern(r"(?:\+/-|\+-|±)\s*", _LONGEST)
_SECOND_SIGN = Pattern(r"(?<=[^eE\s/;])[\s/;]*([+-])", _LONGEST)
_AMOUNT = Pattern(r"(.*?)\s*abs\.?", _LONGEST)
_DEGREES = Pattern(r"(.*?)\s*(K|°\s?C|°\s?F)", _LONGEST)
ABSOLUTE, KELVIN = "abs.", "K"
"""Endings of an amount for a pure number, which would otherwise be percent, and for a temperature."""


def input_of(name: str) -> str:
    """Symbol of the input that a field of the form belongs to, be it the input's own or that of its tolerance."""
    return INPUT_OF.get(name, name)


def symbol_in(text: str) -> str:
    """Symbol of the input of a link's tolerance."""
    return re.split("[.:]", text.strip())[0]


# --- From typed texts to the wire -------------------------------------------------------------------------------------


def typed(name: str, text: str, notation: Notation, units: Mapping[str, str]) -> Sides:
    """Tolerance typed in a field, for the wire; in a link's query the field holds the notation of links."""
    if notation.marker is None:
        return sides_of(text)
    unit = units.get(input_of(name), "")
    plain = text.strip().translate(DASHES)
    if alike := _PLUS_MINUS.match(plain):
        return Sides([_side(plain[alike.end() :], unit, notation)])
    if plain[:1] not in ("+", "-") or len(plain) > _LONGEST:
        return Sides([_side(plain, unit, notation)] if plain else [])
    second = _SECOND_SIGN.search(plain[1:])
    parts = [plain] if second is None else [plain[: second.start() + 1], plain[second.start(1) + 1 :]]
    sides = {part[0]: _side(part[1:], unit, notation) for part in parts}
    if len(sides) < len(parts):
        return Sides([Side(f"{plain}?", is_percent=False)])
    return Sides([sides.get(sign, Side("0", is_percent=True)) for sign in "-+"])


def _side(text: str, unit: str, notation: Notation) -> Side:
    """One side of a tolerance; percent if no unit is typed."""
    text = text.strip()
    bare = text.removesuffix("%").rstrip()
    if bare != text or text.startswith("=") or read_decimal(text, notation.decimal) is not None:
        return Side(notation.entry(bare, ""), is_percent=True)
    if not unit:
        amount = _AMOUNT.fullmatch(text)
        return Side(notation.entry(amount[1] if amount else text, ""), is_percent=amount is None)
    if unit == "degC" and (degrees := _DEGREES.fullmatch(text)):
        number = notation.entry(degrees[1], "")
        plain = read_decimal(number, ".") if degrees[2].endswith("F") else None
        return Side(number if plain is None else repr(float(plain) / 1.8), is_percent=False)
    return Side(notation.entry(text, unit), is_percent=False)


# --- From the wire to fields ------------------------------------------------------------------------------------------


def entries_of(name: str, text: str, units: Mapping[str, str]) -> list[tuple[str, str]]:
    """Numbers of a tolerance with their units, for `numbers.to_fields`."""
    unit = units.get(input_of(name), "")
    return [(side.number, "" if side.is_percent or unit == "degC" else unit) for side in sides_of(text).parts]


def field_of(name: str, text: str, numbers: Iterator[str], units: Mapping[str, str], reader: Reader) -> str:
    """Text of a tolerance's field; takes its numbers, in the reader's notation, from `numbers`."""
    unit = units.get(input_of(name), "")
    amount = ABSOLUTE if not unit else KELVIN if unit == "degC" else reader.unit(unit)
    parts = [
        f"{number} {'%' if side.is_percent else amount}" if read_decimal(number, reader.decimal) else number
        for side, number in ((side, next(numbers)) for side in sides_of(text).parts)
    ]
    return f"+{parts[1]} {MINUS}{parts[0]}" if len(parts) == 2 else "".join(parts)


# --- From links to fields ---------------------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class ToleranceField:
    """Tolerance with its field: name, and index of its row, if any; `row` counts filled rows only."""

    name: str
    index: int | None
    symbol: str
    row: int | None
    sides: Sides


def place(
    texts: Sequence[str],
    table: FormTable,
    inputs: Collection[str],
    scalars: dict[str, str],
    single: dict[str, list[str]],
) -> list[str]:
    """Put tolerances of a link into the fields of the form's inputs; return those that have no field."""
    remaining = []
    for text in texts:
        match = WRITTEN.fullmatch(text.strip()) if len(text) <= LONGEST else None
        symbol, row = (match[1], match[2]) if match else ("", None)
        sides = sides_of(text.strip().partition(":")[2])
        name = f"{COLUMN}{symbol}" if row is None else f"{ROW}{symbol}"
        if row is None and name in OF_COLUMN and symbol in inputs and not single.get(name):
            single[name], scalars[name] = [sides], sides
        elif not (row is not None and name in OF_ROW and _in_row(table, int(row) - 1, name, sides)):
            remaining.append(text)
    return remaining


def _in_row(table: FormTable, k: int, name: str, sides: Sides) -> bool:
    """Put a tolerance into its row; return False if the row has no field for it, or the field is filled."""
    fits = k < len(table.rows) <= ROWS_IN_TABLE and OF_ROW[name] in table.names
    if not fits or table.rows[k].get(name, "").strip():
        return False
    table.widen(name)
    table.rows[k][name] = sides
    return True


def fields(table: FormTable, scalars: Mapping[str, str]) -> Iterator[ToleranceField]:
    """Yield the tolerances of all fields; only filled rows count, as only they become phases or moves."""
    for name, text in scalars.items():
        if name in OF_COLUMN:
            yield ToleranceField(name, None, OF_COLUMN[name], None, sides_of(text))
    rows = [k for k, row in enumerate(table.rows) if any(text.strip() for text in row.values())]
    for row, k in enumerate(rows):
        for name, symbol in OF_ROW.items():
            if (text := table.rows[k].get(name, "")).strip():
                yield ToleranceField(name, k, symbol, row, sides_of(text))

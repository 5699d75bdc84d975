"""Fields of the form for tolerances: one beside each value, and one for a whole column of the duty table.

A field of a row stands in its row, so that it goes where the row goes. A number alone is percent, `0.5 Nm` an amount,
and `+5 −2` lies unequally. A link has the same as `tol`: `T:10p`, `T.2:0.5`, `tp:2p/5p`.
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
"""Begin of the name of a field for a whole input or all rows, and of one that each row has."""

EXACT = "exact"
"""Field that says that tolerances don't count for the moment."""

OF_ROW: Mapping[str, str] = {
    f"{ROW}{name}": name
    for name, symbol in (PHASE_BY_NAME | MOVE_BY_NAME).items()
    if symbol.kind == "number" and not symbol.choices
}
"""Fields of rows and the symbols of their inputs, in the order of the columns."""

OF_COLUMN: Mapping[str, str] = {
    f"{COLUMN}{name}": name
    for name, symbol in (PHASE_BY_NAME | BY_NAME).items()
    if symbol.kind == "number" and not symbol.many and not symbol.choices
}
"""Fields of single inputs and of columns, and the symbols of their inputs."""

INPUT_OF: Mapping[str, str] = {**OF_COLUMN, **OF_ROW}

ASKED = ("u", "uw", "Lh", "Lb", "bl", "K3", "m", "L", "fn", "pe", "pem", "pr", "Jr", "nm", "Tm", "Tmn", "nmr")
"""Inputs that say what is asked of a gear or known of a motor: they get a field where they have a tolerance already."""

OFFERED = frozenset(name for name in BY_NAME if name not in ASKED and f"{COLUMN}{name}" in OF_COLUMN)
"""Inputs with a field beside them."""

_LONGEST = 80
_PLUS_MINUS = Pattern(r"(?:\+/-|\+-|±)\s*", _LONGEST)
_SECOND_SIGN = Pattern(r"(?<=[^eE\s/;])[\s/;]*([+-])", _LONGEST)
_AMOUNT = Pattern(r"(.*?)\s*abs\.?", _LONGEST)
_DEGREES = Pattern(r"(.*?)\s*(K|°\s?C|°\s?F)", _LONGEST)
ABSOLUTE, KELVIN = "abs.", "K"
"""Endings of an amount of a pure number, which would else be percent, and of a temperature."""


def input_of(name: str) -> str:
    """Symbol of the input whose field or tolerance a name of the form is."""
    return INPUT_OF.get(name, name)


def symbol_in(text: str) -> str:
    """Symbol of the input that a tolerance of a link is for."""
    return re.split("[.:]", text.strip())[0]


# --- What is typed ----------------------------------------------------------------------------------------------------


def typed(name: str, text: str, notation: Notation, units: Mapping[str, str]) -> Sides:
    """Tolerance as it was typed in a field, for the wire; a link's own field has it as links do."""
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
    """One side; percent without a unit of its own."""
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


# --- What a field shows -----------------------------------------------------------------------------------------------


def entries_of(name: str, text: str, units: Mapping[str, str]) -> list[tuple[str, str]]:
    """Numbers of a tolerance with their units, as fields of numbers take them."""
    unit = units.get(input_of(name), "")
    return [(side.number, "" if side.is_percent or unit == "degC" else unit) for side in sides_of(text).parts]


def field_of(name: str, text: str, numbers: Iterator[str], units: Mapping[str, str], reader: Reader) -> str:
    """Text for a field, with the next numbers as the reader writes them."""
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
    """A tolerance with its field: name, and the row for one of a row; `row` counts the rows that are filled."""

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
    """Set tolerances of a link into their fields, of the inputs that the form has; those without one are returned."""
    left = []
    for text in texts:
        match = WRITTEN.fullmatch(text.strip()) if len(text) <= LONGEST else None
        symbol, row = (match[1], match[2]) if match else ("", None)
        sides = sides_of(text.strip().partition(":")[2])
        name = f"{COLUMN}{symbol}" if row is None else f"{ROW}{symbol}"
        if row is None and name in OF_COLUMN and symbol in inputs and not single.get(name):
            single[name], scalars[name] = [sides], sides
        elif not (row is not None and name in OF_ROW and _in_row(table, int(row) - 1, name, sides)):
            left.append(text)
    return left


def _in_row(table: FormTable, k: int, name: str, sides: Sides) -> bool:
    """Set a tolerance into its row; False where that has no field for it, or it is taken."""
    fits = k < len(table.rows) <= ROWS_IN_TABLE and OF_ROW[name] in table.names
    if not fits or table.rows[k].get(name, "").strip():
        return False
    table.widen(name)
    table.rows[k][name] = sides
    return True


def fields(table: FormTable, scalars: Mapping[str, str]) -> Iterator[ToleranceField]:
    """Tolerances of all fields, those of rows by the rows that become phases or moves."""
    for name, text in scalars.items():
        if name in OF_COLUMN:
            yield ToleranceField(name, None, OF_COLUMN[name], None, sides_of(text))
    rows = [k for k, row in enumerate(table.rows) if any(text.strip() for text in row.values())]
    for row, k in enumerate(rows):
        for name, symbol in OF_ROW.items():
            if (text := table.rows[k].get(name, "")).strip():
                yield ToleranceField(name, k, symbol, row, sides_of(text))

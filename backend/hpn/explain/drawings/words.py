"""Words of the pictures: titles of axes, symbols with their subscripts, shares, and the numbers of phases."""

from collections.abc import Iterable, Sequence

from hpn.words.reader import Reader
from hpn.words.symbols import sentence as parts_of
from hpn.words.wording import N_, Quantity, Sentence, telling_decimals


def text_of(sentence: Sentence, reader: Reader) -> str:
    """A sentence for Plotly: the handbook's symbols with their subscripts."""
    return indexed(reader.sentence(sentence))


def indexed(text: str) -> str:
    """A text for Plotly, its symbols with subscripts."""
    parts = parts_of(text)
    return "".join(part if isinstance(part, str) else f"{part[0]}<sub>{part[1]}</sub>" for part in parts)


def axis_title(quantity: str, unit: str, reader: Reader) -> str:
    """Title of an axis: a quantity (an English msgid) and the reader's unit, if any."""
    if not unit:
        return reader.text(quantity)
    values = {"quantity": quantity, "unit": reader.unit(unit)}
    return text_of(Sentence(N_("{quantity} in {unit}"), values, ("quantity",)), reader)


def numbers_in(values: Iterable[float], unit: str, reader: Reader) -> list[float]:
    """Values in the reader's unit."""
    return list(map(reader.measure(unit).number, values))


def share(used: float, allowed: float = 1.0) -> Quantity:
    """A utilisation in percent, with enough digits to differ from the allowed one."""
    decimals = telling_decimals(100 * used, 100 * allowed, 0)
    return Quantity(100 * used, "percent", 3 + decimals if used > 1 else max(3, 2 + decimals))


def coefficient_name(load_coefficient: float, reader: Reader) -> str:
    """Name of the curve for a load coefficient."""
    return f"f_w {reader.exact(load_coefficient)}"


def phase_numbers(places: Sequence[int]) -> str:
    """Phase numbers from their places, three or more consecutive ones as a range: `1–3`."""
    if len(places) > 2 and places[-1] - places[0] == len(places) - 1:
        return f"{places[0] + 1}–{places[-1] + 1}"
    numbers = ", ".join(str(place + 1) for place in places[:6])
    return numbers if len(places) <= 6 else numbers + " …"


def disc_label(places: Sequence[int]) -> str:
    """Phase numbers for a disc: of more than three numbers that form no range, the first one only."""
    numbers = phase_numbers(places)
    return numbers if len(places) <= 3 or "–" in numbers else f"{places[0] + 1} …"

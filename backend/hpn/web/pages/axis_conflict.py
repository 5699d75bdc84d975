"""Axis that two people have changed: as opened, as stored now, and as typed by one of them."""

from dataclasses import dataclass
from urllib.parse import urlencode

from hpn.catalogue import Catalogue
from hpn.links.row_symbols import MOVE_BY_NAME, PHASE_BY_NAME
from hpn.links.rows import TOLERANCE
from hpn.links.symbols import BY_NAME, units_of
from hpn.links.symbols import LABELS as NAMES
from hpn.web.door.visit import current
from hpn.web.form.own_part import grouped, written
from hpn.web.form.query import CYCLE_NAMES, Pairs
from hpn.web.pages.axis_view import OPENED, VERSION, WITHOUT, AxisView, stored_pairs
from hpn.words.wording import N_

Cell = tuple[str, int]
"""Name of an input, and its row or its index among repeated inputs."""

_SPECIAL = {WITHOUT: N_("Without the machine’s value"), TOLERANCE: N_("Tolerance")}


@dataclass(frozen=True, slots=True)
class InputConflict:
    """Input with its three texts, blank if not given; `is_open` if both editors have changed it."""

    name: str
    row: int | None
    unit: str
    before: str
    theirs: str
    yours: str
    is_open: bool


@dataclass(frozen=True, slots=True)
class Conflict:
    """Differences, and links to keep one's own, to overwrite, or to join both; not to join if `opened` is unknown."""

    lines: tuple[InputConflict, ...]
    known: bool
    yours: str
    over: str
    together: str


def conflict_of(view: AxisView, catalogue: Catalogue) -> Conflict:
    """Conflict of a typed axis with the stored one."""
    theirs = stored_pairs(view.axis, catalogue)
    since = [(VERSION, str(view.axis.version)), (OPENED, urlencode(theirs))]
    together = () if view.opened is None else _joined(view.opened, theirs, view.typed)
    return Conflict(
        lines=_lines(view.opened or (), theirs, view.typed),
        known=view.opened is not None,
        yours=f"{view.place}?{written([*view.typed, (VERSION, str(view.version)), (OPENED, view.opened_text)])}",
        over=written([*view.typed, *since]),
        together=f"{view.place}?{written([*together, *since])}" if together else "",
    )


def _cells(pairs: Pairs) -> dict[Cell, str]:
    counts: dict[str, int] = {}
    texts: dict[Cell, str] = {}
    for name, text in pairs:
        texts[name, counts.get(name, 0)] = text
        counts[name] = counts.get(name, 0) + 1
    return texts


def _lines(opened: Pairs, theirs: Pairs, yours: Pairs) -> tuple[InputConflict, ...]:
    mechanism = next((text for name, text in (*yours, *theirs) if name == "mech"), "")
    units = units_of(mechanism)
    sides = [_cells(side) for side in (opened, theirs, yours)]
    cells = dict.fromkeys(cell for side in (sides[2], sides[1], sides[0]) for cell in side)
    lines = []
    for name, k in cells:
        texts = [side.get((name, k), "") for side in sides]
        if len(set(texts)) == 1:
            continue
        of_row = name in PHASE_BY_NAME or name in MOVE_BY_NAME
        before, there, here = (_text_of(name, text, units.get(name, "")) for text in texts)
        is_open = bool(opened) and texts[0] not in texts[1:] and texts[1] != texts[2]
        label = _SPECIAL.get(name) or NAMES.get(name, name)
        lines.append(InputConflict(label, k + 1 if of_row else None, units.get(name, ""), before, there, here, is_open))
    return tuple(lines)


def _text_of(name: str, text: str, unit: str) -> str:
    reader = current()
    if name == WITHOUT and text in NAMES:
        return reader.text(NAMES[text])
    symbol = BY_NAME.get(name)
    if symbol and text in symbol.choices:
        return reader.text(symbol.choices[text])
    measure = reader.measure(unit)
    try:
        return (text if measure.same else measure.written(float(text), 6)).replace(".", reader.decimal if unit else ".")
    except ValueError:
        return text


def _joined(opened: Pairs, theirs: Pairs, yours: Pairs) -> Pairs:
    """Their pairs with your changes; rows of a cycle are joined one by one if all three have the same number."""
    groups = [grouped(side) for side in (opened, theirs, yours)]
    cycle = {name for group in groups for name in group if name in CYCLE_NAMES}
    rows = [{name: len(group.get(name, ())) for name in cycle} for group in groups]
    pairs: list[tuple[str, str]] = []
    whole = rows[0] == rows[1] == rows[2]
    mine = any(groups[0].get(name) != groups[2].get(name) for name in cycle)
    for name in dict.fromkeys(name for group in (groups[2], groups[1]) for name in group):
        before, there, here = (group.get(name, []) for group in groups)
        if name in cycle and not whole:
            texts = here if mine else there
        elif len(before) == len(there) == len(here):
            texts = [own if was != own else other for was, other, own in zip(before, there, here, strict=True)]
        else:
            texts = here if before != here else there
        pairs += [(name, text) for text in texts]
    return pairs

"""Tables of axes in lines of JSON."""

import re
from collections.abc import Iterable, Iterator, Sequence
from contextlib import suppress
from functools import cached_property
from operator import attrgetter
from typing import Annotated, Any

import msgspec
import pyarrow as pa

from hpn.application.faults import NOT_A_NUMBER
from hpn.application.shaft_centre import NO_CENTRE
from hpn.application.unique import RepeatedNameError, require_unique
from hpn.fleet.columns import AXIS, COLUMNS, is_list
from hpn.fleet.lines import BOM, MOST_BROKEN, NO_FLAG, LinesTable, cut, no_list
from hpn.fleet.tables import Batch, Fault
from hpn.words.wording import N_

NO_TEXT = N_("must be text")
RIGHT = {"string": (NO_TEXT, str), "boolean": (NO_FLAG, bool)}
AXIS_IN_LINE = re.compile(rb'"axis"\s*:\s*("(?:[^"\\]|\\.)*"|-?[0-9]+(?=[\s,}]))')
NAME_IN_LINE = re.compile(rb'"([^"\\]*)"\s*:')
Integer = Annotated[int, msgspec.Meta(ge=-(2**63), le=2**63 - 1)]
"""Integers that Arrow holds in 64 bits."""

READ_AS: dict[tuple[bool, bool], Any] = {
    (False, False): float,
    (False, True): list[float | None],
    (True, False): str,
    (True, True): list[str | None],
}
"""Types that msgspec reads cells as, by columns of texts or numbers, of lists or not."""

BY_SIZE = float | dict[str, float | None]
"""Type of a number that may be given by size."""


class NdjsonTable(LinesTable):
    """A JSON object in each line, with the names of the columns as keys."""

    @cached_property
    def _first(self) -> dict[str, Any]:
        """The first row; empty where there is none."""
        for line in self.head.removeprefix(BOM).split(b"\n"):
            if line.strip():
                try:
                    return _object(line)
                except (ValueError, RecursionError) as error:
                    raise self.unreadable(error, "the first line ") from None
        return {}

    @property
    def all_names(self) -> Sequence[str]:
        """Every column that a row may have: they need not stand in the first one."""
        phases = COLUMNS.phases if "torque_Nm" in self._first or not self._first else ()
        others = COLUMNS.others if self.is_in_list_form or not phases else ()
        return list(dict.fromkeys((AXIS, *phases, *others, *self._first)))

    @property
    def first_byte(self) -> int:
        return len(BOM) if self.head.startswith(BOM) else 0

    @cached_property
    def is_in_list_form(self) -> bool:
        return isinstance(self._first.get("torque_Nm"), list)

    @property
    def axis_type(self) -> pa.DataType:
        return pa.int64() if isinstance(self._first_axis, int) else pa.string()

    @cached_property
    def _first_axis(self) -> str | int:
        """The first axis that may be one: a bad one decides nothing for the others."""
        for line in self.head.removeprefix(BOM).split(b"\n"):
            with suppress(ValueError, RecursionError):
                axis = _object(line).get(AXIS) if line.strip() else None
                if isinstance(axis, str | int) and not isinstance(axis, bool):
                    return axis
        return ""

    @cached_property
    def _kinds(self) -> dict[str, Any]:
        """Types that msgspec reads the cells of each column as."""
        kinds: dict[str, Any] = {AXIS: Integer if pa.types.is_integer(self.axis_type) else str}
        for name in self.names:
            if name != AXIS:
                kind, is_listed = COLUMNS.all[name].kind, is_list(self.type_of(name))
                kinds[name] = bool if kind == "boolean" else READ_AS[kind == "string", is_listed]
                kinds[name] = BY_SIZE if COLUMNS.all[name].by_size else kinds[name]
        return kinds | dict.fromkeys(self.ignored, Any)

    @cached_property
    def _fields(self) -> dict[str, str]:
        """Names of the columns by those of the fields of a row, which are shorter and always names in Python."""
        return {f"c{place}": name for place, name in enumerate(self._kinds)}

    @cached_property
    def _row_type(self) -> Any:
        fields = [(field, self._kinds[name] | None, None) for field, name in self._fields.items()]
        return msgspec.defstruct("Row", fields, rename=self._fields.get, forbid_unknown_fields=True)

    def _batches(self) -> Iterator[Batch]:
        for block in self.blocks():
            lines = [line for line in block.split(b"\n") if line.strip()]
            broken = list[bytes]()
            for start in range(0, len(lines), self.batch_rows):
                yield self._batch(lines[start : start + self.batch_rows], broken)
                if len(broken) > MOST_BROKEN:
                    raise self.too_many_broken(broken[0].decode(errors="replace"))

    def _batch(self, lines: Sequence[bytes], broken: list[bytes]) -> Batch:
        """Rows of lines; those that are no JSON object are added to the broken ones."""
        decode = msgspec.json.Decoder(self._row_type).decode
        rows, faults = [], []
        for place, line in enumerate(lines):
            try:
                row = decode(line)
                if _may_repeat_a_name(line):
                    require_unique(line)
                rows.append(row)
            except (ValueError, RecursionError) as error:
                cells, wrong = self._one_by_one(line, error, broken)
                rows.append(msgspec.convert(cells, self._row_type) if cells else self._row_type())
                faults += [Fault(place, *fault) for fault in wrong]
        columns = {
            name: pa.array(_cells(map(attrgetter(field), rows), name), self.type_of(name))
            for field, name in self._fields.items()
            if name not in self.ignored
        }
        return Batch(pa.table(columns), faults)

    def _one_by_one(
        self, line: bytes, error: Exception, broken: list[bytes]
    ) -> tuple[dict[str, Any], list[tuple[str, str]]]:
        """The cells of a line that can be read, and what is wrong with the others."""
        try:
            given, wrong = _object(line), _repeated(line)
        except (ValueError, RecursionError):
            broken.append(line)
            cells = _axis_alone(line, self._kinds[AXIS])
            return cells, [(AXIS, f"the line is not a JSON object: {error}, in {cut(line.decode(errors='replace'))}")]
        cells = {}
        for name, value in given.items():
            if name not in self._kinds:
                wrong.append((name, N_("is not a column")))
            elif _is(value, self._kinds[name]):
                cells[name] = value
            else:
                wrong.append((name, self._right(name, value)))
        return cells, wrong

    def _right(self, name: str, value: Any) -> str:
        """Reason that a value is wrong, with the right kind."""
        if name == AXIS:
            expected = "an integer" if pa.types.is_integer(self.axis_type) else "text"
            return f"must be {expected}, as the first valid axis is, not {_shown(value)}"
        column = COLUMNS.all[name]
        right, kind = (NO_CENTRE, BY_SIZE) if column.by_size else RIGHT.get(column.kind, (NOT_A_NUMBER, float))
        if not is_list(self.type_of(name)):
            return f"{right}, not {_shown(value)}"
        if not isinstance(value, list):
            return no_list(column)
        place, item = next((place, item) for place, item in enumerate(value, start=1) if not _is(item, kind))
        return f"{'phase' if name in COLUMNS.phases else 'item'} {place}: {right}, not {_shown(item)}"


def _cells(values: Iterable[Any], name: str) -> list[Any]:
    """Values of a column as they stand in a table: of numbers that may be given by size the JSON."""
    if name == AXIS or not COLUMNS.all[name].by_size:
        return list(values)
    return [None if value is None else msgspec.json.encode(value).decode() for value in values]


def _may_repeat_a_name(line: bytes) -> bool:
    """True for a row that may have a name more than once: always where it has, seldom where not."""
    names = NAME_IN_LINE.findall(line)
    return len(set(names)) < len(names) or b"\\" in line


def _repeated(line: bytes) -> list[tuple[str, str]]:
    """Fault of a row that has a name more than once."""
    try:
        require_unique(line)
    except RepeatedNameError as repeated:
        return [(repeated.name, N_("is there more than once"))]
    return []


def _object(line: bytes) -> dict[str, Any]:
    """A line as a row; an axis that is a whole float is an integer."""
    row: dict[str, Any] = msgspec.json.decode(line, type=dict[str, Any])
    if isinstance(axis := row.get(AXIS), float) and axis.is_integer():
        row[AXIS] = int(axis)
    return row


def _shown(value: Any) -> str:
    """A value as it stands in JSON, in as many characters as have room in a reason."""
    return cut(msgspec.json.encode(value).decode(errors="replace"))


def _is(value: Any, kind: Any) -> bool:
    try:
        msgspec.convert(value, kind | None)
    except msgspec.ValidationError:
        return False
    return True


def _axis_alone(line: bytes, kind: Any) -> dict[str, Any]:
    """Axis of a line that is cut or broken, where it can be read."""
    found = AXIS_IN_LINE.search(line)
    if found is None:
        return {}
    try:
        axis = msgspec.json.decode(found[1])
    except ValueError:
        axis = None
    return {AXIS: axis} if _is(axis, kind) else {}

"""Tables of axes in memory: `hpn.size`, for pandas, polars and Arrow."""

import os
import sys
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, Literal, Protocol, TypeVar, overload

from hpn.installed import require
from hpn.python.faults import ApplicationError, with_application_errors
from hpn.python.gears import Gears

if TYPE_CHECKING:
    import pyarrow as pa

Give = Literal["answers", "candidates", "rejected"]
"""Kind of table: a row for each axis, for each of its candidates, or for each fault."""


class ArrowStream(Protocol):
    """Table of any library with the Arrow PyCapsule interface."""

    def __arrow_c_stream__(self, requested_schema: object | None = None) -> object: ...


Frame = TypeVar("Frame", bound=ArrowStream)
Columns = Mapping[str, Sequence[Any]]


@overload
def size(
    frame: Frame,
    *,
    give: Give = "answers",
    ignore: Sequence[str] = (),
    catalogue: Gears | None = None,
    workers: int | None = None,
) -> Frame: ...


@overload
def size(
    frame: Columns,
    *,
    give: Give = "answers",
    ignore: Sequence[str] = (),
    catalogue: Gears | None = None,
    workers: int | None = None,
) -> dict[str, list[Any]]: ...


def size(
    frame: Any,
    *,
    give: Give = "answers",
    ignore: Sequence[str] = (),
    catalogue: Gears | None = None,
    workers: int | None = None,
) -> Any:
    """Gears for the axes of a table, in input order: a frame of pandas or polars, a table of Arrow, a dict of columns.

        answers = hpn.size(frame)   # as hpn fleet: columns axis, selected, utilisation, … and error

    `frame` is in the list or the long form of `hpn fleet`. The answer is of the same library; for other libraries with
    the Arrow PyCapsule interface it is a table of pyarrow. `give` asks for every candidate, or for the faults of axes
    without an answer; `ignore` names columns to leave out. `workers` is the number of threads, by default one per core.
    Raises `hpn.ApplicationError` for unusable columns, ExtraMissingError without the extra `fleet`.
    """
    require("fleet")
    import pyarrow as pa

    from hpn.fleet.opened import axes_in_memory
    from hpn.fleet.run import size_table, threads

    if give not in ("answers", "candidates", "rejected"):
        raise ApplicationError(f"give: must be answers, candidates or rejected, not {give!r}")
    known = Gears.of() if catalogue is None else catalogue
    try:
        table = pa.table(frame)
    except (pa.ArrowException, TypeError, ValueError) as error:
        reason = "; ".join(map(str, error.args))
        raise ApplicationError(f"a {type(frame).__name__} can’t be read as a table: {reason}") from None
    engine = threads(workers or len(os.sched_getaffinity(0)))
    with with_application_errors():
        return _like(frame, size_table(axes_in_memory(table, ignore), known.catalogue, give, engine))


def _like(frame: Any, answers: "pa.Table") -> Any:
    """Answers as a table of the frame's library."""
    if isinstance(frame, Mapping):
        return answers.to_pydict()
    library = type(frame).__module__.partition(".")[0]
    if library == "pandas":
        return _in_pandas(answers)
    return sys.modules["polars"].from_arrow(answers) if library == "polars" else answers


def _in_pandas(answers: "pa.Table") -> Any:
    """Answers in pandas; whole numbers with gaps stay whole."""
    import pyarrow as pa

    whole = sys.modules["pandas"].Int64Dtype()
    gaps = [field.type for field in answers.schema if field.type == pa.int64() and answers[field.name].null_count]
    return answers.to_pandas(types_mapper={each: whole for each in gaps}.get)

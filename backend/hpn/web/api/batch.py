"""Batches: one result line per application, whether they come as one JSON object or as a stream of lines."""

from collections.abc import Callable, Sequence
from typing import Any

import orjson
from pydantic import ValidationError
from pydantic_core import from_json

from hpn.application import BatchItem, InputError
from hpn.catalogue import Catalogue
from hpn.fleet import select_fleet
from hpn.web.api.streaming import Line
from hpn.web.door.metrics import Metrics
from hpn.web.door.problems import Problem
from hpn.web.form.write import to_link


def batch_items(body: bytes, maximum: int) -> list[Any]:
    """Items of a JSON batch, not yet validated; Problem 400, 413 or 422 for what is none."""
    try:
        batch = _parsed(body)
    except ValueError as error:
        raise Problem(400, f"the body is not JSON: {error}") from None
    if not isinstance(batch, dict) or not isinstance(batch.get("applications"), list):
        raise Problem(422, 'the body must be {"applications": [ … ]}', [(("applications",), "must be a list")])
    unknown = [((name,), "is not a field of this object") for name in batch if name != "applications"]
    if unknown:
        raise Problem(422, 'the body must be {"applications": [ … ]} alone', unknown)
    items: list[Any] = batch["applications"]
    if len(items) > maximum:
        raise Problem(
            413,
            f"at most {maximum} applications at once",
            [(("applications",), f"has {len(items)} items, at most {maximum}")],
        )
    return items


def _parsed(text: bytes) -> Any:
    """Value of JSON as pydantic reads it: a number that is none leads to an error of its field, not of the whole."""
    return from_json(text)


def batch_lines(items: Sequence[Any], catalogue: Catalogue) -> list[dict[str, Any]]:
    """Result lines of batch items, in their order; each item is validated on its own.

    An item that is a Problem already becomes its line.
    """
    lines: list[dict[str, Any]] = []
    valid: list[tuple[int, BatchItem]] = []
    for item in items:
        reference = item.get("reference") if isinstance(item, dict) else None
        line: dict[str, Any] = {"reference": reference if isinstance(reference, str) else None}
        lines.append(line)
        try:
            if isinstance(item, Problem):
                raise item
            valid.append((len(lines) - 1, BatchItem.model_validate(item)))
        except ValidationError as error:
            line |= {"status": "error", "problem": Problem.of(error).body()}
        except Problem as problem:
            line |= {"status": "error", "problem": problem.body()}
    selections = select_fleet([item for _, item in valid], catalogue)
    for (index, item), selection in zip(valid, selections, strict=True):
        if isinstance(selection, InputError):
            lines[index] |= {"status": "error", "problem": Problem.of(selection).body()}
        else:
            lines[index] |= selection.summary(to_link(item))
    return lines


def line_evaluator(
    catalogue: Catalogue, metrics: Metrics, maximum_line_bytes: int
) -> Callable[[Sequence[Line]], bytes]:
    """Evaluator of lines of JSON for `LineStream`: the same result lines as `batch_lines` gives."""

    def read(line: Line) -> Any:
        if line is None:
            return Problem(413, f"a line may have {maximum_line_bytes} bytes at most")
        try:
            return _parsed(line)
        except ValueError as error:
            return Problem(400, f"the line is not JSON: {error}")

    def evaluate(lines: Sequence[Line]) -> bytes:
        results = batch_lines([read(line) for line in lines], catalogue)
        metrics.batch(results)
        return b"".join([orjson.dumps(result, option=orjson.OPT_APPEND_NEWLINE) for result in results])

    return evaluate

"""Axes of a new machine that come of saved selections, one each."""

from collections.abc import Sequence
from typing import Any

import orjson
from pydantic import ValidationError
from starlette.requests import Request

from hpn.documents.axis import Axis
from hpn.store import SavedSelection
from hpn.web.archive import latest_of
from hpn.web.door.problems import Problem
from hpn.words.titles import LONGEST_NAME
from hpn.words.wording import N_, Sentence

MOST_MARKED = 200
"""Selections that may be marked at once."""

MARK_SOME = N_("Mark the saved selections first: each becomes an axis.")
MARK_FEWER = N_("{found} saved selections are marked, and {most} may be at once.")


async def axes_of(request: Request, ids: Sequence[str]) -> list[Axis]:
    """An axis of each saved selection as its latest revision has it, in their order; Problem 401, 404 and 422."""
    request.app.state.gate.require(request, "reading")
    marked = list(dict.fromkeys(ids))
    if not marked:
        raise Problem(422, Sentence(MARK_SOME))
    if len(marked) > MOST_MARKED:
        raise Problem(422, Sentence(MARK_FEWER, {"found": str(len(marked)), "most": str(MOST_MARKED)}))
    return [_axis_of(await latest_of(request.app.state, id)) for id in marked]


def _axis_of(saved: SavedSelection) -> Axis:
    """Axis with the application of a selection, its title as name and its ordering code."""
    title = saved.title or saved.reference or saved.designation or ""
    name = title if len(title) <= LONGEST_NAME else f"{title[: LONGEST_NAME - 1]}…"
    texts = dict.fromkeys(text for text in (title, saved.reference) if text not in (None, name))
    values: dict[str, Any] = {
        "name": name or None,
        "note": ", ".join(map(str, texts)) or None,
        "ordering_code": saved.ordering_code,
    }
    return Axis(**_sound(values), application=orjson.loads(saved.application))


def _sound(values: dict[str, Any]) -> dict[str, Any]:
    """Values without those that an earlier version has let pass."""
    try:
        Axis.model_validate(values)
    except ValidationError as error:
        wrong = {fault["loc"][0] for fault in error.errors()}
        return {name: value for name, value in values.items() if name not in wrong}
    return values

"""The list of saved machines: newest first, in parts, searched, beside the ways to begin another."""

from typing import Any, Literal

from fastapi import APIRouter
from pydantic import ValidationError
from starlette.requests import Request
from starlette.responses import Response

from hpn.store import LineFilter
from hpn.web.archive import Line
from hpn.web.door.access import admit
from hpn.web.door.pools import compute
from hpn.web.door.problems import Problem, needs
from hpn.web.form.linked import onward
from hpn.web.pages.machine_upload import WORDS, Upload
from hpn.web.pages.machine_view import ADDRESS, REASON
from hpn.web.pages.rendering import or_reason, page
from hpn.web.pages.saved_list import LINES_ON_PAGE, NO_SUCH_PART
from hpn.web.todays import versions_of
from hpn.words.fields import Model
from hpn.words.wording import Sentence


class MachineFilter(Model):
    """Filter of the list: those with every word of a search, with an axis that has no suitable gear, or with one that
    gets another verdict today."""

    search: Line = ""
    show: Literal["", "todo", "differs"] = ""


@or_reason(REASON)
async def show_machines(request: Request) -> Response:
    """Saved machines, newest first. `/api/v1/machines` says the same as JSON."""
    query, versions = request.query_params, versions_of(request.app.state)
    cursor, lines, following, problems, wanted = (
        query.get("cursor") or None,
        [],
        None,
        tuple[Sentence, ...](),
        MachineFilter(),
    )
    try:
        wanted = MachineFilter.model_validate({name: query[name] for name in ("search", "show") if name in query})
        changed_by = versions.key if wanted.show == "differs" else None
        filter = LineFilter(search=wanted.search or None, todo=wanted.show == "todo", changed_by=changed_by)
        lines, following = await request.app.state.store.machines(cursor, LINES_ON_PAGE, filter)
        request.app.state.todays.note(lines)
    except ValidationError as error:
        problems = tuple(Sentence("{text}", {"text": fault.text}) for fault in Problem.of(error).errors)
    except ValueError:
        problems = (Sentence(NO_SUCH_PART),)
    given = {"search": wanted.search, "show": wanted.show}
    shown: dict[str, Any] = {
        **WORDS,
        "lines": lines,
        "wanted": wanted,
        "versions": versions.key,
        "newest": cursor and onward(ADDRESS, **given),
        "older": following and onward(ADDRESS, **given, cursor=following),
        "draft": Upload(),
        "problems": problems,
    }
    return await compute(request, "pages", page, request, "machines.html", 422 if problems else 200, **shown)


router = APIRouter(include_in_schema=False, dependencies=[needs("fleet")])
router.add_api_route(ADDRESS, show_machines, dependencies=[admit("listing")])

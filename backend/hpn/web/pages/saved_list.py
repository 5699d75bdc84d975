"""List of saved selections: newest first, in parts, searched; selections are renamed and deleted there."""

from collections.abc import Mapping
from typing import Any, Literal

from fastapi import APIRouter
from pydantic import ValidationError
from starlette.requests import Request
from starlette.responses import RedirectResponse, Response

from hpn.links.labels import TITLE_BLOCK
from hpn.store import LineFilter, Machine, SavedSelection, Store
from hpn.web.archive import Line, changeable, not_found
from hpn.web.door.access import admit
from hpn.web.door.bodies import pairs_of, read_form
from hpn.web.door.conditions import require_done
from hpn.web.door.hosts import require_same_origin
from hpn.web.door.observation import note
from hpn.web.door.pools import compute
from hpn.web.door.problems import Problem
from hpn.web.form.linked import onward
from hpn.web.pages.rendering import or_reason, page
from hpn.web.pages.saving import REASON
from hpn.web.todays import versions_of
from hpn.words.fields import Model
from hpn.words.titles import faults_of
from hpn.words.wording import N_, Sentence

ADDRESS = "/selections"
LINES_ON_PAGE = 25
CHANGED = N_("This was renamed or deleted since you opened the page. Open it again, then decide.")
NO_SUCH_PART = N_("This part of the list can’t be found; its address is incomplete.")


class SelectionFilter(Model):
    """Filter of the list: by reference, by every word of a search, or by another verdict today."""

    reference: Line | None = None
    search: Line | None = None
    differs: Literal["", "verdict"] = ""


@or_reason(REASON)
async def show_selections(request: Request) -> Response:
    """Page of saved selections, newest first. `/api/v1/selections` is the same as JSON, also for a browser."""
    query = {name: request.query_params.get(name, "") for name in ("search", "reference", "differs")}
    versions = versions_of(request.app.state)
    cursor = request.query_params.get("cursor") or None
    values: dict[str, Any] = {
        **query,
        "lines": [],
        "errors": {},
        "problem": "",
        "older": "",
        "newest": onward(ADDRESS, **query),
        "later": bool(cursor),
        "versions": versions.key,
    }
    store: Store = request.app.state.store
    status = 422
    try:
        chosen_filter = SelectionFilter.model_validate(query)
        changed_by = versions.key if chosen_filter.differs else None
        lines = LineFilter("selection", chosen_filter.search, chosen_filter.reference, changed_by=changed_by)
        part = await store.page(cursor=cursor, limit=LINES_ON_PAGE, filter=lines)
    except ValidationError as error:
        values["errors"] = {fault.location[0]: fault.text for fault in Problem.of(error).errors}
    except ValueError:
        values["problem"] = NO_SUCH_PART
    else:
        status, values["lines"] = 200, part.selections
        request.app.state.todays.note(part.selections)
        values["older"] = part.next_cursor and onward(ADDRESS, **query, cursor=part.next_cursor)
    return await compute(request, "pages", page, request, "selections.html", status, **values)


@or_reason(REASON)
async def rename_selection(request: Request) -> Response:
    """Rename a saved selection (title and reference), and redirect to the list."""
    return await _change(request, _rename)


async def _rename(request: Request, saved: SavedSelection, fields: dict[str, str]) -> None:
    version = version_of(fields)
    is_renamed = await request.app.state.store.rename(saved.id, names_of(fields, saved), version)
    require_done(is_renamed, version, not_found(saved.id), changed_since())


def version_of(fields: Mapping[str, str]) -> int | None:
    """Version of a form's subject when the form was made; None if blank, -1, which never exists, if malformed."""
    text = fields.get("version", "")
    return (int(text) if text.isascii() and text.isdigit() and len(text) < 10 else -1) if text else None


def changed_since() -> Problem:
    """Problem for a form whose subject has changed since."""
    return Problem(412, CHANGED)


def names_of(fields: Mapping[str, str], saved: SavedSelection | Machine) -> dict[str, str | None]:
    """Title and reference of a form that renames; Problem 422 for an invalid one, unless it is unchanged."""
    names = {"title": fields.get("title", "").strip(), "ref": fields.get("ref", "").strip()}
    faults = [
        Sentence("{field}: {message}", {"field": TITLE_BLOCK[name], "message": fault}, ("field",))
        for name, text in names.items()
        if text not in (saved.title, saved.reference)
        for fault in faults_of(text)
    ]
    if faults:
        raise Problem(422, faults)
    return {"title": names["title"] or None, "reference": names["ref"] or None}


@or_reason(REASON)
async def ask_to_delete(request: Request) -> Response:
    """Page that asks for confirmation before a saved selection is deleted."""
    saved = await changeable(request, request.path_params["id"])
    back = _back(request.query_params.get("back", ""))
    return await compute(request, "pages", page, request, "selection_delete.html", saved=saved, back=back)


@or_reason(REASON)
async def delete_selection(request: Request) -> Response:
    """Delete a saved selection permanently, and redirect to the list."""
    return await _change(request, _delete)


async def _delete(request: Request, saved: SavedSelection, fields: dict[str, str]) -> None:
    version = version_of(fields)
    require_done(await request.app.state.store.delete(saved.id, version), version, not_found(saved.id), changed_since())


async def _change(request: Request, change: Any) -> Response:
    """Make a change of a saved selection from its list; redirect to the list."""
    require_same_origin(request)
    fields = dict(pairs_of(await read_form(request)))
    saved = await changeable(request, request.path_params["id"])
    await change(request, saved, fields)
    note(request, selection=saved.id)
    return RedirectResponse(_back(fields.get("back", "")), 303)


def _back(address: str) -> str:
    """Address of the part of the list that a change came from; the whole list for any other address."""
    query = address.removeprefix(f"{ADDRESS}?")
    return address if query != address and query.isascii() and query.isprintable() else ADDRESS


router = APIRouter(include_in_schema=False)
router.add_api_route(ADDRESS, show_selections, dependencies=[admit("listing")])
router.add_api_route(f"{ADDRESS}/{{id}}/rename", rename_selection, methods=["POST"], dependencies=[admit("deleting")])
router.add_api_route(f"{ADDRESS}/{{id}}/delete", ask_to_delete, dependencies=[admit("deleting")])
router.add_api_route(f"{ADDRESS}/{{id}}/delete", delete_selection, methods=["POST"], dependencies=[admit("deleting")])

"""Page of a machine, where it is saved, renamed and deleted.

A machine is kept for a day, and permanently once it is saved with its title block.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import partial
from string import punctuation
from typing import Any
from urllib.parse import quote

from fastapi import APIRouter
from starlette.requests import Request
from starlette.responses import RedirectResponse, Response

from hpn import ENGINE_VERSION
from hpn.catalogue import Catalogue
from hpn.documents.revision import SAVED, decode, is_label
from hpn.links.labels import FIELDS, TITLE_BLOCK
from hpn.store import Machine, RevisionDraft, StoreUnavailableError
from hpn.web.columns import revision_of, thawed
from hpn.web.door.access import admit
from hpn.web.door.bodies import pairs_of, read_form
from hpn.web.door.conditions import require_done
from hpn.web.door.hosts import require_same_origin
from hpn.web.door.observation import note
from hpn.web.door.pools import PoolName, compute, pool_of, while_present
from hpn.web.door.problems import Problem, needs
from hpn.web.form.common import BY_SYMBOL, FIRST, FIRST_TOLERANCES, OF_TOLERANCE
from hpn.web.form.tolerance_fields import INPUT_OF
from hpn.web.freezing import revision
from hpn.web.machines import FEW_AXES, require_seen
from hpn.web.pages.explanations import reads_pages
from hpn.web.pages.machine_editing import OF_MANY, Editing, opened_common
from hpn.web.pages.machine_rows import row_details
from hpn.web.pages.machine_since import Since, since_of
from hpn.web.pages.machine_view import ADDRESS, FILTERS, REASON, MachineView, RowChoice
from hpn.web.pages.rendering import or_reason, page, reason
from hpn.web.pages.revisions_view import next_revision
from hpn.web.pages.saved_list import changed_since, names_of, version_of
from hpn.words.reader import Reader
from hpn.words.titles import faults_of
from hpn.words.wording import N_, Sentence

OLDER_ADDRESS = "/fleets"
MEDIA_TYPES = {
    "xlsx": "application/vnd.openxmlformats-officedocument.spreadsheetml.sheet",
    "csv": "text/csv; charset=utf-8",
    "parquet": "application/vnd.apache.parquet",
}
"""Formats of the answers in the order of the offer: formats that keep texts as texts come first."""

CHANGES_ON_PAGE = 100
OF_WORST_CASE = ("uw", "ot")
"""Common values for the judgement of gears over tolerances; the page shows them beside the tolerances."""

SAVED_MEANWHILE = N_("This machine has since been saved under other names. Open it again, then rename it.")
NO_MACHINE = N_("There is no such machine. An unsaved machine is kept for a day.")


# --- The page of a result ---------------------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class TitleForm:
    """Title block of a form that saves, as filled in."""

    labels: Mapping[str, str]

    def messages(self, name: str, index: int | None = None) -> list[Sentence]:
        """Messages for a field."""
        return list(faults_of(self.labels[name]))

    @property
    def is_sound(self) -> bool:
        """True if no field has a fault."""
        return not any(self.messages(name) for name in self.labels)


EMPTY = TitleForm(dict.fromkeys(TITLE_BLOCK, ""))


@or_reason(REASON)
async def show(request: Request) -> Response:
    """Page of a machine: counts, and axes filtered and sorted by the address; `edit=common` opens its common values.

    If a key is needed for changes, `edit` is the step that asks for it.
    """
    saved = await _machine_of(request)
    request.app.state.gate.require_key_to_edit(request, saved.owner)
    if label := request.query_params.get("revision"):
        return await _revision_page(request, saved, label)
    editing = opened_common(saved) if request.query_params.get("edit") == "common" else Editing()
    return await machine_page(request, saved, 200, EMPTY, editing)


async def machine_page(request: Request, saved: Machine, status: int, form: TitleForm, editing: Editing) -> Response:
    """Page of a machine with the form that saves it, and with a change that is being edited."""
    latest = await request.app.state.store.revisions(saved.id) if saved.revisions else []
    view = MachineView(saved, request.app.state.catalogue, RowChoice.of(request.query_params))
    today = await _today(request, saved)
    may_change = request.app.state.gate.may_change(request, saved.owner)
    values = {"form": form, "today": today, "editing": editing, "may_change": may_change}
    values |= {"line": None, "since": await since_of(request, saved, latest, view.chosen.since)} | next_revision(latest)
    return await compute(request, "pages", _page, request, view, status, values)


async def _revision_page(request: Request, saved: Machine, label: str) -> Response:
    """Read-only page of a machine in the state of a revision."""
    line, content = await revision(request, saved.id, label)
    catalogue: Catalogue = request.app.state.catalogue
    if line.catalogue_version != catalogue.version:
        catalogue = await request.app.state.store.catalogue(line.catalogue_version) or catalogue
    few: PoolName = "pages" if line.axes <= FEW_AXES else "batches"
    machine = await compute(request, few, lambda: thawed(saved, line, decode(content)))
    view = MachineView(machine, catalogue, replace(RowChoice.of(request.query_params), revision=line.label))
    values = {"form": EMPTY, "today": None, "editing": Editing(), "may_change": False, "line": line, "since": None}
    return await compute(request, few, _page, request, view, 200, values)


def _page(request: Request, view: MachineView, status: int, values: Mapping[str, Any]) -> Response:
    since: Since | None = values["since"]
    view = replace(view, changed_axes=since.changed_numbers if since else frozenset())
    rows = [*view.rows, *([view.top] if view.top else [])]
    return page(
        request,
        "machine.html",
        status,
        saved=view.machine,
        view=view,
        details=row_details(view, rows),
        filters=FILTERS,
        engine_version=ENGINE_VERSION,
        catalogue_version=request.app.state.catalogue.version,
        most_changes=CHANGES_ON_PAGE,
        suffixes=tuple(MEDIA_TYPES),
        first_fields=FIRST,
        common_fields=tuple(name for name in BY_SYMBOL if name not in OF_WORST_CASE),
        of_worst_case=OF_WORST_CASE,
        first_tolerances=FIRST_TOLERANCES,
        tolerance_fields=tuple(field for field in OF_TOLERANCE if INPUT_OF[field] not in BY_SYMBOL),
        many_fields=OF_MANY,
        **values,
    )


async def _today(request: Request, saved: Machine) -> list[Any] | None:
    """Axes with other answers by today's engine and catalogue; None if both are unchanged."""
    catalogue = request.app.state.catalogue
    versions = {(axis.answer["engine_version"], axis.answer["catalogue_version"]) for axis in saved.items}
    if versions <= {(ENGINE_VERSION, catalogue.version)}:
        return None
    changed_axes: list[Any] = await compute(request, "batches", _changes, saved, catalogue)
    return changed_axes


def _changes(*arguments: Any) -> Any:
    from hpn.web.pages import machine_answers

    return machine_answers.changes(*arguments)


async def _machine_of(request: Request) -> Machine:
    saved: Machine | None = await request.app.state.store.find_machine(request.path_params["machine"])
    if saved is None:
        raise Problem(404, NO_MACHINE)
    require_seen(request, saved)
    return saved


async def download(request: Request) -> Response:
    """File of the answers."""
    suffix = request.scope["path"].rpartition(".")[2]
    try:
        saved = await _machine_of(request)
    except (Problem, StoreUnavailableError) as error:
        if reads_pages(request):
            return reason(request, REASON, error)
        raise
    pool = pool_of(request, "exports")

    async def work() -> bytes:
        async with pool.turn:
            return await pool.run_beside(await pool.run(_file, saved, suffix, request.state.reader))

    with pool.place():
        content = await while_present(request, work())
    headers = {"Content-Disposition": f'attachment; filename="axes.{suffix}"', "Vary": "Accept-Language, Cookie"}
    return Response(content, 200, headers, MEDIA_TYPES[suffix])


def _file(saved: Machine, suffix: str, reader: Reader) -> Callable[[], bytes]:
    """Call that makes a file."""
    from hpn.web.pages import machine_answers
    from hpn.web.pages.answer_files import file_of

    return partial(file_of, machine_answers.answers_of(saved), saved.created, suffix, reader)


# --- Saving, listing, renaming, deleting ------------------------------------------------------------------------------


@or_reason(REASON)
async def save(request: Request) -> Response:
    """Save a calculated machine with its title block, and redirect to its page."""
    require_same_origin(request)
    fields = dict(pairs_of(await read_form(request)))
    form = TitleForm({name: fields.get(name, "").strip() for name in TITLE_BLOCK})
    saved = await _machine_of(request)
    if not form.is_sound:
        return await machine_page(request, saved, 422, form, Editing())
    names = {FIELDS[name]: text or None for name, text in form.labels.items()}
    first = await compute(request, "pages", _first_revision, saved, names)
    if not await request.app.state.store.save_machine(saved.id, names, request.state.api_key, first):
        await _require_same(request, names)
    note(request, machine=saved.id)
    return RedirectResponse(f"{ADDRESS}/{saved.id}", 303)


def _first_revision(saved: Machine, names: Mapping[str, str | None]) -> RevisionDraft:
    """First revision of a machine; its label is the typed revision if valid, else SAVED with the typed text as note."""
    text = names["revision"]
    label = text if text and is_label(text) else SAVED
    named = replace(saved, title=names["title"], reference=names["reference"], author=names["author"])
    return revision_of(named, label, author=names["author"], note=None if label == text else text)


async def _require_same(request: Request, names: Mapping[str, str | None]) -> None:
    """Raise Problem 412 unless the machine is saved under the same names: a form that is sent twice saves once."""
    saved = await _machine_of(request)
    if any(getattr(saved, name) != text for name, text in names.items()):
        raise Problem(412, SAVED_MEANWHILE)


async def lead_to_list(request: Request) -> Response:
    """Redirect from the former address of the list."""
    query = request.scope["query_string"]
    return RedirectResponse(ADDRESS + (f"?{quote(query, safe=punctuation)}" if query else ""), 308)


@or_reason(REASON)
async def rename(request: Request) -> Response:
    """Rename a saved machine (title and reference), and redirect to its page."""
    require_same_origin(request)
    fields = dict(pairs_of(await read_form(request)))
    saved, version = await _own(request), version_of(fields)
    names = names_of(fields, saved)
    is_renamed = await request.app.state.store.rename(saved.id, names, version, "machine")
    require_done(is_renamed, version if saved.saved else None, Problem(404, NO_MACHINE), changed_since())
    note(request, machine=saved.id)
    return RedirectResponse(f"{ADDRESS}/{saved.id}", 303)


@or_reason(REASON)
async def ask_to_delete(request: Request) -> Response:
    """Page that asks for confirmation before a machine is deleted."""
    return await compute(request, "pages", page, request, "machine_delete.html", saved=await _own(request))


@or_reason(REASON)
async def delete(request: Request) -> Response:
    """Delete a machine permanently, and redirect to the list."""
    require_same_origin(request)
    has_form = "content-type" in request.headers  # a script may send no body
    version = version_of(dict(pairs_of(await read_form(request)))) if has_form else None
    saved = await _own(request)
    is_deleted = await request.app.state.store.delete(saved.id, version, "machine")
    require_done(is_deleted, version, Problem(404, NO_MACHINE), changed_since())
    note(request, machine=saved.id)
    return RedirectResponse(ADDRESS, 303)


async def _own(request: Request) -> Machine:
    saved = await _machine_of(request)
    request.app.state.gate.require_owner(request, saved.owner)
    return saved


async def lead_on(request: Request) -> Response:
    """Redirect from an older address to today's; method, body and query stay."""
    path, query = request.scope["path"].removeprefix(OLDER_ADDRESS), request.scope["query_string"]
    address = ADDRESS + quote(path) + (f"?{quote(query, safe=punctuation)}" if query else "")
    return RedirectResponse(address, 308)


router = APIRouter(include_in_schema=False, dependencies=[needs("fleet")])
router.add_api_route(f"{ADDRESS}/saved", lead_to_list, dependencies=[admit("listing")])
router.add_api_route(f"{ADDRESS}/{{machine}}", show, dependencies=[admit("reading")])
router.add_api_route(f"{ADDRESS}/{{machine}}", save, methods=["POST"], dependencies=[admit("writing")])
for suffix in MEDIA_TYPES:
    router.add_api_route(f"{ADDRESS}/{{machine}}/axes.{suffix}", download, dependencies=[admit("reading")])
router.add_api_route(f"{ADDRESS}/{{machine}}/rename", rename, methods=["POST"], dependencies=[admit("deleting")])
router.add_api_route(f"{ADDRESS}/{{machine}}/delete", ask_to_delete, dependencies=[admit("deleting")])
router.add_api_route(f"{ADDRESS}/{{machine}}/delete", delete, methods=["POST"], dependencies=[admit("deleting")])
for older in (OLDER_ADDRESS, f"{OLDER_ADDRESS}/{{rest:path}}"):
    router.add_api_route(older, lead_on, methods=["GET", "POST"], dependencies=[admit("calculator")])

"""Revisions as they are frozen, of machines and of selections: a selection's keeps its whole reply, too."""

from dataclasses import replace
from typing import Any

from starlette.requests import Request

from hpn.catalogue import Catalogue
from hpn.documents.revision import RevisionBlock
from hpn.store import Draft, LabelTakenError, Machine, Once, RevisionDraft, RevisionLine, SavedAxis
from hpn.web.columns import revision_of
from hpn.web.door.conditions import other_state
from hpn.web.door.observation import note
from hpn.web.door.pools import compute
from hpn.web.door.problems import Problem
from hpn.web.machines import LIMITS, RETRY_SECONDS, TRIES, editable, guarded, of_today, require_document, selection_of
from hpn.words.wording import N_, Sentence

SAVE_FIRST = N_("nobody has saved this machine yet: save it first, then freeze a revision")
TAKEN = N_("there is a revision {label} already: choose another label")
HEAD = ("selected", "designation", "status", "utilisation", "engine_version", "catalogue_version")
"""Columns of an answer that are columns of a selection's line."""


async def freeze(
    request: Request,
    id: str,
    block: RevisionBlock,
    once: Once | None,
    draft: Draft | None = None,
    version: int | None = None,
) -> str:
    """Label of the new revision of a document's working copy, or of a selection's that becomes what a draft has.

    Problem 403, 404, 409 for a taken label, what nobody has saved, and a selection that is open, 412 for another
    state than `If-Match` names or another version than one given, 422 beyond the bounds, 410 and 422 for a used key.
    """
    for _ in range(TRIES):
        machine = await editable(request, id)
        if draft is None:
            require_document(request, machine)
        if version not in (None, machine.version):
            raise other_state()
        if machine.saved is None:
            raise Problem(409, Sentence(SAVE_FIRST))
        made = await compute(request, "batches", _frozen, machine, block, request.app.state.catalogue, draft)
        made = replace(made, created_by=request.state.api_key)
        try:
            label: str | None = await guarded(request.app.state.store.freeze(id, machine.version, made, LIMITS, once))
        except LabelTakenError:
            raise Problem(409, Sentence(TAKEN, {"label": block.label})) from None
        if label is not None:
            note(request, **{machine.kind: id})
            return label
    raise Problem.later("others are changing this machine at the moment; try again", RETRY_SECONDS)


def _frozen(machine: Machine, block: RevisionBlock, catalogue: Catalogue, draft: Draft | None) -> RevisionDraft:
    if draft is None:
        machine = of_today(machine, catalogue)
    else:
        machine = replace(machine, common="{}", items=(_axis(machine.items[0], draft),))
    made = revision_of(machine, block.label, author=block.author, note=block.note)
    made = replace(made, checked=block.checked, approved=block.approved)
    if made.catalogue_version == catalogue.version:
        made = replace(made, catalogue=catalogue)
    if machine.kind == "machine":
        return made
    (axis,) = machine.items
    head: dict[str, Any] = {name: axis.answer[name] for name in HEAD} | {"ordering_code": axis.ordering_code}
    result = selection_of(machine, axis, catalogue) if draft is None else draft.result
    return replace(made, result=result, head=head, axis=None if draft is None else axis)


def _axis(axis: SavedAxis, draft: Draft) -> SavedAxis:
    """The axis of a selection with another application."""
    return replace(
        axis,
        application=draft.application,
        phases=draft.phases,
        answer=draft.columns,
        ordering_code=draft.ordering_code,
        without="[]",
    )


async def revision(request: Request, id: str, label: str) -> tuple[RevisionLine, bytes]:
    """The revision of a label in any case, and what is frozen in it; Problem 404."""
    frozen: tuple[RevisionLine, bytes] | None = await request.app.state.store.revision(id, label)
    if frozen is None:
        raise Problem(404, f"there is no revision {label[:20]!r}")
    return frozen

"""Freezing of revisions of machines and selections; a selection's revision contains its whole reply, too."""

from dataclasses import replace
from typing import Any

from starlette.requests import Request

from hpn.catalogue import Catalogue
from hpn.documents.revision import RevisionBlock
from hpn.store import Draft, LabelTakenError, Machine, Once, RevisionDraft, RevisionLine, SavedAxis, Store
from hpn.store.records import DocumentKind
from hpn.web.archive import no_revision
from hpn.web.columns import revision_of
from hpn.web.door.conditions import other_state
from hpn.web.door.observation import note
from hpn.web.door.pools import compute
from hpn.web.door.problems import Problem
from hpn.web.machines import LIMITS, RETRY_SECONDS, TRIES, editable, guarded, of_today, require_document, selection_of
from hpn.words.wording import N_, Sentence

SAVE_FIRST = N_("nobody has saved this machine yet: save it first, then freeze a revision")
LABEL_IN_USE = N_("there is a revision {label} already: choose another label")
HEAD = ("selected", "designation", "status", "utilisation", "engine_version", "catalogue_version")
"""Columns of an answer that a selection's line has, too."""


async def freeze(
    request: Request,
    id: str,
    block: RevisionBlock,
    once: Once | None,
    draft: Draft | None = None,
    version: int | None = None,
) -> str:
    """Freeze a document's working copy, or a selection with the content of `draft`; label of the new revision.

    Raises Problem 403, 404, 409 for a taken label, an unsaved document or an open selection, 412 if `If-Match` names
    another state or `version` is another, 422 beyond the limits, 410 and 422 for a used idempotency key, 503 if others
    keep changing the document.
    """
    for _ in range(TRIES):
        machine = await editable(request, id)
        if draft is None:
            require_document(request, machine)
        if version not in (None, machine.version):
            raise other_state()
        if machine.saved is None:
            raise Problem(409, Sentence(SAVE_FIRST))
        revision = await compute(
            request, "batches", _revision_draft, machine, block, request.app.state.catalogue, draft
        )
        revision = replace(revision, created_by=request.state.api_key)
        try:
            label: str | None = await guarded(
                request.app.state.store.freeze(id, machine.version, revision, LIMITS, once)
            )
        except LabelTakenError:
            raise Problem(409, Sentence(LABEL_IN_USE, {"label": block.label})) from None
        if label is not None:
            note(request, **{machine.kind: id})
            return label
    raise Problem.later("others are changing this machine at the moment; try again", RETRY_SECONDS)


def _revision_draft(machine: Machine, block: RevisionBlock, catalogue: Catalogue, draft: Draft | None) -> RevisionDraft:
    if draft is None:
        machine = of_today(machine, catalogue)
    else:
        machine = replace(machine, common="{}", items=(_axis(machine.items[0], draft),))
    revision = revision_of(machine, block.label, author=block.author, note=block.note)
    revision = replace(revision, checked=block.checked, approved=block.approved)
    if revision.catalogue_version == catalogue.version:
        revision = replace(revision, catalogue=catalogue)
    if machine.kind == "machine":
        return revision
    (axis,) = machine.items
    head: dict[str, Any] = {name: axis.answer[name] for name in HEAD} | {"ordering_code": axis.ordering_code}
    result = selection_of(machine, axis, catalogue) if draft is None else draft.result
    return replace(revision, result=result, head=head, axis=None if draft is None else axis)


def _axis(axis: SavedAxis, draft: Draft) -> SavedAxis:
    """Axis of a selection with the application and answer of a draft."""
    return replace(
        axis,
        application=draft.application,
        phases=draft.phases,
        answer=draft.columns,
        ordering_code=draft.ordering_code,
        without="[]",
    )


async def revision(request: Request, id: str, label: str, kind: DocumentKind = "machine") -> tuple[RevisionLine, bytes]:
    """Revision by its label in upper or lower case, and its frozen content; Problem 404."""
    store: Store = request.app.state.store
    frozen = await store.revision(id, label)
    if frozen is None:
        raise no_revision(f"/{kind}s/{id}", label, await store.revisions(id))
    return frozen

"""Store: a few functions over a database, each within a time limit."""

import asyncio
import logging
import re
import time
from collections.abc import Mapping, Sequence
from datetime import datetime
from typing import Any

import brotli
import msgspec
from sqlalchemy import select

from hpn.catalogue import Catalogue
from hpn.catalogue.copy import UnreadableCopyError, read_copy
from hpn.store.changes import Change, Limits, change, freeze, read_contents, read_revision, read_revisions
from hpn.store.errors import StoreError, StoreUnavailableError
from hpn.store.keys import KeyResult, Once, made_by
from hpn.store.lists import ID, LineFilter, read_lines, read_machine_lines
from hpn.store.machines import (
    add_machine,
    insert_unsaved,
    read_axes,
    read_deletions,
    read_gears,
    read_machine,
    require_room,
    save_machine,
)
from hpn.store.motor_lists import (
    MotorListDraft,
    MotorListLine,
    SavedMotorList,
    add_list,
    read_list,
    read_lists,
    remove_list,
    replace_list,
)
from hpn.store.records import (
    AxesOfGear,
    DocumentKind,
    DocumentLine,
    Machine,
    MachineDraft,
    MachineList,
    RevisionDraft,
    RevisionLine,
    SavedAxis,
)
from hpn.store.rehearsal import rehearse
from hpn.store.saved import Draft, Page, SavedSelection, SelectionLine, unpacked
from hpn.store.tables import catalogues, documents, revisions
from hpn.store.todays import (
    AxisVerdict,
    Stale,
    Versions,
    count_pending,
    keep_verdicts,
    read_unasked,
    settle,
    settle_machine,
    take_stale,
)
from hpn.store.transactions import Transactions
from hpn.store.upgrade import missing_parts
from hpn.store.writing import insert, remove, rename

logger = logging.getLogger(__name__)

TRIAL_SECONDS = 1.0

LABEL = re.compile(r"[A-Za-z0-9._-]{1,20}")
"""Label of a revision."""

SUMMARY = [documents.c[name] for name in SelectionLine.__dataclass_fields__]


class _Answer(msgspec.Struct):
    selected: str | None = None
    designation: str | None = None
    status: str | None = None
    utilisation: float | None = None


class _Axis(msgspec.Struct):
    """Axis of a selection's revision: the application and its answer."""

    resolved: msgspec.Raw
    answer: _Answer = msgspec.field(default_factory=_Answer)
    ordering_code: str | None = None


class _Frozen(msgspec.Struct):
    axes: tuple[_Axis]
    title: str | None = None
    reference: str | None = None
    author: str | None = None

    @property
    def head(self) -> dict[str, Any]:
        """Columns of the selection's line in the list, as this revision has them."""
        (axis,) = self.axes
        block = {"title": self.title, "reference": self.reference, "author": self.author}
        return block | msgspec.structs.asdict(axis.answer) | {"ordering_code": axis.ordering_code}


_frozen = msgspec.json.Decoder(_Frozen).decode


class Store(Transactions):
    """Saved documents. A document is durable once the function that saves it has returned. The database is connected at
    first need."""

    def __init__(self, address: str, *, seconds: float = 5.0, password: str | None = None) -> None:
        super().__init__(address, seconds=seconds, password=password)
        self._trial: asyncio.Task[StoreUnavailableError | None] | None = None
        self._next_trial = 0.0

    async def close(self) -> None:
        """Close the connections; the next call opens new ones. SQLite finishes its current write first."""
        if self._trial is not None:
            self._trial.cancel()
        await super().close()

    async def check(self, catalogue: Catalogue | None = None) -> None:
        """Raise StoreUnavailableError unless a selection could be saved now, under the catalogue where one is given.

        The check saves on trial, at most once in TRIAL_SECONDS; callers in between get the same answer.
        """
        now = time.monotonic()
        if self._trial is None or (self._trial.done() and now >= self._next_trial):
            self._next_trial = now + TRIAL_SECONDS
            self._trial = asyncio.create_task(self._try_saving(catalogue))
        if failed := await asyncio.shield(self._trial):
            raise failed.with_traceback(None)  # the traceback is the trial's, and all callers share it

    async def _try_saving(self, catalogue: Catalogue | None) -> StoreUnavailableError | None:
        try:
            await self._write(lambda connection: rehearse(connection, catalogue))
        except StoreUnavailableError as error:
            return error
        return None

    async def require_complete(self) -> None:
        """Raise StoreError where the database lacks a table, column or index of this version."""
        async with self._reading() as connection:
            missing = await connection.run_sync(missing_parts)
        if missing:
            raise StoreError(f"the database lacks {', '.join(missing)}: it is damaged, or not one of HPN Select")

    # --- Selections ---------------------------------------------------------------------------------------------------

    async def save(self, draft: Draft) -> str:
        """Id of the saved selection: a new one, or the one that the same idempotency key has saved before.

        Raises KeyReusedError where the key came with other content, and KeySpentError where its selection was deleted.
        A caller that stops waiting does not know whether the selection is saved; a retry with the same key tells.
        """
        return await self._write(lambda connection: insert(connection, draft))

    async def find(self, id: str, label: str | None = None) -> SavedSelection | None:
        """Selection with this id in its latest revision, or in the revision with a label; None where there is none."""
        if not ID.fullmatch(id) or not (label is None or LABEL.fullmatch(label)):
            return None
        c, r = documents.c, revisions.c
        is_revision = r.number == c.revisions if label is None else r.label_key == label.casefold()
        query = select(*SUMMARY, c.owner, r.number, r.content_packed, r.result_packed)
        query = query.join_from(documents, revisions, (r.document == c.id) & is_revision)
        async with self._reading() as connection:
            row = (await connection.execute(query.where(c.id == id, c.kind == "selection"))).one_or_none()
            lines = () if row is None else tuple(await read_revisions(connection, id))
        if row is None:
            return None
        fields = row._asdict()
        number, result = fields.pop("number"), unpacked(fields.pop("result_packed"))
        frozen = _frozen(unpacked(fields.pop("content_packed")))
        line = next(each for each in lines if each.number == number)
        if line is not lines[0]:
            same = ("engine_version", "catalogue_version")
            fields |= frozen.head | {name: getattr(line, name) for name in same} | {"revision": line.label}
        application = bytes(frozen.axes[0].resolved)
        return SavedSelection(**fields, label=line.label, revisions=lines, application=application, result=result)

    async def catalogue(self, version: str) -> Catalogue | None:
        """Catalogue of this version; None where no copy was kept with a selection, or the copy is unreadable."""
        query = select(catalogues.c.content_brotli).where(catalogues.c.version == version)
        async with self._reading() as connection:
            packed = (await connection.execute(query)).scalar_one_or_none()
        try:
            return None if packed is None else read_copy(brotli.decompress(packed))
        except (UnreadableCopyError, brotli.error) as error:
            logger.warning("catalogue %s: %s", version, error)
            return None

    async def page(
        self,
        *,
        reference: str | None = None,
        search: str | None = None,
        cursor: str | None = None,
        limit: int = 50,
        filter: LineFilter | None = None,
    ) -> Page:
        """Saved selections, newest first: all, those with a reference, those with every word of a search, or those of a
        filter.

        Words are found in title, reference, author, gear and ordering code, in any case. Raises ValueError for an
        invalid cursor.
        """
        filter = filter or LineFilter("selection", search, reference)
        async with self._reading() as connection:
            return Page(*await read_lines(connection, SelectionLine, filter, cursor, limit))

    # --- Documents ----------------------------------------------------------------------------------------------------

    async def rename(
        self, id: str, names: Mapping[str, str | None], version: int | None = None, kind: DocumentKind = "selection"
    ) -> bool:
        """Give a saved document another `title` or `reference`, or both; False where no document has this id.

        With a version, False also where the document has changed since: of all callers that saw one version, one can
        change it.
        """
        return bool(ID.fullmatch(id)) and await self._write(
            lambda connection: rename(connection, id, names, version, kind)
        )

    async def delete(self, id: str, version: int | None = None, kind: DocumentKind = "selection") -> bool:
        """Delete a document; False as `rename`."""
        return bool(ID.fullmatch(id)) and await self._write(lambda connection: remove(connection, id, version, kind))

    # --- Machines -----------------------------------------------------------------------------------------------------

    async def require_room(self, caller: str, most_bytes: int) -> None:
        """Raise the errors of `keep_machine`, before a machine is calculated."""
        async with self._reading() as connection:
            await require_room(connection, caller, most_bytes)

    async def keep_machine(self, draft: MachineDraft, most_bytes: int) -> str:
        """Id of a calculated machine, which is kept for a day.

        Raises ShareSpentError where its caller has reached the limit of unsaved machines, and NoRoomError where all
        unsaved machines with this one would exceed `most_bytes` bytes; no machine goes before its day to make room.
        """
        return await self._write(lambda connection: insert_unsaved(connection, draft, most_bytes))

    async def save_machine(
        self, id: str, names: Mapping[str, str | None], owner: str | None, first: RevisionDraft
    ) -> bool:
        """Save a calculated machine with title, reference, author and its first revision; False where there is none."""
        return bool(ID.fullmatch(id)) and await self._write(
            lambda connection: save_machine(connection, id, names, owner, first)
        )

    async def find_machine(
        self, id: str, kind: DocumentKind | None = "machine", numbers: Sequence[int] | None = None
    ) -> Machine | None:
        """Machine with this id, saved or calculated within a day, with all or some of its axes; or None."""
        if not ID.fullmatch(id):
            return None
        async with self._reading() as connection:
            return await read_machine(connection, id, kind, numbers)

    async def gears(self, id: str, without: int) -> dict[str, AxesOfGear]:
        """Axes of a document by their gears, without one of them."""
        async with self._reading() as connection:
            return await read_gears(connection, id, without)

    async def removed_axis(self, id: str, number: int) -> SavedAxis | None:
        """Axis that was removed from a document, or None."""
        async with self._reading() as connection:
            return (await read_axes(connection, id, [number], with_removed=True)).get(number)

    async def add_machine(self, draft: MachineDraft, once: Once | None = None) -> str:
        """Id of a new saved machine, or of the one that the same idempotency key has saved before; raises as `save`."""
        return await self._write(lambda connection: add_machine(connection, draft, once))

    async def change(self, id: str, new: Change, limits: Limits, once: Once | None = None) -> list[int] | None:
        """Numbers of the new and the restored axes; None where the document or an axis has changed since the caller saw
        it.

        Raises ExcessError beyond the limits, and the errors of a key as `save`.
        """
        return await self._write(lambda connection: change(connection, id, new, limits, once))

    async def made_by(self, once: Once) -> KeyResult | None:
        """Document that an idempotency key has made; None for a new key. Raises as `save`."""
        async with self._reading() as connection:
            return await made_by(connection, once.key, once.digest)

    async def freeze(
        self, id: str, version: int, draft: RevisionDraft, limits: Limits, once: Once | None = None
    ) -> str | None:
        """Label of the new revision; None where the document is no longer in this version, or is not saved.

        Raises LabelTakenError, ExcessError, and the errors of a key as `save`.
        """
        return await self._write(lambda connection: freeze(connection, id, version, draft, limits, once))

    async def revisions(self, id: str) -> list[RevisionLine]:
        """Revisions of a document, the latest first."""
        async with self._reading() as connection:
            return await read_revisions(connection, id)

    async def revision(self, id: str, label: str) -> tuple[RevisionLine, bytes] | None:
        """Revision with a label, in any case, and its content; None where there is none."""
        if not LABEL.fullmatch(label):
            return None
        async with self._reading() as connection:
            return await read_revision(connection, id, label)

    async def revision_contents(self, id: str, most: int) -> dict[int, bytes]:
        """Contents of the latest revisions of a document, by their numbers."""
        async with self._reading() as connection:
            return await read_contents(connection, id, most)

    async def machines(
        self, cursor: str | None = None, limit: int = 50, filter: LineFilter | None = None
    ) -> tuple[list[DocumentLine], str | None]:
        """Saved machines, newest first, and a cursor to the next part; ValueError for an invalid cursor."""
        async with self._reading() as connection:
            return await read_lines(connection, DocumentLine, filter or LineFilter(), cursor, limit)

    async def machine_list(
        self, cursor: str | None, limit: int, filter: LineFilter, filters: Mapping[str, LineFilter]
    ) -> MachineList:
        """Saved machines with the figures of their page, and the numbers of machines of other filters."""
        async with self._reading() as connection:
            return await read_machine_lines(connection, filter, filters, cursor, limit)

    async def deleted(self, since: datetime, kind: DocumentKind | None) -> list[tuple[str, datetime]]:
        """Ids and moments of saved documents deleted since a moment, at most a year ago; the latest last."""
        async with self._reading() as connection:
            return await read_deletions(connection, since, kind)

    # --- Lists of motors ----------------------------------------------------------------------------------------------

    async def add_motor_list(self, draft: MotorListDraft, owner: str | None) -> str:
        """Id of a new list of motors; raises NameTakenError and ListsSpentError."""
        return await self._write(lambda connection: add_list(connection, draft, owner or ""))

    async def replace_motor_list(self, id: str, draft: MotorListDraft, version: int | None = None) -> bool:
        """Replace a list of motors; False where there is none, or where its version differs. Raises NameTakenError."""
        return bool(ID.fullmatch(id)) and await self._write(
            lambda connection: replace_list(connection, id, draft, version)
        )

    async def delete_motor_list(self, id: str, version: int | None = None) -> bool:
        """Delete a list of motors; False as `replace_motor_list`."""
        return bool(ID.fullmatch(id)) and await self._write(lambda connection: remove_list(connection, id, version))

    async def motor_list(self, id: str) -> SavedMotorList | None:
        """List of motors with this id, or None."""
        if not ID.fullmatch(id):
            return None
        async with self._reading() as connection:
            return await read_list(connection, id)

    async def motor_lists(self) -> Sequence[MotorListLine]:
        """All lists of motors by their names."""
        async with self._reading() as connection:
            return await read_lists(connection)

    # --- Today --------------------------------------------------------------------------------------------------------

    async def pending(self, versions: Versions, kind: DocumentKind | None) -> int:
        """Number of saved documents without a verdict by these versions."""
        async with self._reading() as connection:
            return await count_pending(connection, versions, kind)

    async def take_stale(self, versions: Versions, most: int, started: datetime) -> list[Stale]:
        """Documents that a process, started at a moment, is to ask again from now on."""
        return await self._write(lambda connection: take_stale(connection, versions, most, started))

    async def settle(self, stale: Stale, versions: Versions, values: dict[str, Any] | None) -> None:
        """Keep a selection's verdict of today; without values the selection is asked again."""
        await self._write(lambda connection: settle(connection, stale, versions, values))

    async def unasked_axes(self, id: str, versions: Versions, most: int) -> tuple[str, list[SavedAxis]]:
        """Common values of a machine as JSON, and some of its axes without a verdict of today."""
        async with self._reading() as connection:
            return await read_unasked(connection, id, versions, most)

    async def keep_verdicts(self, id: str, versions: Versions, verdicts: Sequence[AxisVerdict]) -> None:
        """Keep today's verdicts on axes of a machine."""
        await self._write(lambda connection: keep_verdicts(connection, id, versions, verdicts))

    async def settle_machine(self, id: str, versions: Versions) -> bool:
        """Count the axes of a machine with another verdict; False where some have not been asked yet."""
        return await self._write(lambda connection: settle_machine(connection, id, versions))

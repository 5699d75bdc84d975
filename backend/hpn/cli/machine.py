"""`hpn machine export ID FILE`, `hpn machine import FILE`: copies a machine from the database to a file and back."""

import argparse
import asyncio
import sys
from collections.abc import Callable
from datetime import datetime
from pathlib import Path
from typing import Any

import msgspec
from pydantic import ValidationError

from hpn import ENGINE_VERSION
from hpn.application import InputError
from hpn.application.faults import lines_of
from hpn.application.unique import RepeatedNameError, require_unique
from hpn.catalogue import Catalogue
from hpn.cli.refusals import MOST_LINES
from hpn.documents import revision
from hpn.documents.axis import MOST_BYTES, MOST_REVISIONS
from hpn.documents.document import Document
from hpn.documents.revision import SAVED, Frozen, is_label
from hpn.fleet.beside import read_answered
from hpn.fleet.order import require_writable
from hpn.installed import require
from hpn.store import Machine, MachineDraft, RevisionDraft, Store
from hpn.web.api import machine_replies as replies
from hpn.web.api.machine_tables import sizing_of
from hpn.web.api.machines import draft_of, require_machine
from hpn.web.api.replies import RevisionReply, encode
from hpn.web.columns import frozen_of
from hpn.web.door.bodies import parsed
from hpn.web.door.problems import Problem
from hpn.web.settings import Settings
from hpn.words.reply import Reply
from hpn.words.wording import MendableError, shortened

TABLES = (".csv", ".parquet", ".xlsx", ".arrow", ".arrows", ".feather", ".csv.gz")


class MachineError(MendableError):
    """Error of an export or import; the text gives the reason."""


class CopiedRevision(Frozen, frozen=True):
    """Revision in a file: its line, and its frozen document."""

    revision: RevisionReply


class Copied(Reply, frozen=True):
    """Revisions of a file, the oldest first."""

    revisions: tuple[CopiedRevision, ...] = ()


def run(options: argparse.Namespace) -> int:
    """Export or import a machine; raises MachineError, StoreError or ValidationError."""
    try:
        return asyncio.run({"export": _export, "import": _import}[options.action](options))
    except Problem as problem:
        raise MachineError(f"{options.file}: {problem.detail}") from None


# --- Export -----------------------------------------------------------------------------------------------------------


async def _export(options: argparse.Namespace) -> int:
    id, file = options.id.rstrip("/").rpartition("/")[2], options.file
    write = None if file == "-" or file.endswith(".json") else _table_writer(file)
    if file != "-":
        require_writable(Path(file))
    store = Store(**Settings().database())
    try:
        await _open(store)
        machine = await store.find_machine(id)
        if machine is None or machine.saved is None:
            raise MachineError(f"{id}: the database has no saved machine with this id; its page has it in the address")
        content = await _copy_of(store, machine) if write is None else write(frozen_of(machine, machine.items))
    finally:
        await store.close()
    if file == "-":
        sys.stdout.write(content.decode() + "\n")
    else:
        Path(file).write_bytes(content)
    return 0


def _table_writer(file: str) -> Callable[[Frozen], bytes]:
    if not file.endswith((".csv", ".parquet")):
        raise MachineError(f"{file}: the suffix must be .json, or .csv or .parquet for a table of the axes")
    require("fleet")
    from hpn.fleet import machine_axes  # needs Arrow

    return machine_axes.csv if file.endswith(".csv") else machine_axes.parquet


async def _copy_of(store: Store, machine: Machine) -> bytes:
    """JSON of a machine as from GET, with its revisions, the oldest first."""
    copies = []
    for line in reversed(await store.revisions(machine.id)):
        content = await store.revision(machine.id, line.label)
        assert content is not None
        copies.append(replies.revision_reply(line, revision.decode(content[1])))
    whole = msgspec.structs.asdict(replies.machine(machine))
    return msgspec.json.format(encode({**whole, "revisions": copies}), indent=1)


# --- Import -----------------------------------------------------------------------------------------------------------


async def _import(options: argparse.Namespace) -> int:
    content = Path(options.file).read_bytes()
    if len(content) > MOST_BYTES:
        raise MachineError(f"{options.file}: has more than {MOST_BYTES} bytes")
    settings = Settings()
    catalogue = settings.catalogue()
    draft = _draft(options, content, catalogue)
    store = Store(**settings.database())
    try:
        await _open(store)
        id = await store.add_machine(draft)
    finally:
        await store.close()
    print(f"/machines/{id}")
    return 0


def _draft(options: argparse.Namespace, content: bytes, catalogue: Catalogue) -> MachineDraft:
    if options.file.endswith(".json"):
        try:
            return _whole(options.file, content, catalogue)
        except (ValidationError, InputError) as error:
            lines = shortened(lines_of(error), MOST_LINES)
            raise MachineError("\n".join(f"{options.file}: {line}" for line in lines)) from None
    if not options.file.endswith(TABLES):
        raise MachineError(f"{options.file}: the suffix must be .json, or one of a table: {', '.join(TABLES)}")
    require("fleet")
    from hpn.web.axis_tables import BOUNDS  # needs Arrow

    table, faults = read_answered(content, BOUNDS, options.answer)
    if faults:
        raise MachineError("\n".join(f"--answer {fault.text}" for fault in faults))
    drafts = sizing_of(table, catalogue)()
    return MachineDraft(drafts, ENGINE_VERSION, catalogue.version, title=options.title)


def _whole(file: str, content: bytes, catalogue: Catalogue) -> MachineDraft:
    """Machine of an exported file, with its revisions as they were frozen."""
    try:
        require_unique(content)
        copies = msgspec.json.decode(content, type=Copied).revisions
        named: dict[str, Any] = msgspec.json.decode(content, type=dict[str, msgspec.Raw])
    except RepeatedNameError:
        raise
    except RecursionError:
        raise MachineError(f"{file}: is no machine that was exported: it is nested too deeply") from None
    except (msgspec.MsgspecError, ValueError) as error:
        raise MachineError(f"{file}: is no machine that was exported: {error}") from None
    named.pop("revisions", None)
    document = parsed(Document, msgspec.json.encode(named), require_machine)
    _require_labels(file, [copy.revision.label for copy in copies])
    return draft_of(document, catalogue, None, [_revision(file, copy) for copy in copies])


def _require_labels(file: str, labels: list[str]) -> None:
    wrong = next((label for label in labels if not (is_label(label) or label == SAVED)), None)
    if wrong is not None:
        raise MachineError(f"{file}: {wrong[:40]!r} can’t be the label of a revision")
    if len({label.casefold() for label in labels}) < len(labels) or len(labels) > MOST_REVISIONS:
        raise MachineError(f"{file}: must have each revision once, and {MOST_REVISIONS} of them at most")


def _revision(file: str, copy: CopiedRevision) -> tuple[datetime, RevisionDraft]:
    line = copy.revision
    same = ("label", "engine_version", "catalogue_version", "author", "checked", "approved", "note", "created_by")
    content = revision.encode(Frozen(*(getattr(copy, name) for name in Frozen.__struct_fields__)))
    try:
        created = datetime.fromisoformat(line.created)
        revision.decode(content)
    except (ValueError, msgspec.MsgspecError) as error:
        raise MachineError(f"{file}: revision {line.label}: {error}") from None
    return created, RevisionDraft(content=content, axes=len(copy.axes), **{name: getattr(line, name) for name in same})


async def _open(store: Store) -> None:
    await store.open()
    await store.require_complete()

"""Selections and fleets become documents with axes and revisions; a saved one becomes its own first revision.

Nothing is calculated anew. Imports no module that later versions change.
"""

import hashlib
import io
import re
from collections.abc import Iterator, Mapping
from datetime import datetime
from typing import Any

import brotli
import msgspec
import sqlalchemy as sa
import zstandard
from alembic import op

from hpn.installed import require

revision = "0010"
down_revision = "0009"

BATCH = 200
Json = dict[str, Any]
MOMENT, WHOLE = sa.DateTime(timezone=True), sa.Integer()


def upgrade() -> None:
    """Move all rows, and drop the old tables."""
    connection = op.get_bind()
    for rows in _batches(connection, _selections):
        _insert(connection, [_of_selection(row) for row in rows])
    for rows in _batches(connection, _fleets, size=1):
        require("fleet")  # tables of a fleet are Parquet
        _insert(connection, [_of_fleet(row) for row in rows])
    _move_keys(connection)
    for name in ("selections", "fleets", "spent_keys"):
        op.drop_table(name)


# --- Rows -------------------------------------------------------------------------------------------------------------


def _table(name: str, columns: str, **kinds: Any) -> sa.TableClause:
    return sa.table(name, *(sa.column(each, kinds.get(each, sa.Text())) for each in columns.split()))


LABELS = "title reference author revision owner"
_selections = _table(
    "selections",
    f"id created {LABELS} version search_text selected designation status utilisation ordering_code engine_version "
    "catalogue_version application result_packed idempotency_key digest",
    created=MOMENT,
    utilisation=sa.Double(),
    version=sa.Integer(),
    result_packed=sa.LargeBinary(),
)
_fleets = _table(
    "fleets",
    f"id created saved {LABELS} caller version engine_version catalogue_version asked answers",
    created=MOMENT,
    saved=MOMENT,
    version=sa.Integer(),
    asked=sa.LargeBinary(),
    answers=sa.LargeBinary(),
)

_documents = _table(
    "documents",
    f"id kind created updated saved {LABELS} caller version search_text axes suitable unsuitable open revisions "
    "selected designation status utilisation ordering_code engine_version catalogue_version bytes numbers common "
    "axis_order",
    **dict.fromkeys(("created", "updated", "saved"), MOMENT),
    **dict.fromkeys(("version", "axes", "suitable", "unsuitable", "open", "revisions", "bytes", "numbers"), WHOLE),
    utilisation=sa.Double(),
)
_axes = _table(
    "axes",
    "document number version updated updated_by name quantity note ordering_code without phases status selected "
    "designation governing_check utilisation life_L10_h shortest_life_h shortest_life_of natural_frequency_Hz "
    "motor_torque_limit_Nm weight_kg suitable runner_up average_torque_Nm not_asked unknown faults engine_version "
    "catalogue_version application",
    updated=MOMENT,
    **dict.fromkeys(("number", "version", "quantity", "phases", "suitable"), WHOLE),
    **dict.fromkeys(("utilisation", "life_L10_h", "shortest_life_h", "natural_frequency_Hz"), sa.Double()),
    **dict.fromkeys(("motor_torque_limit_Nm", "weight_kg", "average_torque_Nm"), sa.Double()),
)
_revisions = _table(
    "revisions",
    "document number label label_key created created_by author note axes engine_version catalogue_version "
    "content_packed result_packed",
    created=MOMENT,
    **dict.fromkeys(("number", "axes"), WHOLE),
    **dict.fromkeys(("content_packed", "result_packed"), sa.LargeBinary()),
)


def _batches(connection: sa.Connection, table: sa.TableClause, size: int = BATCH) -> Iterator[list[Any]]:
    query, last = sa.select(table).order_by(table.c.id).limit(size), ""
    while rows := list(connection.execute(query.where(table.c.id > last))):
        yield rows
        last = rows[-1].id


def _insert(connection: sa.Connection, documents: list[tuple[Json, list[Json], Json | None]]) -> None:
    """Insert documents, each with its axes and its first revision, if it has one."""
    rows = {
        "documents": [document for document, _, _ in documents],
        "axes": [axis for _, axes, _ in documents for axis in axes],
        "revisions": [frozen for _, _, frozen in documents if frozen is not None],
    }
    for table in (_documents, _axes, _revisions):
        if rows[table.name]:
            connection.execute(table.insert(), rows[table.name])


LABEL, SAVED = re.compile(r"[A-Za-z0-9._-]{1,20}"), "saved"


def _first_revision(row: Any, moment: datetime, axes: list[Json], result: bytes | None = None) -> Json:
    """First revision of a saved document, under its own `revision` text where that is a valid label."""
    text = row.revision or ""
    fits = LABEL.fullmatch(text) and text.strip(".") and text.casefold() not in ("now", "today", SAVED)
    label = text if fits else SAVED
    block = {name: getattr(row, name) for name in ("title", "reference", "author")}
    content = {**block, "note": None, "common": {}, "axes": [_frozen(axis) for axis in axes]}
    return {
        "document": row.id,
        "number": 1,
        "label": label,
        "label_key": label.casefold(),
        "created": moment,
        "created_by": row.owner,
        "author": row.author,
        "note": None if fits else text or None,
        "axes": len(axes),
        "engine_version": row.engine_version,
        "catalogue_version": row.catalogue_version,
        "content_packed": zstandard.compress(msgspec.json.encode(content)),
        "result_packed": result,
    }


ANSWER = (
    *("status", "selected", "designation", "governing_check", "utilisation", "life_L10_h", "shortest_life_h"),
    *("shortest_life_of", "natural_frequency_Hz", "motor_torque_limit_Nm", "weight_kg", "suitable", "runner_up"),
    *("average_torque_Nm", "engine_version", "catalogue_version"),
)


def _frozen(axis: Json) -> Json:
    own = msgspec.Raw(axis["application"].encode())
    return {
        **{name: axis[name] for name in ("number", "name", "quantity", "note", "ordering_code")},
        "without": [],
        "application": own,
        "resolved": own,
        "answer": {
            **{name: axis[name] for name in ANSWER},
            "not_asked": [],
            "unknown": msgspec.Raw(axis["unknown"].encode()),
            "faults": msgspec.Raw(axis["faults"].encode()),
        },
    }


def _document(row: Any, kind: str, moment: datetime | None, axes: list[Json], **parts: Any) -> Json:
    states = [axis["status"] for axis in axes]
    return {
        **{name: getattr(row, name) for name in ("id", "created", *LABELS.split(), "version")},
        **{name: getattr(row, name) for name in ("engine_version", "catalogue_version")},
        **{state: states.count(state) for state in ("suitable", "unsuitable", "open")},
        "kind": kind,
        "updated": moment or row.created,
        "saved": moment,
        "axes": len(axes),
        "numbers": len(axes),
        "revisions": 0 if moment is None else 1,
        "axis_order": msgspec.json.encode([axis["number"] for axis in axes]).decode(),
        "common": "{}",
        "bytes": sum(len(axis["application"]) for axis in axes),
        **parts,
    }


def _axis(row: Any, number: int, moment: datetime, application: str, phases: int, **parts: Any) -> Json:
    empty = dict.fromkeys((*ANSWER, "name", "note", "ordering_code"))
    return {
        **empty,
        "document": row.id,
        "number": number,
        "version": 1,
        "updated": moment,
        "updated_by": row.owner,
        "quantity": 1,
        "without": "[]",
        "phases": phases,
        "not_asked": "[]",
        "unknown": "[]",
        "faults": "[]",
        "engine_version": row.engine_version,
        "catalogue_version": row.catalogue_version,
        "application": application,
        **parts,
    }


# --- Selections -------------------------------------------------------------------------------------------------------


class _Candidate(msgspec.Struct):
    designation: str
    status: str
    utilisation: float | None = None
    governing_check: str | None = None
    life_L10_h: float | None = None
    shortest_life_h: float | None = None
    shortest_life_of: str | None = None
    natural_frequency_Hz: float | None = None
    motor_torque_limit_Nm: float | None = None


class _Duty(msgspec.Struct):
    average_torque_Nm: float | None = None


class _Said(msgspec.Struct):
    """Fields of an answer's candidates, by their names."""

    candidates: tuple[dict[str, msgspec.Raw], ...]


class _Reply(msgspec.Struct):
    candidates: tuple[_Candidate, ...]
    said: tuple[dict[str, msgspec.Raw], ...] = ()
    selected: str | None = None
    duty: _Duty = msgspec.field(default_factory=_Duty)


UNREADABLE = {"pointer": "", "code": "unreadable", "detail": "what was saved here can’t be read"}


def _of_selection(row: Any) -> tuple[Json, list[Json], Json]:
    reply = _reply(row.result_packed)
    pairs = zip(reply.candidates, reply.said, strict=True) if reply else ()
    pair = next(((one, said) for one, said in pairs if one.designation == row.designation), None)
    if reply is None or pair is None:
        answer: Json = {"status": "open", "faults": msgspec.json.encode([UNREADABLE]).decode()}
    else:
        suitable = [one.designation for one in reply.candidates if one.status == "suitable"]
        answer = {
            **msgspec.structs.asdict(pair[0]),
            "unknown": _lacking(pair[1]),
            "selected": reply.selected,
            "suitable": len(suitable),
            "runner_up": (*suitable, None, None)[1],
            "average_torque_Nm": reply.duty.average_torque_Nm,
        }
    phases = _phases_in(row.application)
    axis = _axis(row, 1, row.created, row.application, phases, ordering_code=row.ordering_code, **answer)
    kept = ("search_text", "selected", "designation", "status", "utilisation", "ordering_code")
    document = _document(row, "selection", row.created, [axis], **{name: getattr(row, name) for name in kept})
    return document, [axis], _first_revision(row, row.created, [axis], row.result_packed)


def _reply(packed: bytes) -> _Reply | None:
    try:
        frame = packed.startswith(zstandard.FRAME_HEADER)
        content = zstandard.decompress(packed) if frame else brotli.decompress(packed)
        candidates = msgspec.json.decode(content, type=_Said).candidates
        return msgspec.structs.replace(msgspec.json.decode(content, type=_Reply), said=candidates)
    except (msgspec.MsgspecError, zstandard.ZstdError, brotli.error, UnicodeDecodeError):
        return None


FIGURES = ("life_L10_h", "shortest_life_h", "natural_frequency_Hz", "motor_torque_limit_Nm")


def _lacking(raw: Mapping[str, Any]) -> str:
    """Names of figures that an answer's version did not know, as JSON; the mass stood only in the catalogue."""
    return msgspec.json.encode([*(name for name in FIGURES if name not in raw), "weight_kg"]).decode()


def _phases_in(application: str) -> int:
    try:
        cycle = msgspec.json.decode(application.encode()).get("duty_cycle") or {}
        return len(cycle.get("phases") or (cycle.get("motion") or {}).get("moves") or ())
    except (msgspec.MsgspecError, AttributeError, TypeError):
        return 0


# --- Fleets -----------------------------------------------------------------------------------------------------------


def _of_fleet(row: Any) -> tuple[Json, list[Json], Json | None]:
    moment = row.saved or row.created
    questions, answers = _cells(row.asked), _cells(row.answers)
    if questions is None or answers is None:
        unreadable = msgspec.json.encode([UNREADABLE]).decode()
        axes = [_axis(row, 1, moment, "{}", 0, status="open", faults=unreadable)]
    else:
        named = {cells.pop("axis"): cells for cells in questions}
        axes = [
            _of_answer(row, number, moment, cells, named.get(cells.get("axis")))
            for number, cells in enumerate(answers, 1)
        ]
    used = [axis["utilisation"] for axis in axes if axis["status"] == "suitable" and axis["utilisation"] is not None]
    words = "\n".join(filter(None, (row.title, row.reference, row.author))).casefold()
    parts = {"caller": row.caller, "search_text": words, "utilisation": max(used, default=None)}
    document = _document(row, "machine", row.saved, axes, **parts)
    return document, axes, None if row.saved is None else _first_revision(row, row.saved, axes)


def _cells(parquet: bytes) -> list[Json] | None:
    """Rows of a table; None for an unreadable one."""
    import pyarrow as pa  # of the extra that wrote these tables
    import pyarrow.parquet as pq

    try:
        rows: list[Json] = pq.read_table(io.BytesIO(parquet)).to_pylist()
    except (pa.ArrowException, OSError):
        return None
    return rows


def _of_answer(row: Any, number: int, moment: datetime, cells: Json, question: Json | None) -> Json:
    application = _application_of(question or {})
    parts: Json = {"name": cells.get("axis") or None}
    if faults := _faults_of(cells):
        parts |= {"status": "open", "faults": msgspec.json.encode(faults).decode()}
    else:
        parts |= _answer_of(cells)
    phases = len(application.get("duty_cycle", {}).get("phases", ()))
    return _axis(row, number, moment, msgspec.json.encode(application).decode(), phases, **parts)


def _faults_of(cells: Mapping[str, Any]) -> list[Json]:
    """Reasons for which an axis was rejected: one text, or columns with a code and a sentence each."""
    if cells.get("error") is not None:
        return [{"pointer": "", "code": "rejected", "detail": cells["error"]}]
    return [
        {"pointer": f"/{column.replace('.', '/')}", "code": code, "detail": _text(said), "sentence": said}
        for column, code, said in msgspec.json.decode((cells.get("faults") or "[]").encode())
    ]


def _text(content: Any) -> str:
    """English text of a sentence with its values."""
    if not isinstance(content, dict):
        return str(content)
    if "template" not in content:
        return str(content.get("value"))
    return str(content["template"]).format(**{name: _text(value) for name, value in content.get("values", {}).items()})


def _answer_of(cells: Mapping[str, Any]) -> Json:
    """Answer of an axis: its gear, or the nearest miss where none suits."""
    same = {name: cells.get(name) for name in ("suitable", "runner_up", "average_torque_Nm", "life_L10_h")}
    same |= {name: cells.get(name) for name in ("shortest_life_h", "shortest_life_of", "motor_torque_limit_Nm")}
    same["unknown"] = _lacking(cells)
    if cells.get("selected") is not None:
        verdict = {name: cells[name] for name in ("selected", "governing_check", "utilisation")}
        return {**same, **verdict, "status": "suitable", "designation": cells["selected"]}
    used = cells.get("nearest_utilisation")
    return {
        **same,
        "status": "unsuitable" if cells.get("nearest_check") is not None else "unrated",
        "designation": cells.get("nearest"),
        "governing_check": cells.get("nearest_check"),
        "utilisation": used,
    }


def _application_of(cells: Mapping[str, Any]) -> Json:
    """Application of a row in list form."""
    lists = {name: values for name, values in cells.items() if isinstance(values, list) and "." not in name}
    count = max(map(len, lists.values()), default=0)
    if not count:
        return {}
    phases = [
        {name: values[place] for name, values in lists.items() if place < len(values) and values[place] is not None}
        for place in range(count)
    ]
    application: Json = {"duty_cycle": {"phases": phases}}
    for name, value in cells.items():
        if name in lists or value is None:
            continue
        *parts, last = ("duty_cycle.pause_s" if name == "pause_s" else name).split(".")
        place = application
        for part in parts:
            place = place.setdefault(part, {})
        place[last] = value
    return application


# --- Idempotency keys -------------------------------------------------------------------------------------------------


def _move_keys(connection: sa.Connection) -> None:
    spent = _table("spent_keys", "key_sha256 deleted", deleted=MOMENT)
    keys = _table("idempotency_keys", "key_sha256 digest document part deleted", deleted=MOMENT)
    of_spent = sa.select(spent.c.key_sha256, spent.c.deleted)
    connection.execute(keys.insert().from_select(["key_sha256", "deleted"], of_spent))
    c = _selections.c
    held = sa.select(c.idempotency_key, c.digest, c.id).where(c.idempotency_key.is_not(None))
    rows = [
        {"key_sha256": hashlib.sha256(key.encode()).hexdigest(), "digest": digest, "document": id}
        for key, digest, id in connection.execute(held)
    ]
    for start in range(0, len(rows), BATCH):
        connection.execute(keys.insert(), rows[start : start + BATCH])

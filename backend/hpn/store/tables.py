"""Tables after the last migration."""

from datetime import UTC, datetime

from sqlalchemy import (
    BigInteger,
    Boolean,
    Column,
    DateTime,
    Double,
    ForeignKey,
    Index,
    Integer,
    LargeBinary,
    MetaData,
    String,
    Table,
    Text,
)
from sqlalchemy.engine import Dialect
from sqlalchemy.types import TypeDecorator


class UtcTime(TypeDecorator[datetime]):
    """Moment in UTC, even where the database keeps no time zone (SQLite)."""

    impl = DateTime(timezone=True)
    cache_ok = True

    def process_bind_param(self, value: datetime | None, dialect: Dialect) -> datetime | None:
        """Moment in UTC for the database."""
        return None if value is None else value.astimezone(UTC)

    def process_result_value(self, value: datetime | None, dialect: Dialect) -> datetime | None:
        """Moment from the database, in UTC."""
        return None if value is None else value.replace(tzinfo=UTC) if value.tzinfo is None else value.astimezone(UTC)


metadata = MetaData()

documents = Table(
    "documents",
    metadata,
    Column("id", String(32), primary_key=True),
    Column("kind", String(9), nullable=False),  # selection or machine; never changes
    Column("created", UtcTime, nullable=False),
    Column("updated", UtcTime, nullable=False),
    Column("saved", UtcTime),  # null until somebody saves it; an unsaved one is deleted after a day
    Column("title", Text),
    Column("reference", Text),
    Column("author", Text),
    Column("revision", Text),  # of a selection its author's text, of a machine the latest label
    Column("note", Text),
    Column("owner", Text),  # name of the API key that saved it
    Column("caller", Text, nullable=False, server_default=""),  # of an unsaved machine: hash of key or address
    # Counts changes of title block, common values, order and set of axes: callers name the version that they have seen.
    Column("version", Integer, nullable=False, server_default="1"),
    Column("search_text", Text, nullable=False, server_default=""),
    Column("axes", Integer, nullable=False, server_default="0"),
    Column("suitable", Integer, nullable=False, server_default="0"),
    Column("unsuitable", Integer, nullable=False, server_default="0"),
    Column("open", Integer, nullable=False, server_default="0"),
    Column("revisions", Integer, nullable=False, server_default="0"),  # number of the latest one
    # Of a selection the gear that its page shows first, with its first verdict; null where an earlier version's reply
    # can't be read. Of a machine the largest utilisation of an axis with a suitable gear.
    Column("selected", Text),
    Column("designation", Text),
    Column("status", Text),
    Column("utilisation", Double),
    Column("ordering_code", Text),
    Column("engine_version", Text, nullable=False),
    Column("catalogue_version", Text, nullable=False),
    Column("bytes", Integer, nullable=False, server_default="0"),  # of the axes' own parts
    Column("numbers", Integer, nullable=False, server_default="0"),  # highest number given to an axis so far
    # Verdict of today's engine and catalogue, whose versions `today_of` names; null before they have been asked.
    Column("today_of", Text),
    Column("today_changed", Integer),  # axes with another verdict
    Column("today_selected", Text),
    Column("today_status", Text),
    Column("today_axes", Text),  # numbers of the first such axes, as JSON
    Column("today_taken", UtcTime),  # moment when a process began to ask
    # Of a machine: gears to order, their kinds and mass, null where the kind or mass of one is unknown; and the axis
    # with the largest utilisation.
    Column("gears", BigInteger),
    Column("kinds", Integer),
    Column("weight_kg", Double),
    Column("governing_axis", Integer),
    # Moments of the latest revision and of the last change of title block, common values or order; number of axes
    # changed, added or removed since the revision, plus 1 for a change of the document itself.
    Column("revised", UtcTime),
    Column("edited", UtcTime),
    Column("changes", Integer, nullable=False, server_default="0"),
    # Long texts stand last: to reach a column behind them, SQLite reads all their pages.
    Column("common", Text, nullable=False, server_default="{}"),
    Column("axis_order", Text, nullable=False, server_default="[]"),
    Index("documents_saved", "kind", "saved", "id"),
    Index("documents_reference", "reference", "saved", "id"),
    Index("documents_created", "created"),
    Index("documents_today", "today_of", "kind", "saved"),
    Index("documents_caller", "caller", "saved", "created"),
)


def _of_document() -> Column[str]:
    return Column("document", String(32), ForeignKey("documents.id", ondelete="CASCADE"), primary_key=True)


axes = Table(
    "axes",
    metadata,
    _of_document(),
    Column("number", Integer, primary_key=True, autoincrement=False),
    Column("version", Integer, nullable=False, server_default="1"),
    Column("updated", UtcTime, nullable=False),
    Column("updated_by", Text),
    Column("removed", UtcTime),  # null while the axis is present; its number can restore it
    Column("name", Text),
    Column("quantity", Integer, nullable=False, server_default="1"),
    Column("note", Text),
    Column("ordering_code", Text),
    Column("without", Text, nullable=False, server_default="[]"),
    Column("phases", Integer, nullable=False, server_default="0"),
    # The answer.
    Column("status", Text, nullable=False),
    Column("selected", Text),
    Column("designation", Text),
    Column("governing_check", Text),
    Column("utilisation", Double),
    Column("life_L10_h", Double),
    Column("shortest_life_h", Double),
    Column("shortest_life_of", Text),
    Column("natural_frequency_Hz", Double),
    Column("motor_torque_limit_Nm", Double),
    Column("weight_kg", Double),
    Column("suitable", Integer),
    Column("runner_up", Text),
    Column("average_torque_Nm", Double),
    Column("holds", Boolean),
    Column("worst_utilisation", Double),
    Column("worst_governing_check", Text),
    Column("not_asked", Text, nullable=False, server_default="[]"),
    Column("unknown", Text, nullable=False, server_default="[]"),  # figures that an earlier version did not know
    Column("faults", Text, nullable=False, server_default="[]"),
    Column("engine_version", Text, nullable=False),
    Column("catalogue_version", Text, nullable=False),
    Column("today_of", Text),  # versions of the latest verdict of today
    Column("today_changed", Boolean),  # True where these versions give another verdict
    Column("application", Text, nullable=False),  # the axis's own part, as it was sent
    Index("axes_counts", "document", "removed", "status", "utilisation", "phases"),
)

revisions = Table(
    "revisions",
    metadata,
    _of_document(),
    Column("number", Integer, primary_key=True, autoincrement=False),
    Column("label", Text, nullable=False),
    Column("label_key", Text, nullable=False),  # casefolded
    Column("created", UtcTime, nullable=False),
    Column("created_by", Text),
    Column("author", Text),
    Column("checked", Text),
    Column("approved", Text),
    Column("note", Text),
    Column("axes", Integer, nullable=False),
    Column("engine_version", Text, nullable=False),
    Column("catalogue_version", Text, nullable=False),
    # The frozen document, and the reply to a selection byte for byte.
    Column("content_packed", LargeBinary, nullable=False),
    Column("result_packed", LargeBinary),
    Index("revisions_label", "document", "label_key", unique=True),
)

idempotency_keys = Table(
    "idempotency_keys",
    metadata,
    # Only a hash: deleted content must be gone.
    Column("key_sha256", String(64), primary_key=True),
    Column("digest", String(64)),
    Column("document", String(32)),
    Column("part", Text),  # of the document: numbers of axes, or a label
    Column("deleted", UtcTime),  # moment when its document was deleted
    Index("idempotency_keys_document", "document"),
)

askings = Table(
    "askings",
    metadata,
    Column("versions", Text, primary_key=True),  # of engine and catalogue that documents are asked by again
    Column("begun", UtcTime, nullable=False),
)

deletions = Table(
    "deletions",
    metadata,
    Column("document", String(32), primary_key=True),
    Column("kind", String(9), nullable=False),
    Column("deleted", UtcTime, nullable=False),
    Index("deletions_deleted", "deleted", "document"),
)

motor_lists = Table(
    "motor_lists",
    metadata,
    Column("id", String(32), primary_key=True),
    Column("owner", Text, nullable=False, server_default=""),  # name of the API key that keeps it, blank without a key
    Column("name", Text, nullable=False),
    Column("name_key", Text, nullable=False),  # casefolded
    Column("created", UtcTime, nullable=False),
    Column("updated", UtcTime, nullable=False),
    Column("version", Integer, nullable=False, server_default="1"),
    Column("motors", Integer, nullable=False),
    Column("content_packed", LargeBinary, nullable=False),
    Index("motor_lists_name", "owner", "name_key", unique=True),
)

catalogues = Table(
    "catalogues",
    metadata,
    Column("version", Text, primary_key=True),
    # JSON of all figures: some 100 kB, a fiftieth of that when packed.
    Column("content_brotli", LargeBinary, nullable=False),
)

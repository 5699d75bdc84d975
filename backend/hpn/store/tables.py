"""The tables as they are after the last migration."""

from datetime import UTC, datetime

from sqlalchemy import Column, DateTime, Double, Index, Integer, LargeBinary, MetaData, String, Table, Text
from sqlalchemy.engine import Dialect
from sqlalchemy.types import TypeDecorator


class UtcTime(TypeDecorator[datetime]):
    """A moment in UTC, also where the database keeps no time zone (SQLite)."""

    impl = DateTime(timezone=True)
    cache_ok = True

    def process_bind_param(self, value: datetime | None, dialect: Dialect) -> datetime | None:
        """To the database."""
        return None if value is None else value.astimezone(UTC)

    def process_result_value(self, value: datetime | None, dialect: Dialect) -> datetime | None:
        """From the database."""
        return None if value is None else value.replace(tzinfo=UTC) if value.tzinfo is None else value.astimezone(UTC)


metadata = MetaData()

selections = Table(
    "selections",
    metadata,
    Column("id", String(32), primary_key=True),
    Column("created", UtcTime, nullable=False),
    Column("title", Text),
    Column("reference", Text),
    Column("selected", Text),
    Column("engine_version", Text, nullable=False),
    Column("catalogue_version", Text, nullable=False),
    Column("application", Text, nullable=False),
    Column("result_packed", LargeBinary, nullable=False),
    Column("idempotency_key", Text),
    Column("digest", String(64)),
    Column("owner", Text),  # name of the API key that saved it
    Column("author", Text),
    Column("revision", Text),
    Column("ordering_code", Text),
    # The gear that its page shows first, as it was judged then; null where an earlier version's reply can't be read.
    Column("designation", Text),
    Column("status", Text),
    Column("utilisation", Double),
    Column("search_text", Text, nullable=False, server_default=""),
    # Counts its changes: whoever changes it names the version that they have seen.
    Column("version", Integer, nullable=False, server_default="1"),
    Index("selections_created", "created", "id"),
    Index("selections_reference", "reference", "created", "id"),
    Index("selections_idempotency_key", "idempotency_key", unique=True),
)

spent_keys = Table(
    "spent_keys",
    metadata,
    # Only a hash, because what is deleted is to be gone.
    Column("key_sha256", String(64), primary_key=True),
    Column("deleted", UtcTime, nullable=False),
)

catalogues = Table(
    "catalogues",
    metadata,
    Column("version", Text, primary_key=True),
    # The JSON of every figure is some 100 kB; packed it is a fiftieth of that.
    Column("content_brotli", LargeBinary, nullable=False),
)

fleets = Table(
    "fleets",
    metadata,
    Column("id", String(32), primary_key=True),
    Column("created", UtcTime, nullable=False),
    Column("saved", UtcTime),  # null while nobody has saved it: it goes by itself
    Column("title", Text),
    Column("reference", Text),
    Column("author", Text),
    Column("revision", Text),
    Column("owner", Text),  # name of the API key that calculated or saved it
    Column("caller", Text, nullable=False, server_default=""),  # hash of the key or address that calculated it
    Column("version", Integer, nullable=False, server_default="1"),
    Column("axes", Integer, nullable=False),
    Column("selected", Integer, nullable=False),
    Column("unsuitable", Integer, nullable=False),
    Column("rejected", Integer, nullable=False),
    Column("engine_version", Text, nullable=False),
    Column("catalogue_version", Text, nullable=False),
    # Tables in a format that packs them itself; the store does not read them.
    Column("asked", LargeBinary, nullable=False),
    Column("answers", LargeBinary, nullable=False),
    Index("fleets_saved", "saved", "id"),
    Index("fleets_created", "created"),
    Index("fleets_caller", "caller", "saved", "created"),
)

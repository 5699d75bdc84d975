"""Upgrade of a database to this version's tables, safe while several workers start at once."""

from pathlib import Path

from alembic import command
from alembic.autogenerate import compare_metadata
from alembic.config import Config
from alembic.runtime.migration import MigrationContext
from alembic.script import ScriptDirectory
from sqlalchemy import Connection, text
from sqlalchemy.ext.asyncio import AsyncEngine

from hpn import ENGINE_VERSION
from hpn.store.engine import WRITES
from hpn.store.errors import NewerDatabaseError
from hpn.store.tables import metadata

MIGRATIONS = Path(__file__).parent / "migrations"
LOCK = 0x48504E  # any number, the same in every version


async def bring_up_to_date(engine: AsyncEngine) -> None:
    """Run the migrations that the database lacks, in one transaction, under a lock that all workers share.

    Raises NewerDatabaseError where the database has a migration that this version lacks.
    """
    async with engine.connect() as connection:
        if await connection.run_sync(_is_current):
            return
    async with engine.execution_options(**WRITES).begin() as connection:
        if engine.dialect.name == "postgresql":
            await connection.execute(text("SELECT pg_advisory_xact_lock(:lock)"), {"lock": LOCK})
        await connection.run_sync(_migrate)


def missing_parts(connection: Connection) -> list[str]:
    """Names of tables, columns and indexes of this version that the database lacks; additional ones may stay."""
    differences = compare_metadata(MigrationContext.configure(connection), metadata)
    added = [each for each in differences if isinstance(each, tuple) and each[0].startswith("add_")]
    return [".".join(str(getattr(part, "name", part)) for part in each[1:] if part is not None) for each in added]


def _is_current(connection: Connection) -> bool:
    return MigrationContext.configure(connection).get_current_revision() == _scripts().get_current_head()


def _scripts() -> ScriptDirectory:
    return ScriptDirectory(str(MIGRATIONS))


def _migrate(connection: Connection) -> None:
    current = MigrationContext.configure(connection).get_current_revision()
    known = {script.revision for script in _scripts().walk_revisions()}
    if current is not None and current not in known:
        raise NewerDatabaseError(
            f"the database has revision {current}, of which HPN Select {ENGINE_VERSION} knows nothing: a newer version "
            "has changed it. Start that version, or restore a backup from before."
        )
    config = Config()
    config.set_main_option("script_location", str(MIGRATIONS).replace("%", "%%"))
    config.attributes["connection"] = connection
    command.upgrade(config, "head")

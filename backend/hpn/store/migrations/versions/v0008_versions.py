"""Versions that count every change of a saved selection or fleet, and the caller that calculated a fleet."""

import sqlalchemy as sa
from alembic import op

revision = "0008"
down_revision = "0007"


def upgrade() -> None:
    """Add the columns; existing rows are in their first version, and without a caller.

    In SQLite a fleet's columns stand before its tables: to reach a column behind them, SQLite reads all their pages.
    """
    op.add_column("selections", _version())
    caller = sa.Column("caller", sa.Text(), nullable=False, server_default="")
    if op.get_bind().dialect.name == "sqlite":
        with op.batch_alter_table("fleets", recreate="always") as fleets:
            fleets.add_column(caller, insert_after="owner")
            fleets.add_column(_version(), insert_after="caller")
    else:
        op.add_column("fleets", caller)
        op.add_column("fleets", _version())
    op.create_index("fleets_caller", "fleets", ["caller", "saved", "created"])


def _version() -> sa.Column[int]:
    return sa.Column("version", sa.Integer(), nullable=False, server_default="1")

"""Idempotency keys of deleted selections, so that a late retry doesn't save them anew."""

import sqlalchemy as sa
from alembic import op

revision = "0003"
down_revision = "0002"


def upgrade() -> None:
    """Make the table."""
    op.create_table(
        "spent_keys",
        sa.Column("key_sha256", sa.String(64), primary_key=True),
        sa.Column("deleted", sa.DateTime(timezone=True), nullable=False),
    )

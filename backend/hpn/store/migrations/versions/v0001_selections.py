"""Saved selections."""

import sqlalchemy as sa
from alembic import op

revision = "0001"
down_revision = None


def upgrade() -> None:
    """Make the table."""
    op.create_table(
        "selections",
        sa.Column("id", sa.String(32), primary_key=True),
        sa.Column("created", sa.DateTime(timezone=True), nullable=False),
        sa.Column("title", sa.Text()),
        sa.Column("reference", sa.Text()),
        sa.Column("selected", sa.Text()),
        sa.Column("engine_version", sa.Text(), nullable=False),
        sa.Column("catalogue_version", sa.Text(), nullable=False),
        sa.Column("application", sa.Text(), nullable=False),
        sa.Column("result_brotli", sa.LargeBinary(), nullable=False),
        sa.Column("idempotency_key", sa.Text()),
        sa.Column("digest", sa.String(64)),
    )
    op.create_index("selections_created", "selections", ["created", "id"])
    op.create_index("selections_reference", "selections", ["reference", "created", "id"])
    op.create_index("selections_idempotency_key", "selections", ["idempotency_key"], unique=True)

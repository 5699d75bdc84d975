"""Catalogues of saved selections. Selections saved before have none, and stay as they are."""

import sqlalchemy as sa
from alembic import op

revision = "0002"
down_revision = "0001"


def upgrade() -> None:
    """Make the table."""
    op.create_table(
        "catalogues",
        sa.Column("version", sa.Text(), primary_key=True),
        sa.Column("content_brotli", sa.LargeBinary(), nullable=False),
    )

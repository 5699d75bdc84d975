"""Worst case of axes over their tolerances; answers of earlier versions have none."""

import sqlalchemy as sa
from alembic import op

revision = "0011"
down_revision = "0010"


def upgrade() -> None:
    """Add the columns, null for every axis."""
    op.add_column("axes", sa.Column("holds", sa.Boolean()))
    op.add_column("axes", sa.Column("worst_utilisation", sa.Double()))
    op.add_column("axes", sa.Column("worst_governing_check", sa.Text()))

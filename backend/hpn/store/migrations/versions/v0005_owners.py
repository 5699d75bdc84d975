"""API key that saved a selection. Selections saved before have none."""

import sqlalchemy as sa
from alembic import op

revision = "0005"
down_revision = "0004"


def upgrade() -> None:
    """Add the column."""
    op.add_column("selections", sa.Column("owner", sa.Text()))

"""Every change of what is saved counts a version, and a calculated fleet knows who has calculated it."""

import sqlalchemy as sa
from alembic import op

revision = "0008"
down_revision = "0007"


def upgrade() -> None:
    """Add the columns; what is there already is in its first version, and of no caller."""
    for table in ("selections", "fleets"):
        op.add_column(table, sa.Column("version", sa.Integer(), nullable=False, server_default="1"))
    op.add_column("fleets", sa.Column("caller", sa.Text(), nullable=False, server_default=""))

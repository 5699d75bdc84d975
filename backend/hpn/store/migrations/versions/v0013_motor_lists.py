"""Lists of motors are kept under names."""

import sqlalchemy as sa
from alembic import op

revision = "0013"
down_revision = "0012"


def upgrade() -> None:
    """Add their table."""
    op.create_table(
        "motor_lists",
        sa.Column("id", sa.String(32), primary_key=True),
        sa.Column("owner", sa.Text(), nullable=False, server_default=""),
        sa.Column("name", sa.Text(), nullable=False),
        sa.Column("name_key", sa.Text(), nullable=False),
        sa.Column("created", sa.DateTime(timezone=True), nullable=False),
        sa.Column("updated", sa.DateTime(timezone=True), nullable=False),
        sa.Column("version", sa.Integer(), nullable=False, server_default="1"),
        sa.Column("motors", sa.Integer(), nullable=False),
        sa.Column("content_packed", sa.LargeBinary(), nullable=False),
    )
    op.create_index("motor_lists_name", "motor_lists", ["owner", "name_key"], unique=True)

"""Fleets: tables of axes with their answers."""

import sqlalchemy as sa
from alembic import op

revision = "0007"
down_revision = "0006"


def upgrade() -> None:
    """Add the table."""
    moment = sa.DateTime(timezone=True)
    op.create_table(
        "fleets",
        sa.Column("id", sa.String(32), primary_key=True),
        sa.Column("created", moment, nullable=False),
        sa.Column("saved", moment),
        *(sa.Column(name, sa.Text()) for name in ("title", "reference", "author", "revision", "owner")),
        *(sa.Column(name, sa.Integer(), nullable=False) for name in ("axes", "selected", "unsuitable", "rejected")),
        sa.Column("engine_version", sa.Text(), nullable=False),
        sa.Column("catalogue_version", sa.Text(), nullable=False),
        sa.Column("asked", sa.LargeBinary(), nullable=False),
        sa.Column("answers", sa.LargeBinary(), nullable=False),
    )
    op.create_index("fleets_saved", "fleets", ["saved", "id"])
    op.create_index("fleets_created", "fleets", ["created"])

"""Today's verdicts of documents and axes, asked in the background."""

import sqlalchemy as sa
from alembic import op

revision = "0012"
down_revision = "0011"


def upgrade() -> None:
    """Add the columns, null for every document: each is asked once."""
    for name in ("today_of", "today_selected", "today_status", "today_axes"):
        op.add_column("documents", sa.Column(name, sa.Text()))
    op.add_column("documents", sa.Column("today_changed", sa.Integer()))
    op.add_column("documents", sa.Column("today_taken", sa.DateTime(timezone=True)))
    op.create_index("documents_today", "documents", ["today_of", "kind", "saved"])
    op.create_table(
        "askings",
        sa.Column("versions", sa.Text(), primary_key=True),
        sa.Column("begun", sa.DateTime(timezone=True), nullable=False),
    )
    op.add_column("axes", sa.Column("today_of", sa.Text()))
    op.add_column("axes", sa.Column("today_changed", sa.Boolean()))

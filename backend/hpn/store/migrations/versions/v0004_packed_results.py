"""Results are no longer packed by brotli alone: old ones stay as they are, and new ones are zstd frames."""

from alembic import op

revision = "0004"
down_revision = "0003"


def upgrade() -> None:
    """Rename the column."""
    op.alter_column("selections", "result_brotli", new_column_name="result_packed")

"""Gears of machines, their governing axis, and the number of changes since their latest revision."""

import sqlalchemy as sa
from alembic import op

revision = "0014"
down_revision = "0013"

GEAR = "CASE WHEN axes.ordering_code IS NULL THEN axes.selected ELSE axes.designation END"
HAS_GEAR = "(axes.ordering_code IS NOT NULL OR axes.selected IS NOT NULL)"
THERE = "FROM axes WHERE axes.document = documents.id AND axes.removed IS NULL"

REVISED = """
UPDATE documents SET revised = (
    SELECT revisions.created FROM revisions
    WHERE revisions.document = documents.id AND revisions.number = documents.revisions
)
"""

FILLED = f"""
UPDATE documents SET
    gears = (SELECT coalesce(sum(axes.quantity), 0) {THERE} AND {HAS_GEAR}),
    kinds = (
        SELECT CASE WHEN count(*) = count({GEAR}) THEN count(DISTINCT {GEAR}) END {THERE} AND {HAS_GEAR}
    ),
    weight_kg = (
        SELECT CASE WHEN count(*) = count(axes.weight_kg) THEN coalesce(sum(axes.quantity * axes.weight_kg), 0) END
        {THERE} AND {HAS_GEAR}
    ),
    governing_axis = (
        SELECT axes.number {THERE} AND axes.status = 'suitable' AND axes.utilisation IS NOT NULL
        ORDER BY axes.utilisation DESC, axes.number LIMIT 1
    ),
    changes = (
        SELECT count(*) FROM axes WHERE axes.document = documents.id AND axes.updated > documents.revised
    )
WHERE kind = 'machine'
"""


def upgrade() -> None:
    """Add the columns, and fill them from the axes; a figure that an earlier answer lacks stays null."""
    op.add_column("documents", sa.Column("gears", sa.BigInteger()))
    for name in ("kinds", "governing_axis"):
        op.add_column("documents", sa.Column(name, sa.Integer()))
    op.add_column("documents", sa.Column("weight_kg", sa.Double()))
    for name in ("revised", "edited"):
        op.add_column("documents", sa.Column(name, sa.DateTime(timezone=True)))
    op.add_column("documents", sa.Column("changes", sa.Integer(), nullable=False, server_default="0"))
    op.execute(REVISED)
    op.execute(FILLED)

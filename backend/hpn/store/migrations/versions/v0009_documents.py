"""Tables of documents with axes and revisions."""

from typing import Any

import sqlalchemy as sa
from alembic import op

revision = "0009"
down_revision = "0008"

MOMENT = sa.DateTime(timezone=True)


def _text(name: str, default: str | None = None) -> sa.Column[str]:
    return sa.Column(name, sa.Text(), nullable=default is None, server_default=default)


def _needed(name: str, kind: Any = None) -> sa.Column[Any]:
    return sa.Column(name, kind or sa.Text(), nullable=False)


def _count(name: str, default: str = "0") -> sa.Column[int]:
    return sa.Column(name, sa.Integer(), nullable=False, server_default=default)


def _of_document() -> sa.Column[str]:
    target = sa.ForeignKey("documents.id", ondelete="CASCADE")
    return sa.Column("document", sa.String(32), target, primary_key=True)


def _number() -> sa.Column[int]:
    return sa.Column("number", sa.Integer(), primary_key=True, autoincrement=False)


def upgrade() -> None:
    """Make the tables."""
    op.create_table(
        "documents",
        sa.Column("id", sa.String(32), primary_key=True),
        _needed("kind", sa.String(9)),
        _needed("created", MOMENT),
        _needed("updated", MOMENT),
        sa.Column("saved", MOMENT),
        *map(_text, ("title", "reference", "author", "revision", "note", "owner")),
        _text("caller", ""),
        _count("version", "1"),
        _text("search_text", ""),
        *map(_count, ("axes", "suitable", "unsuitable", "open", "revisions")),
        *map(_text, ("selected", "designation", "status")),
        sa.Column("utilisation", sa.Double()),
        _text("ordering_code"),
        *map(_needed, ("engine_version", "catalogue_version")),
        *map(_count, ("bytes", "numbers")),
        _text("common", "{}"),
        _text("axis_order", "[]"),
    )
    op.create_index("documents_saved", "documents", ["kind", "saved", "id"])
    op.create_index("documents_reference", "documents", ["reference", "saved", "id"])
    op.create_index("documents_created", "documents", ["created"])
    op.create_index("documents_caller", "documents", ["caller", "saved", "created"])
    _make_axes()
    op.create_table(
        "revisions",
        _of_document(),
        _number(),
        *map(_needed, ("label", "label_key")),
        _needed("created", MOMENT),
        *map(_text, ("created_by", "author", "checked", "approved", "note")),
        _needed("axes", sa.Integer()),
        *map(_needed, ("engine_version", "catalogue_version")),
        _needed("content_packed", sa.LargeBinary()),
        sa.Column("result_packed", sa.LargeBinary()),
    )
    op.create_index("revisions_label", "revisions", ["document", "label_key"], unique=True)
    op.create_table(
        "idempotency_keys",
        sa.Column("key_sha256", sa.String(64), primary_key=True),
        sa.Column("digest", sa.String(64)),
        sa.Column("document", sa.String(32)),
        _text("part"),
        sa.Column("deleted", MOMENT),
    )
    op.create_index("idempotency_keys_document", "idempotency_keys", ["document"])
    op.create_table(
        "deletions",
        sa.Column("document", sa.String(32), primary_key=True),
        _needed("kind", sa.String(9)),
        _needed("deleted", MOMENT),
    )
    op.create_index("deletions_deleted", "deletions", ["deleted", "document"])


def _make_axes() -> None:
    def double(name: str) -> sa.Column[float]:
        return sa.Column(name, sa.Double())

    op.create_table(
        "axes",
        _of_document(),
        _number(),
        _count("version", "1"),
        _needed("updated", MOMENT),
        _text("updated_by"),
        sa.Column("removed", MOMENT),
        _text("name"),
        _count("quantity", "1"),
        *map(_text, ("note", "ordering_code")),
        _text("without", "[]"),
        _count("phases"),
        _needed("status"),
        *map(_text, ("selected", "designation", "governing_check")),
        *map(double, ("utilisation", "life_L10_h", "shortest_life_h")),
        _text("shortest_life_of"),
        *map(double, ("natural_frequency_Hz", "motor_torque_limit_Nm", "weight_kg")),
        sa.Column("suitable", sa.Integer()),
        _text("runner_up"),
        double("average_torque_Nm"),
        _text("not_asked", "[]"),
        _text("unknown", "[]"),
        _text("faults", "[]"),
        *map(_needed, ("engine_version", "catalogue_version", "application")),
    )
    op.create_index("axes_counts", "axes", ["document", "removed", "status", "utilisation", "phases"])

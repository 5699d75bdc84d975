"""Databases to break."""

from tests.compiled import compiled_templates
from tests.databases import PostgreSQL, database, kind, postgresql

__all__ = ["PostgreSQL", "compiled_templates", "database", "kind", "postgresql"]

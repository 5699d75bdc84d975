"""Databases to break."""

from tests.databases import PostgreSQL, database, kind, postgresql

__all__ = ["PostgreSQL", "database", "kind", "postgresql"]

"""Databases to break."""

from tests.databases import PostgreSQL, database, postgresql

__all__ = ["PostgreSQL", "database", "postgresql"]

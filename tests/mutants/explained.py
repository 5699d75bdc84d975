"""Mutants that no test can or should find, and why."""

EXPLAINED: dict[str, str] = {}

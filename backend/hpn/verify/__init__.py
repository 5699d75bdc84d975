"""Verification of a file: its figures beside newly calculated ones."""

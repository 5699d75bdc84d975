"""Verification of a file: the figures that it shows beside those that are calculated again."""

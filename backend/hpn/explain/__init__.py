"""Explanations of a selection: its calculation, drawings, comparisons and differences."""

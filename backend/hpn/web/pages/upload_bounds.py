"""Bounds of an uploaded table of axes: taken as it is where `hpn fleet` would take it, else as a table of cells."""

from hpn.fleet.columns import are_taken
from hpn.links.symbols import AXIS_INPUTS
from hpn.tables.files import TableBounds

WANTED = TableBounds(AXIS_INPUTS, most_rows=50_000, most_characters=4_000_000, takes=are_taken)
"""Most rows and characters of a text whose columns are not named as `hpn fleet` names them."""

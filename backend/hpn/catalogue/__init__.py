"""The catalogue: CSV tables and a supplement over them, as gears with a source for every figure."""

from hpn.catalogue.catalogue import (
    AVERAGING_S,
    Catalogue,
    GearList,
    ListedMotor,
    OutputVersion,
    SeriesFigure,
)
from hpn.catalogue.gear import GearColumns
from hpn.catalogue.load import HANDBOOK_FOLDER, load_catalogue
from hpn.catalogue.tables import CatalogueError

__all__ = [
    "AVERAGING_S",
    "HANDBOOK_FOLDER",
    "Catalogue",
    "CatalogueError",
    "GearColumns",
    "GearList",
    "ListedMotor",
    "OutputVersion",
    "SeriesFigure",
    "load_catalogue",
]

"""The catalogue: CSV tables and a supplement over them, as gears with a source for every figure.

`hpn.catalogue` is both this package and a function of `hpn`: a call returns the gears for Python.
"""

import sys
from types import ModuleType
from typing import Any

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


class _CallableRoom(ModuleType):
    """This package as a callable, for `hpn.catalogue()`."""

    def __call__(self, *args: Any, **kwargs: Any) -> Any:
        import hpn

        return hpn.Gears.of(*args, **kwargs)


sys.modules[__name__].__class__ = _CallableRoom

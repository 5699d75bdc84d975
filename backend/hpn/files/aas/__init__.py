"""Asset Administration Shell of a selection."""

from typing import Literal

Metamodel = Literal["3.0", "3.1"]
"""Versions of the metamodel; a package is in the namespace of one of them."""

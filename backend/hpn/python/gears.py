"""Catalogue: `hpn.catalogue` and its gears."""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

import msgspec

from hpn.catalogue import Catalogue, load_catalogue
from hpn.catalogue.gear import Gear
from hpn.python import html
from hpn.python.faults import with_application_errors
from hpn.web.settings import Settings

COLUMNS = {
    "ratio": "i",
    "rated_torque_Nm": "T_N in Nm",
    "repeated_peak_torque_Nm": "T_R in Nm",
    "momentary_peak_torque_Nm": "T_M in Nm",
    "maximum_input_speed_rpm": "n_in(max) in rpm",
    "weight_kg": "m in kg",
}
"""Figures that a notebook shows, and their headings."""


@dataclass(frozen=True, eq=False, repr=False)
class Gears:
    """Gears of a catalogue with their published figures; an unpublished figure is None.

    Indexed by designation, in any spelling.
    """

    catalogue: Catalogue

    @property
    def version(self) -> str:
        """Hash of the content, supplement included."""
        return self.catalogue.version

    def __getitem__(self, designation: str) -> Gear:
        gear = self.catalogue.find(designation)
        if gear is None:
            raise KeyError(f"{designation} is no gear of the catalogue")
        return gear

    def __iter__(self) -> Iterator[Gear]:
        return iter(self.catalogue.gears)

    def __len__(self) -> int:
        return len(self.catalogue.gears)

    def columns(self) -> dict[str, list[Any]]:
        """Published figures by column, in the form that every library of data frames takes."""
        rows = [msgspec.to_builtins(gear) for gear in self]
        names = [name for name in rows[0] if not any(isinstance(row[name], list | tuple | dict) for row in rows)]
        return {name: [row[name] for row in rows] for name in names}

    @classmethod
    def of(cls, supplement: str | Path | None = None) -> "Gears":
        """All gears with their published figures, with those of `supplement` laid over them: a folder of CSV files.

        Without `supplement` the one of the settings holds (`HPN_CATALOGUE_SUPPLEMENT`), as for `hpn select`, and is
        read once. Raises `hpn.ApplicationError` for unusable files.
        """
        settings = Settings()
        with with_application_errors():
            if supplement is None:
                return _of_settings(
                    settings.catalogue_folder, settings.catalogue_supplement, settings.averaging_seconds
                )
            return cls(load_catalogue(settings.catalogue_folder, Path(supplement), settings.averaging_seconds))

    def __repr__(self) -> str:
        return f"<hpn.Gears: {len(self)} gears, catalogue {self.version}>"

    def _repr_html_(self) -> str:
        rows = [(gear.designation, *(getattr(gear, name) for name in COLUMNS)) for gear in self]
        return html.table(f"{len(self)} gears, catalogue {self.version}", ("gear", *COLUMNS.values()), rows)


@cache
def _of_settings(folder: Path, supplement: Path | None, averaging_s: float) -> Gears:
    return Gears(load_catalogue(folder, supplement, averaging_s))

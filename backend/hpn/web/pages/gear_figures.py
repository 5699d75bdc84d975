"""Content of a gear's page beside its own figures: figures of the whole series, and files for missing ones."""

from collections.abc import Mapping
from dataclasses import dataclass

from hpn.account.published import FIGURES
from hpn.catalogue import Catalogue
from hpn.catalogue.gear import Gear
from hpn.catalogue.tables import TABLES
from hpn.words.wording import N_


@dataclass(frozen=True, slots=True)
class SupplementFile:
    """File of a supplement for missing figures: its name, its header, and rows to fill in."""

    name: str
    header: str
    rows: tuple[str, ...]


SERIES: Mapping[str, tuple[tuple[str, tuple[str, ...]], ...]] = {
    "Lubrication": (
        (N_("Lubricant"), ("lubricant",)),
        (
            N_("Ambient temperature of the lubricant"),
            ("lubricant_ambient_temperature_minimum", "lubricant_ambient_temperature_maximum"),
        ),
        (N_("Highest operating temperature of the lubricant"), ("lubricant_operating_temperature_maximum",)),
    ),
    "Storage": ((N_("Storage temperature"), ("storage_temperature_minimum", "storage_temperature_maximum")),),
}
"""Figures of the whole series by topic of the handbook: titles, and names in the catalogue."""


@dataclass(frozen=True, slots=True)
class SeriesLine:
    """Figure, range or text of the whole series."""

    name: str
    values: tuple[float, ...]
    text: str
    unit: str
    source: str


def series_figures(catalogue: Catalogue, topic: str) -> list[SeriesLine]:
    """Figures of the whole series on a topic, as far as the catalogue has them."""
    lines = []
    for name, keys in SERIES.get(topic, ()):
        if known := [catalogue.series[key] for key in keys if key in catalogue.series]:
            values = tuple(one.value for one in known if isinstance(one.value, float))
            text = next((one.value for one in known if isinstance(one.value, str)), "")
            lines.append(SeriesLine(name, values, text, known[0].unit or "", known[0].source))
    return lines


def supplements_for(gear: Gear) -> list[SupplementFile]:
    """Files for the missing figures of a gear."""
    missing = {name for name in FIGURES if getattr(gear, name) is None}
    files = []
    for table in TABLES:
        if "size" in table.key and missing & set(table.columns()):
            columns = [*(name for name in table.columns() if name != "source"), "source"]
            known = {"size": gear.size, "ratio": str(gear.ratio), "stages": str(gear.stages), "source": "printed page"}
            row = ",".join(known.get(name, "") if name in (*table.key, "source") else "" for name in columns)
            files.append(SupplementFile(table.file, ",".join(columns), (row,)))
    return files

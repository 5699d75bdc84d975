"""Figures on the page of a gear, in groups; those that are missing, and how a supplement would give them."""

from collections.abc import Mapping
from dataclasses import dataclass

from hpn.catalogue import Catalogue
from hpn.catalogue.gear import Gear
from hpn.catalogue.tables import TABLES
from hpn.words.quantities import GEAR
from hpn.words.units import suffix_of
from hpn.words.wording import N_, Named


@dataclass(frozen=True, slots=True)
class Label:
    """Fields of a figure (two for a range, which has a name of its own), and whether it is an upper limit."""

    fields: tuple[str, ...]
    range: str = ""
    at_most: bool = False

    @property
    def named(self) -> Named:
        """Name and symbol."""
        return Named(self.range) if self.range else GEAR[self.fields[0]]


GROUPS: tuple[tuple[str, tuple[Label, ...]], ...] = (
    (
        N_("Torque at the output"),
        (Label(("rated_torque_Nm",)), Label(("repeated_peak_torque_Nm",)), Label(("momentary_peak_torque_Nm",))),
    ),
    (
        N_("Speed at the input, temperature"),
        (
            Label(("maximum_input_speed_rpm",)),
            Label(("average_input_speed_rpm",)),
            Label(("ambient_temperature_minimum_degC", "ambient_temperature_maximum_degC"), N_("Ambient temperature")),
        ),
    ),
    (
        N_("Accuracy and stiffness"),
        (
            Label(("backlash_arcmin",), at_most=True),
            Label(("transmission_accuracy_arcmin",), at_most=True),
            Label(("torsional_stiffness_Nm_per_rad",)),
        ),
    ),
    (
        N_("Size and weight"),
        (Label(("length_min_mm", "length_max_mm"), N_("Length, depending on the motor")), Label(("weight_kg",))),
    ),
    (
        N_("Output bearing"),
        (Label(("dynamic_radial_load_N",)), Label(("dynamic_axial_load_N",)), Label(("shaft_centre_mm",))),
    ),
    (N_("At the input"), (Label(("inertia_kgm2",)), Label(("no_load_torque_Nm",)))),
)
"""Figures of a gear as its page groups them; None is shown as not published."""


@dataclass(frozen=True, slots=True)
class Figure:
    """One line of the page: a figure or a range, its unit and where it comes from."""

    label: Label
    values: tuple[float, ...]
    unit: str
    source: str
    supplied: bool


@dataclass(frozen=True, slots=True)
class SupplementFile:
    """File of a supplement that would give what is missing: its name, its header, and rows to fill in."""

    name: str
    header: str
    rows: tuple[str, ...]


def figures_of(gear: Gear) -> list[tuple[str, list[Figure]]]:
    """Every figure of a gear by group."""
    return [(title, [_figure(gear, label) for label in labels]) for title, labels in GROUPS]


def all_figures(gear: Gear | None) -> list[Figure]:
    """The same in one list; none of a gear that is not known."""
    return [figure for _, figures in figures_of(gear) for figure in figures] if gear else []


def _figure(gear: Gear, label: Label) -> Figure:
    values = [getattr(gear, name) for name in label.fields]
    known = tuple(dict.fromkeys(value for value in values if value is not None))
    source = next((gear.sources[name] for name in label.fields if name in gear.sources), "")
    supplied = any(gear.is_supplied(name) for name in label.fields)
    return Figure(label, known, suffix_of(label.fields[0]), source, supplied)


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
"""Figures of the whole series beside what the handbook says on a topic: what they are, and their names."""


@dataclass(frozen=True, slots=True)
class SeriesLine:
    """A figure, range or text of the whole series."""

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
    """Files that would fill the figures that are missing of a gear."""
    missing = {name for _, labels in GROUPS for label in labels for name in label.fields if getattr(gear, name) is None}
    files = []
    for table in TABLES:
        if "size" in table.key and missing & set(table.columns()):
            columns = [*(name for name in table.columns() if name != "source"), "source"]
            known = {"size": gear.size, "ratio": str(gear.ratio), "stages": str(gear.stages), "source": "printed page"}
            row = ",".join(known.get(name, "") if name in (*table.key, "source") else "" for name in columns)
            files.append(SupplementFile(table.file, ",".join(columns), (row,)))
    return files


def neighbours(catalogue: Catalogue, gear: Gear) -> dict[str, Gear | None]:
    """The gears of the next ratios in the same size, and of the next sizes in the same ratio."""
    same_size = [other for other in catalogue.gears if other.size == gear.size]
    same_ratio = [other for other in catalogue.gears if other.ratio == gear.ratio]

    def beside(gears: list[Gear], step: int) -> Gear | None:
        place = gears.index(gear) + step
        return gears[place] if 0 <= place < len(gears) else None

    return {
        "lower_ratio": beside(same_size, -1),
        "higher_ratio": beside(same_size, 1),
        "smaller": beside(same_ratio, -1),
        "larger": beside(same_ratio, 1),
    }

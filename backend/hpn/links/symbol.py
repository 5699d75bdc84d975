"""One input: its symbol in links, its place in the application, and how the form shows it."""

from collections.abc import Mapping
from dataclasses import dataclass, field

from hpn.catalogue import Catalogue
from hpn.tables.numbers import Kind
from hpn.words.quantities import INPUTS, QUANTITIES
from hpn.words.units import suffix_of
from hpn.words.wording import Named

MOTION_PATH = ("duty_cycle", "motion")
"""Place of a motion in the application."""


@dataclass(frozen=True, slots=True)
class Symbol:
    """A query name, the field of the application that it stands for, and what the form says beside it.

    A number `by_size` is one for all sizes, or one for each of some, repeated in links. `choices` are the codes of a
    text, the first being what counts where none is given. `offered` is a figure of the gears whose values are offered
    while typing, or such values themselves. `supplied` names the table of the catalogue without which a choice is not
    offered.
    """

    name: str
    path: tuple[str, ...]
    kind: Kind = "number"
    many: bool = False
    choices: Mapping[str, str] = field(default_factory=dict)
    supplied: Mapping[str, str] = field(default_factory=dict)
    placeholder: str = ""
    hint: str = ""
    offered: str | tuple[float, ...] = ()

    @property
    def place(self) -> str:
        """Its place as `hpn.words.quantities` names it."""
        if self.path[:2] == MOTION_PATH:
            return ".".join(self.path[1:])
        if self.path[0] == "body":
            return ".".join(self.path)
        return ".".join(self.path if len(self.path) > 1 or self.path[0] in INPUTS else ("phase", *self.path))

    def is_offered(self, choice: str, catalogue: Catalogue) -> bool:
        """True for a choice that is of use with a catalogue; a link that asks for another is read all the same."""
        return choice not in self.supplied or bool(getattr(catalogue, self.supplied[choice]))

    @property
    def named(self) -> Named:
        """Its name and its sign."""
        return QUANTITIES[self.place]

    @property
    def unit(self) -> str:
        """Suffix of its unit, blank for a pure number or a text."""
        return suffix_of(self.path[-1])

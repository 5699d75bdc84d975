"""Texts of the page that a refusal gives, to be translated where they are shown."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

from hpn.wording import N_, Quantity

__all__ = ["N_", "Message"]


@dataclass(frozen=True)
class Message:
    """A text to be translated when shown, with the values that go into it."""

    template: str
    values: Mapping[str, str | Quantity] = field(default_factory=dict)

    def text(self, translate: Callable[[str], str], show: Callable[[Quantity], str] = str) -> str:
        """The text in a language, and in the units that `show` writes."""
        template = translate(self.template)
        if not self.values:
            return template
        return template % {
            name: show(value) if isinstance(value, Quantity) else value for name, value in self.values.items()
        }

    def __str__(self) -> str:
        return self.text(str)

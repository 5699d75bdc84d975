"""Title and description that a link to a selection unfolds into, for the head of a page and for oEmbed."""

from dataclasses import dataclass
from urllib.parse import urlencode

from hpn.engine.selection import Selection
from hpn.files.export import DIGITS
from hpn.words.reader import Reader

LONGEST_PATH = 2000
"""Length of a link from which a page doesn't carry it a second time."""


@dataclass(frozen=True, slots=True)
class Preview:
    """Title and description of a result, and where its oEmbed stands; empty for a very long link."""

    title: str
    description: str
    oembed: str


def preview_of(selection: Selection, path: str, title: str | None = None) -> Preview:
    """Gear and verdict of a selection that stands at a path of this service."""
    best, duty, english = selection.foremost, selection.duty, Reader(digits=DIGITS)
    verdict = f"{selection.selected}, suitable" if selection.selected else "no suitable gear"
    parts = [
        f"Average torque {english.figure(duty.average_torque_Nm)} Nm",
        f"largest torque {english.figure(duty.maximum_torque_Nm)} Nm",
        f"average speed {english.figure(duty.average_output_speed_rpm)} rpm",
    ]
    if duty.load_inertia_kgm2 is not None:
        inertia = english.figure(duty.load_inertia_kgm2)
        parts.append(f"motion of {len(duty.phases)} load phases, load inertia {inertia} kg·m²")
    parts.append(f"{best.designation}: {best.reason.removesuffix('.')}")
    address = "/oembed?" + urlencode({"url": path, "format": "json"}) if len(path) <= LONGEST_PATH else ""
    return Preview(f"{title}: {verdict}" if title else f"HPN Select: {verdict}", ", ".join(parts) + ".", address)

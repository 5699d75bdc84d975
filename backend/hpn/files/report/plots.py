"""Drawings of the page in the colours of the report."""

import re
from typing import Any

from hpn.explain.drawings import Pictures, Plane, Subject, chart, cycle_picture
from hpn.explain.drawings.chart import PAPER
from hpn.explain.drawings.svg import STYLE, markup
from hpn.files.export import Export
from hpn.words.reader import Reader
from hpn.words.symbols import sentence
from hpn.words.wording import N_

COLOURS = {
    "ink": "#15171b",
    "muted": "#5f656f",
    "line": "#dcdcd6",
    "edge": "#868b93",
    "card": "#ffffff",
    "sunken": "#f1f1ec",
    "area": "#f3f3f1",
    "governing": "#0b46c6",
    "governing-soft": "#e9effd",
    "on-governing": "#ffffff",
    "pass": "#17713c",
    "fail": "#b2241c",
    "strong": "bold",
}
"""Colours of the page's tokens on paper: those of the light theme."""

ON_PAPER = 'text { font-size: 13px; font-family: "HPN Sans" }\n' + re.sub(
    r"var\(--([\w-]+)\)", lambda token: COLOURS[token[1]], STYLE.read_text(encoding="utf-8")
)
"""Style sheet of a drawing in the report."""


def pictures_of(export: Export, reader: Reader) -> Pictures | None:
    """Pictures of the reported gear as on the page; None where its limits are not at hand."""
    gear = export.gear(export.candidate)
    if gear is None or export.figures is None:
        return None
    subject = Subject(export.application, gear, export.figures, export.candidate)
    return Pictures(subject, export.candidate, reader)


def cycle(export: Export, pictures: Pictures | None, reader: Reader) -> dict[str, str]:
    """Drawing of the cycle or motion over time as on the page, without limits where the gear's are not at hand."""
    picture = pictures.cycle if pictures else cycle_picture(export.application, None, reader)
    return {
        "drawing": markup(picture.drawing, ON_PAPER),
        "alt": " ".join(reader.sentence(one) for one in picture.words),
        "note": reader.sentence(picture.note) if picture.note else "",
    }


def planes(export: Export, pictures: Pictures | None, reader: Reader, left_out: str) -> list[dict[str, Any]]:
    """Planes of torque against speed of gear and motor as on the page, where a motion or a motor is given.

    `left_out` is the sentence about the parts that torques at the motor leave out.
    """
    if pictures is None:
        return []
    if export.application.requirements.motor is None and export.application.duty_cycle.motion is None:
        return []
    output = _plane(N_("Torque and speed at the gear’s output"), pictures.gear_plane, reader)
    motor = _plane(N_("Torque and speed at the motor"), pictures.motor_plane, reader)
    return [output, motor | {"words": [*motor["words"], " " + left_out]}]


def _plane(title: str, plane: Plane, reader: Reader) -> dict[str, Any]:
    words = " ".join(reader.sentence(one) for one in plane.words)
    return {
        "title": reader.text(title),
        "drawing": markup(plane.drawing, ON_PAPER),
        "words": sentence(words),
        "alt": words,
    }


def envelope(pictures: Pictures | None, reader: Reader) -> dict[str, Any] | None:
    """Drawing of the output bearing as on the page, and its condition; None where the bearing is not rated."""
    if pictures is None or pictures.bearing is None:
        return None
    return {
        "drawing": markup(chart(pictures.envelope_scene, reader, PAPER), ON_PAPER),
        "condition": sentence(reader.sentence(pictures.bearing.condition)),
    }

"""The page's drawings in the colours of the report."""

import re
from typing import Any

from hpn.explain.drawings import (
    Plane,
    Subject,
    bearing_picture,
    chart,
    cycle_picture,
    envelope_scene,
    gear_plane,
    governing_phases,
    motor_plane,
)
from hpn.explain.drawings.chart import PAPER
from hpn.explain.drawings.svg import STYLE, markup
from hpn.files.export import Export
from hpn.words.reader import Reader
from hpn.words.symbols import sentence
from hpn.words.wording import N_

LIFE = "output_bearing_life"

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
"""The page's tokens on paper: those of the light theme."""

ON_PAPER = 'text { font-size: 13px; font-family: "HPN Sans" }\n' + re.sub(
    r"var\(--([\w-]+)\)", lambda token: COLOURS[token[1]], STYLE.read_text(encoding="utf-8")
)
"""Style sheet of a drawing in the report."""

# --- The cycle over time ----------------------------------------------------------------------------------------------


def cycle(export: Export, reader: Reader) -> dict[str, str]:
    """The page's drawing of the cycle or motion over time, without limits where the gear's are not at hand."""
    gear, application = export.gear(export.candidate), export.application
    subject = None
    if gear is not None and export.figures is not None:
        subject = Subject(application, gear, export.figures)
    governing = governing_phases(subject, export.candidate.governing_check, None) if subject else ()
    picture = cycle_picture(application, subject, reader, governing, export.candidate.governing_check)
    return {
        "drawing": markup(picture.drawing, ON_PAPER),
        "alt": " ".join(reader.told(one) for one in picture.words),
        "note": reader.told(picture.note) if picture.note else "",
    }


# --- Torque against speed ---------------------------------------------------------------------------------------------


def planes(export: Export, reader: Reader, left_out: str) -> list[dict[str, Any]]:
    """The page's planes of gear and motor, where a motion or a motor is given and the gear's limits are at hand.

    `left_out` is what torques at the motor leave out.
    """
    gear, application = export.gear(export.candidate), export.application
    if gear is None or export.figures is None:
        return []
    if application.requirements.motor is None and application.duty_cycle.motion is None:
        return []
    subject = Subject(application, gear, export.figures)
    governing = governing_phases(subject, export.candidate.governing_check, None)
    output = _plane(N_("Torque and speed at the gear’s output"), gear_plane(subject, reader, governing), reader)
    motor = _plane(N_("Torque and speed at the motor"), motor_plane(subject, reader, governing), reader)
    return [output, motor | {"words": [*motor["words"], " " + left_out]}]


def _plane(title: str, plane: Plane, reader: Reader) -> dict[str, Any]:
    words = " ".join(reader.told(one) for one in plane.words)
    return {
        "title": reader.text(title),
        "drawing": markup(plane.drawing, ON_PAPER),
        "words": sentence(words),
        "alt": words,
    }


# --- The output bearing -----------------------------------------------------------------------------------------------


def envelope(export: Export, reader: Reader) -> dict[str, Any] | None:
    """The drawing of the page in the colours of the report, and its condition; None without the gear's limits."""
    gear, application = export.gear(export.candidate), export.application
    if gear is None or export.figures is None:
        return None
    subject = Subject(application, gear, export.figures)
    picture = bearing_picture(subject, export.candidate.check(LIFE))
    if picture is None:
        return None
    check = export.candidate.governing_check
    governing = governing_phases(subject, check, picture)
    return {
        "drawing": markup(chart(envelope_scene(picture, reader, governing, check), reader, PAPER), ON_PAPER),
        "condition": sentence(reader.told(picture.condition)),
    }

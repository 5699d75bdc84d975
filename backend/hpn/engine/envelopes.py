"""Load envelopes of a size's output bearing for a requested speed, life and load coefficient."""

from dataclasses import dataclass
from typing import Annotated

from pydantic import Field

from hpn.application import BearingModel, InputError
from hpn.catalogue import Catalogue
from hpn.catalogue.gear import Gear
from hpn.physics import bearing
from hpn.words.fields import Model
from hpn.words.quantities import ENVELOPE
from hpn.words.reply import described
from hpn.words.wording import Sentence


class EnvelopeQuery(Model):
    """Condition of the life envelopes, from a query, so that numbers come as text."""

    speed_rpm: Annotated[float, Field(gt=0, le=1e6, allow_inf_nan=False)] = Field(
        100.0, description="Average output speed, pause included."
    )
    life_h: Annotated[float, Field(gt=0, le=5e9, allow_inf_nan=False)] = Field(
        20_000.0, description="Required life of the output bearing as L50."
    )
    load_coefficient: Annotated[float, Field(ge=1, le=3, allow_inf_nan=False)] = Field(
        1.0, description="Load coefficient f_w of a further curve, beside the printed 1, 1.2 and 1.5."
    )
    model: BearingModel = Field("linear", description="Model of the envelope between the two published limits.")


@dataclass(frozen=True, slots=True)
class EnvelopeCurve:
    """Corner points of one envelope, from the axial to the radial axis."""

    __pydantic_config__ = described(ENVELOPE)

    load_coefficient: float
    radial_N: Annotated[list[float], Field(min_length=2)]
    axial_N: Annotated[list[float], Field(min_length=2)]


def life_envelopes(catalogue: Catalogue, gear: Gear, query: EnvelopeQuery) -> list[EnvelopeCurve]:
    """Envelopes of a constant load at the query's speed and life, for f_w = 1, 1.2, 1.5 and the query's own.

    The published envelope times min(1, k) / f_w: slower running never enlarges it. Raises InputError for a size without
    published limits, or without curve points for the digitised model.
    """
    speed, life = catalogue.bearing_reference
    k = bearing.life_factor(
        average_output_speed_rpm=query.speed_rpm,
        required_life_L50_h=query.life_h,
        reference_speed_rpm=speed,
        reference_life_h=life,
    )
    return envelopes_for(catalogue, gear, query.model, query.load_coefficient, float(k))


def envelopes_for(
    catalogue: Catalogue, gear: Gear, model: BearingModel, load_coefficient: float, life_factor: float
) -> list[EnvelopeCurve]:
    """Envelopes for a known life factor k."""
    coefficients = dict.fromkeys((*bearing.PRINTED_LOAD_COEFFICIENTS, load_coefficient))
    return [envelope_curve(catalogue, gear, model, f_w, min(1.0, life_factor)) for f_w in coefficients]


def has_envelope(catalogue: Catalogue, gear: Gear, model: BearingModel) -> bool:
    """True for a size with published limits, or for the digitised model with points of its curve."""
    if model == "digitised":
        return gear.size in catalogue.curves
    return gear.dynamic_radial_load_N is not None and gear.dynamic_axial_load_N is not None


def envelope_curve(
    catalogue: Catalogue, gear: Gear, model: BearingModel, load_coefficient: float, factor: float = 1.0
) -> EnvelopeCurve:
    """Envelope of one size: the published one times `factor` / f_w. Raises InputError as `life_envelopes` does."""
    curve = catalogue.curves.get(gear.size)
    if model == "digitised" and curve is None:
        raise InputError(
            (
                ("model",),
                Sentence(
                    "there are no curve points of {name}: enter them in bearing_envelopes.csv of a catalogue "
                    "supplement",
                    {"name": gear.name},
                ),
            )
        )
    radial_limit, axial_limit = gear.dynamic_radial_load_N, gear.dynamic_axial_load_N
    if model != "digitised" and (radial_limit is None or axial_limit is None):
        unpublished = Sentence(
            "the bearing limits of {name} are not in this catalogue’s source, so it has no envelope",
            {"name": gear.name},
        )
        raise InputError((("size",), unpublished))
    radial, axial = bearing.envelope(
        model=model,
        radial_limit_N=radial_limit or 0.0,  # without effect along supplied points
        axial_limit_N=axial_limit or 0.0,
        curve=curve,
        factor=factor / load_coefficient,
    )
    return EnvelopeCurve(load_coefficient, radial.tolist(), axial.tolist())

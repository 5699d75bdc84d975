"""The drawings of load envelopes: of one gear under an application, of all sizes, and of a gear in the catalogue."""

from collections.abc import Sequence
from dataclasses import dataclass
from xml.etree.ElementTree import Element

from hpn.catalogue import Catalogue
from hpn.catalogue.gear import Gear
from hpn.engine.envelopes import EnvelopeCurve, EnvelopeQuery, envelope_curve, has_envelope, life_envelopes
from hpn.explain.drawings.chart import LAST, MOST_NUMBERS, LimitCurve, Mark, Scene, chart
from hpn.explain.drawings.picture import BearingPicture, PhaseLoad, beyond_limit
from hpn.explain.drawings.sizes import SizeUse
from hpn.explain.drawings.svg import Point
from hpn.explain.drawings.words import coefficient_name, disc_label, share
from hpn.words.reader import DEFAULT, Reader
from hpn.words.wording import N_, Quantity, Sentence, Value


def envelope_scene(
    picture: BearingPicture, reader: Reader = DEFAULT, governing: Sequence[int] = (), check: str | None = None
) -> Scene:
    """Envelopes and loads of one gear; the `governing` phases and the governing check's limit stand out."""
    accent = {check: " governing"}
    lines = []
    for named in picture.named_curves:
        f_w = coefficient_name(named.curve.load_coefficient, reader)
        kind, label = {
            "own": ("limit" + accent.get("output_bearing_life", ""), f"{reader.text(N_('limit now'))}, {f_w}"),
            "life": ("coefficient", f_w),
            "published": ("single" + accent.get("output_bearing_load", ""), reader.text(N_("single load"))),
            "equivalent": ("", ""),
        }[named.kind]
        if named.kind == "published" and not (picture.life_factor < 1 and picture.loads):
            continue
        if kind:
            text, strong = reader.sentence(named.name), named.kind == "own"
            lines.append(LimitCurve(kind, label, named.corners, strong, text, named.curve.load_coefficient))
    if not picture.loads:
        return Scene(lines, [])
    marks, worst, ray = _marks(picture, governing, reader, judged=True), picture.worst, None
    if picture.mean > 0:
        marks.append(_equivalent(picture, reader))
        edge = min(worst.allowed / worst.published, 1e6)
        ray = (worst.radial_N, worst.axial_N), (edge * worst.radial_N, edge * worst.axial_N)
    return Scene(lines, marks, ray, levers=_levers(picture))


def sizes_scene(
    uses: Sequence[SizeUse], picture: BearingPicture, reader: Reader = DEFAULT, governing: Sequence[int] = ()
) -> Scene:
    """Permissible constant load of each size, with the loads of the phases; the gear's own size stands out."""
    lines = []
    for place, use in enumerate(uses):
        if use.curve is not None:
            corners = _corners(use.curve)
            own = use.gear.size == picture.gear.size
            kind = "limit" if own else f"size s{place % 4}"
            lines.append(LimitCurve(kind, use.gear.size, corners, own, use.gear.name, use.curve.load_coefficient))
    return Scene(lines, _marks(picture, governing, reader, judged=False), levers=_levers(picture))


@dataclass(frozen=True, slots=True)
class GearEnvelope:
    """Envelopes of a gear for f_w = 1, 1.2, 1.5 and the requested one, and the largest single load.

    `supplied` is True if they follow points of a supplement.
    """

    curves: list[EnvelopeCurve]
    supplied: bool
    drawing: Element


def published_condition(catalogue: Catalogue, gear: Gear) -> EnvelopeQuery:
    """Condition of the published limits, with the digitised model where the gear's curve is known."""
    speed, life = catalogue.bearing_reference
    return EnvelopeQuery(speed_rpm=speed, life_h=life, model="digitised" if gear.size in catalogue.curves else "linear")


def gear_envelope(
    catalogue: Catalogue, gear: Gear, query: EnvelopeQuery, reader: Reader = DEFAULT
) -> GearEnvelope | None:
    """Envelopes of a gear at a speed and life, or None if its limits are not published."""
    if not has_envelope(catalogue, gear, query.model):
        return None
    curves = life_envelopes(catalogue, gear, query)
    own = next(curve for curve in curves if curve.load_coefficient == query.load_coefficient)
    single = envelope_curve(catalogue, gear, query.model, 1.0)
    f_w = coefficient_name(own.load_coefficient, reader)
    lines = [LimitCurve("limit", f"{reader.text(N_('constant load'))}, {f_w}", _corners(own), strong=True)]
    lines += [
        LimitCurve("coefficient", coefficient_name(curve.load_coefficient, reader), _corners(curve))
        for curve in curves
        if curve is not own and _corners(curve) != _corners(single)
    ]
    if _corners(single) != _corners(own):
        lines.append(LimitCurve("single", reader.text(N_("single load")), _corners(single)))
    return GearEnvelope(curves, query.model == "digitised", chart(Scene(lines, []), reader))


def _corners(curve: EnvelopeCurve) -> list[Point]:
    return list(zip(curve.radial_N, curve.axial_N, strict=True))


# --- Loads ------------------------------------------------------------------------------------------------------------


def _marks(picture: BearingPicture, governing: Sequence[int], reader: Reader, *, judged: bool) -> list[Mark]:
    """The loads, numbered if near to their limit; with `judged` by the limit of the picture's gear."""
    order = sorted(range(len(picture.loads)), key=lambda place: -picture.loads[place].published)
    numbered = set(order[:MOST_NUMBERS])
    marks = []
    for at, load in enumerate(picture.loads):
        place, outside = (load.radial_N, load.axial_N), judged and load.is_outside
        kind = "load governing" if set(governing) & set(load.places) else "load"
        if load.has_lever:
            marks.append(Mark("given", "", (load.given_N, load.axial_N), "", LAST))
        label, text = disc_label(load.places) if at in numbered else "", _told_of(load, outside, reader)
        marks.append(Mark(kind, label, place, text, load.published, outside, load.marked))
    return marks


def _levers(picture: BearingPicture) -> list[tuple[Point, Point]]:
    """Lines from loads at their own places to their equivalents at the shaft's centre."""
    return [((load.given_N, load.axial_N), (load.radial_N, load.axial_N)) for load in picture.loads if load.has_lever]


def _told_of(load: PhaseLoad, outside: bool, reader: Reader) -> str:
    values: dict[str, Value] = {
        "phases": load.spoken,
        "radial": Quantity(load.radial_N, "N", 4),
        "axial": Quantity(load.axial_N, "N", 4),
        "used": share(load.published, load.allowed),
    }
    if load.has_lever:
        term = {"given": Quantity(load.given_N, "N", 4)}
        text = reader.sentence(Sentence(LEVER, values | term))
    else:
        text = reader.sentence(
            Sentence("Phase {phases}: radial {radial}, axial {axial}, {used} of the published maximum", values)
        )
    return f"{text}, {reader.text(N_('outside the limit'))}" if outside else text


LEVER = N_(
    "Phase {phases}: radial {given} where it acts, {radial} at the shaft’s centre, axial {axial}, {used} of the "
    "published maximum"
)


def _equivalent(picture: BearingPicture, reader: Reader) -> Mark:
    outside = beyond_limit(picture.constant_load_utilisation, picture.allowed)
    text = reader.sentence(
        Sentence(
            "Equivalent load of the cycle: {used} of the permissible constant load",
            {"used": share(picture.constant_load_utilisation, picture.allowed)},
        )
    )
    if outside:
        text += ", " + reader.text(N_("outside the limit"))
    return Mark("equivalent", "P_m", picture.equivalent_N, text, LAST, outside)

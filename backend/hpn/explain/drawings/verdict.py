"""The verdict on the output bearing in words."""

from hpn.explain.drawings.picture import BearingPicture, beyond_limit
from hpn.explain.drawings.words import phase_numbers, share
from hpn.words.wording import Quantity, Sentence, Value


def carries(picture: BearingPicture) -> bool:
    """True where single loads and life stay within the allowed share."""
    return not beyond_limit(_most_used(picture), picture.allowed)


def _most_used(picture: BearingPicture) -> float:
    return max(picture.worst.published, picture.life_utilisation)


def bearing_verdict(picture: BearingPicture) -> Sentence:
    """Verdict on the loads, with a text of its own if they exceed only the user's u."""
    if picture.allowed == 1:
        if carries(picture):
            return Sentence("The output bearing carries these loads.")
        return Sentence("The output bearing does not carry these loads.")
    values: dict[str, Value] = {"allowed": Quantity(100 * picture.allowed, "percent", 6)}
    if carries(picture):
        return Sentence("The output bearing carries these loads within u = {allowed}.", values)
    if beyond_limit(_most_used(picture), 1.0):
        return Sentence("The output bearing does not carry these loads, even without u = {allowed}.", values)
    return Sentence(
        "The loads exceed u = {allowed}: they use {used} of the permissible load of the output bearing.",
        values | {"used": share(_most_used(picture), picture.allowed)},
    )


def bearing_words(picture: BearingPicture) -> list[Sentence]:
    """The governing limit, both utilisations, and the phases outside."""
    governs = (
        Sentence("Bearing life decides.") if picture.life_governs else Sentence("The largest single load decides.")
    )
    values: dict[str, Value] = {
        "used": share(picture.constant_load_utilisation, picture.allowed),
        "by_life": share(picture.life_utilisation, picture.allowed),
        "speed": Quantity(picture.average_output_speed_rpm, "rpm"),
        "life": Quantity(picture.load.life_h, "h", 6),
        "basis": picture.load.life_basis,
    }
    # Where k is above 1, the published maximum is below the constant load with this life.
    of_both = Sentence(
        "Equivalent load: {by_life} of the constant load with the required life ({speed}, {life}, {basis}), "
        "{used} of the published maximum.",
        values,
    )
    of_one = Sentence("Equivalent load: {used} of the permissible constant load ({speed}, {life}, {basis}).", values)
    equivalent = of_both if picture.life_factor > 1 else of_one
    return [governs, equivalent, _largest(picture), *_outside(picture)]


def _largest(picture: BearingPicture) -> Sentence:
    used: dict[str, Value] = {"used": share(picture.worst.published, picture.allowed)}
    if len(picture.loads) == 1:
        return Sentence("Single load: {used} of the published maximum.", used)
    return Sentence(
        "Largest single load: {used} of the published maximum (phase {phases}).",
        used | {"phases": picture.worst.spoken},
    )


def _outside(picture: BearingPicture) -> list[Sentence]:
    places = sorted(place for load in picture.loads if load.is_outside for place in load.places)
    if not places or len(picture.loads) == 1:
        return []
    return [Sentence("Outside the limit of a single load: phase {phases}.", {"phases": phase_numbers(places)})]

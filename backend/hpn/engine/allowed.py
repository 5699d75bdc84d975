"""Gears that an application allows, and its motor, looked up in the catalogue."""

from collections.abc import Sequence
from functools import lru_cache

from hpn.application import LISTED_FIGURES, Application, InputError, Location, OutputLoad
from hpn.application.shaft_centre import by_size
from hpn.catalogue import Catalogue, GearList
from hpn.words.designations import OTHERS
from hpn.words.likeness import likeness
from hpn.words.terms import FOR_OTHERS
from hpn.words.wording import N_, Sentence, Value, first_of, listed

NOT_THERE = N_("the catalogue has no {value} (available: {listed})")
LOOKS_LIKE = N_("the catalogue has no {value}; it looks like {near} (available: {listed})")
NOT_TOGETHER = N_("there is no gear of this size and ratio (available: {offered})")

MOTORS_NAMED = 20
"""Motors, at most, that an error names."""

SIZES_NAMED, LONGEST = 20, 40
"""Unknown sizes, at most, that an error names, and characters of each."""


def gears_for(application: Application, catalogue: Catalogue) -> GearList:
    """Gears that an application allows; raises InputError as `select` does."""
    requirements, load = application.requirements, application.output_load
    if load is not None:
        _require_sizes_of_centres(load, catalogue)
    return gears_allowed(requirements.sizes, requirements.ratios, load.model if load else "", catalogue)


def gears_allowed(
    sizes: tuple[str, ...] | None, ratios: tuple[int, ...] | None, bearing_model: str, catalogue: Catalogue
) -> GearList:
    """Gears that `sizes` and `ratios` leave; raises InputError as `select` does."""
    gears = _restricted(catalogue, sizes, ratios)
    if bearing_model == "digitised" and not any(gears.curves):
        raise InputError(
            (
                ("output_load", "model"),
                Sentence(
                    "no candidate has points of a printed curve: enter them in bearing_envelopes.csv of a catalogue "
                    "supplement (setting HPN_CATALOGUE_SUPPLEMENT), or choose linear or iso281"
                ),
            )
        )
    return gears


def _require_sizes_of_centres(load: OutputLoad, catalogue: Catalogue) -> None:
    """Raise InputError for a shaft's centre of a size that the catalogue lacks."""
    there = catalogue.sizes
    strange = [size for size in by_size(load.shaft_centre_mm) if size not in there]
    if strange:
        raise InputError(
            *((("output_load", "shaft_centre_mm", size), _none_such(size, there)) for size in strange[:SIZES_NAMED])
        )


def _none_such(size: str, there: Sequence[str]) -> Sentence:
    near = likeness(size, (OTHERS,))  # not among sizes: they differ by a digit, so each is as likely
    sizes = [*(Sentence("{text}", {"text": each}) for each in there), Sentence(FOR_OTHERS)]
    values: dict[str, Value] = {"value": size[:LONGEST], "listed": listed(sizes)}
    return Sentence(LOOKS_LIKE, {**values, "near": near}, ("near",)) if near else Sentence(NOT_THERE, values)


@lru_cache(maxsize=256)
def _restricted(catalogue: Catalogue, sizes: tuple[str, ...] | None, ratios: tuple[int, ...] | None) -> GearList:
    for names, there in ((sizes, catalogue.sizes), (ratios, catalogue.ratios)):
        if names is not None and not set(there).issuperset(names):
            raise _not_there(sizes or (), ratios or (), catalogue)
    gears = catalogue.restricted(sizes, ratios)
    if not gears.rows:
        offered = "; ".join(
            f"{size}: {', '.join(str(gear.ratio) for gear in catalogue.gears if gear.size == size)}"
            for size in dict.fromkeys(sizes or ())
        )
        raise InputError(
            (
                ("requirements", "ratios"),
                Sentence(NOT_TOGETHER, {"offered": offered}),
            )
        )
    return gears


@lru_cache(maxsize=256)
def gears_left_out(gears: GearList, catalogue: Catalogue) -> GearList:
    """Gears of the catalogue without some of them, in its order; may be empty."""
    allowed = {gear.designation for gear in gears.rows}
    return catalogue.listed(gear for gear in catalogue.gears if gear.designation not in allowed)


def _not_there(sizes: Sequence[str], ratios: Sequence[int], catalogue: Catalogue) -> InputError:
    problems: list[tuple[Location, Sentence]] = [
        (
            ("requirements", name, index),
            Sentence(NOT_THERE, {"value": str(value), "listed": ", ".join(map(str, there))}),
        )
        for name, names, there in (("sizes", sizes, catalogue.sizes), ("ratios", ratios, catalogue.ratios))
        for index, value in enumerate(names)
        if value not in there
    ]
    return InputError(*problems)


def with_listed_motor(application: Application, catalogue: Catalogue) -> Application:
    """The application with the figures of its listed motor.

    Raises InputError for an unlisted motor, and for a motor without the inertia that an inertia ratio needs.
    """
    typed = application.requirements.motor
    if typed is None or typed.designation is None:
        return application
    place = ("requirements", "motor", "designation")
    listed = catalogue.motor_by_designation.get(typed.designation)
    if listed is None:
        names = list(catalogue.motor_by_designation)
        if not names:
            raise InputError(
                (place, Sentence(N_("there are no motors: list them in motors.csv of a catalogue supplement")))
            )
        values: dict[str, Value] = {"value": typed.designation, "listed": first_of(names, MOTORS_NAMED)}
        raise InputError((place, Sentence(NOT_THERE, values)))
    if typed.inertia_ratio is not None and listed.inertia_kgm2 is None:
        raise InputError(
            (place, Sentence(N_("inertia_ratio needs the inertia of this motor, which motors.csv does not give")))
        )
    motor = typed.model_copy(update={name: getattr(listed, name) for name in LISTED_FIGURES})
    return application.requiring(motor=motor)

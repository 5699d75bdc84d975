"""What the reader of a result must know beyond its numbers: assumptions, standings, unlimited values."""

from dataclasses import dataclass
from functools import cached_property, lru_cache

from hpn.catalogue import Catalogue, GearList
from hpn.checks import BEARING_L50, L10, PEAKS, Evaluation
from hpn.duty import T_MAX
from hpn.gear import Gear
from hpn.wording import N_, Quantity, Sentence, Value


@dataclass(frozen=True)
class Notice:
    """A note on the result, with a code for programs and a sentence for people."""

    code: str
    sentence: Sentence

    @cached_property
    def text(self) -> str:
        """The notice in English."""
        return self.sentence.text


def _notice(code: str, template: str, translated: tuple[str, ...] = (), **values: Value) -> Notice:
    return Notice(code, Sentence(template, values, translated))


_COUNT_UNLIMITED = _notice(
    "momentary_peak_count_unlimited",
    "Where the emergency-stop torque is at or below T_R, equation 17.9 sets no limit to the number of stops: the "
    "allowed number is empty there.",
)
_LIFE_UNLIMITED = _notice(
    "life_unlimited",
    "The average torque is 0 or so small that equation 17.10 gives a life without limit: the life is empty.",
)
_SUPPLIED = _notice("bearing_envelope_supplied", "The output bearing is judged along curve points that you supplied.")
_COMPUTED = _notice(
    "bearing_envelope_computed",
    "The envelope of the output bearing is computed between the two published limits; the handbook's printed curve was "
    "not available.",
)
_LOAD_POSITION = _notice(
    "bearing_load_position",
    "Loads act at the centre of the output shaft and along its axis; a load that acts elsewhere can't be judged from "
    "the published data.",
)
_LIFE_BASIS = _notice(
    "bearing_life_basis",
    "Bearing life L10 = L50 / 5 is the relation of the maker's other handbooks, not printed in this one; a Weibull "
    "slope of 10/9 gives 5.45.",
)
_BEARING_UNLIMITED = _notice(
    "bearing_life_unlimited",
    "The equivalent load of the moving phases is 0 or so small that the bearing life has no limit: it is empty.",
)
_EFFICIENCY_SUPPLIED = _notice(
    "efficiency_supplied",
    "Motor torques use the efficiency curves that you supplied; where they say nothing, loss-free: a lower bound.",
)
_EFFICIENCY_UNKNOWN = _notice(
    "efficiency_unknown",
    "Motor torques are loss-free, a lower bound: the handbook's efficiency curves were not available and no efficiency "
    "is stated.",
)
_SUPPLEMENT = _notice("catalogue_supplement", "Some catalogue figures are supplied by the user; their sources say so.")

AREAS = {
    "aerospace": N_("aerospace"),
    "explosive_area": N_("areas at risk of explosion"),
    "nuclear": N_("machines for a nuclear purpose"),
    "vacuum": N_("vacuum"),
    "household": N_("household devices"),
    "medical": N_("medical equipment"),
    "human_contact": N_("devices that interact directly with the human body"),
    "people_transport": N_("machines for transporting or lifting people"),
    "amusement": N_("devices for funfairs and leisure parks"),
}
"""Application areas of section 2.4 by their code; English msgids."""


def notices_of(evaluation: Evaluation, index: int) -> list[Notice]:
    """Notices on application `index` of an evaluation, most general last."""
    application, catalogue = evaluation.duty.applications[index], evaluation.catalogue
    stop, load, asked = application.emergency_stop, evaluation.duty.loads[index], application.requirements
    unlimited = evaluation.unlimited[index].tolist()
    notices = []
    if application.application_area is not None:
        notices.append(_area(application.application_area))
    if stop is not None:
        largest = evaluation.duty.figures.item(index, T_MAX)
        if abs(stop.torque_Nm) < largest:
            notices.append(_stop_below(abs(stop.torque_Nm), largest))
    if unlimited[PEAKS]:
        notices.append(_COUNT_UNLIMITED)
    if unlimited[L10]:
        notices.append(_LIFE_UNLIMITED)
    if load is not None:
        notices += _SUPPLIED if load.model == "digitised" else _COMPUTED, _LOAD_POSITION, _LIFE_BASIS
        if unlimited[BEARING_L50]:
            notices.append(_BEARING_UNLIMITED)
    if asked.efficiency is not None:
        notices.append(_efficiency(asked.efficiency))
    elif asked.motor is not None or application.rank_by == "motor_torque":
        notices.append(_EFFICIENCY_SUPPLIED if catalogue.efficiency else _EFFICIENCY_UNKNOWN)
    notices += _unrated(evaluation.gears, catalogue)
    if catalogue.supplement:
        notices.append(_SUPPLEMENT)
    return notices


def _area(code: str) -> Notice:
    return _notice(
        "application_area",
        "Use in this area ({area}) needs a risk assessment and the maker's approval (handbook 2.4).",
        ("area",),
        area=AREAS[code],
    )


def _stop_below(torque_Nm: float, largest_Nm: float) -> Notice:
    return _notice(
        "emergency_stop_below_maximum",
        "The emergency-stop torque of {stop} is below the largest torque of the cycle, {largest}: is "
        "it really the emergency?",
        stop=Quantity(torque_Nm, "Nm", 6),
        largest=Quantity(largest_Nm, "Nm", 6),
    )


def _efficiency(assumed: float) -> Notice:
    return _notice(
        "efficiency_assumed",
        "Motor torques use the efficiency of {efficiency} that you assume.",
        efficiency=Quantity(100 * assumed, "percent"),
    )


@lru_cache(maxsize=256)
def _unrated(gears: GearList, catalogue: Catalogue) -> tuple[Notice, ...]:
    """A notice per size with gears that aren't rated; it names them where a supplement rates others of the size."""
    rated = {gear.name for gear in catalogue.gears if gear.rated_torque_Nm is not None}
    unrated: dict[str, list[Gear]] = {}
    for gear in gears.rows:
        if gear.note and gear.rated_torque_Nm is None:
            unrated.setdefault(gear.name, []).append(gear)
    return tuple(
        _size_unrated([gear.designation for gear in rows] if name in rated else [name], rows[0].note or "")
        for name, rows in unrated.items()
    )


def _size_unrated(names: list[str], note: str) -> Notice:
    if len(names) == 1:
        return _notice("size_unrated", "{name} is not rated. {note}", ("note",), name=names[0], note=note)
    listed = ", ".join(names)
    return _notice("size_unrated", "{names} are not rated. {note}", ("note",), names=listed, note=note)

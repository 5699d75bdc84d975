"""Summary of a document: how many axes are suitable, what their gears weigh, and which axis is closest to its limit."""

from collections import Counter
from collections.abc import Iterable
from typing import Annotated

from pydantic import Field

from hpn.catalogue import Catalogue
from hpn.documents.gears import GearOrder, Placed, gears_of
from hpn.documents.revision import Frozen, FrozenAxis
from hpn.engine.candidates import LifeOf
from hpn.words.reply import Reply


class Summary(Reply, frozen=True):
    """A document in brief."""

    axes: Annotated[int, Field(description="Number of axes.")]
    quantity: Annotated[int, Field(description="Number of axes, each times its quantity.")]
    suitable: Annotated[int, Field(description="Axes whose gear is suitable.")]
    unsuitable: Annotated[int, Field(description="Axes that no gear suits, or not the ordered one.")]
    unrated: Annotated[int, Field(description="Axes whose gear can’t be rated.")]
    open: Annotated[int, Field(description="Axes without an answer.")]
    gears: Annotated[int | None, Field(description="Number of gears to order; null where the catalogue is not kept.")]
    kinds: Annotated[int | None, Field(description="Number of their designations; null likewise.")]
    weight_kg: Annotated[float | None, Field(description="Mass of all gears; null where that of one is not known.")]
    utilisation: Annotated[float | None, Field(description="Largest utilisation of a suitable gear.")]
    utilisation_axis: Annotated[int | None, Field(description="Number of its axis.")]
    shortest_life_h: Annotated[float | None, Field(description="Shortest life of a suitable gear.")]
    shortest_life_of: Annotated[LifeOf | None, Field(description="Life that it is.")]
    shortest_life_axis: Annotated[int | None, Field(description="Number of its axis.")]
    engine_versions: Annotated[tuple[str, ...], Field(description="Versions of the calculation of its answers.")]
    catalogue_versions: Annotated[tuple[str, ...], Field(description="Catalogues of its answers.")]


def gear_of(axis: FrozenAxis) -> str | None:
    """Designation of an axis's gear: that of its ordering code, else the selected one; None for an axis without one."""
    return axis.answer.selected if axis.ordering_code is None else axis.answer.designation


def failing_inside(axes: Iterable[FrozenAxis]) -> tuple[int, ...]:
    """Numbers of the axes whose gear is suitable as given, and does not hold over the whole tolerance."""
    return tuple(axis.number for axis in axes if axis.answer.status == "suitable" and axis.answer.holds is False)


def order_of(axes: Iterable[FrozenAxis], catalogue: Catalogue) -> GearOrder:
    """Gears to order of the axes of a document."""
    placed = (Placed(axis.number, axis.quantity, axis.ordering_code, axis.answer.selected) for axis in axes)
    return gears_of(placed, catalogue)


def summary_of(document: Frozen, catalogue: Catalogue | None) -> Summary:
    """Summary of a document, under the catalogue of its answers where that is kept."""
    axes, order = document.axes, None if catalogue is None else order_of(document.axes, catalogue)
    counts = Counter(axis.answer.status for axis in axes)
    sound = [axis for axis in axes if axis.answer.status == "suitable"]
    most = max(sound, key=lambda axis: axis.answer.utilisation or 0.0, default=None)
    lasting = [(axis.answer.shortest_life_h, axis) for axis in sound if axis.answer.shortest_life_h is not None]
    life_h, shortest = min(lasting, key=lambda pair: pair[0], default=(None, None))
    return Summary(
        axes=len(axes),
        quantity=sum(axis.quantity for axis in axes),
        suitable=counts["suitable"],
        unsuitable=counts["unsuitable"],
        unrated=counts["unrated"],
        open=counts["open"],
        gears=None if order is None else sum(gear.quantity for gear in order.gears),
        kinds=None if order is None else order.kinds,
        weight_kg=None if order is None else order.weight_kg,
        utilisation=most.answer.utilisation if most else None,
        utilisation_axis=most.number if most else None,
        shortest_life_h=life_h,
        shortest_life_of=shortest.answer.shortest_life_of if shortest else None,
        shortest_life_axis=shortest.number if shortest else None,
        engine_versions=tuple(dict.fromkeys(axis.answer.engine_version for axis in axes)),
        catalogue_versions=tuple(dict.fromkeys(axis.answer.catalogue_version for axis in axes)),
    )

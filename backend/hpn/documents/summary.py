"""Summary of a document: numbers of axes by verdict, mass of the gears, and the axis closest to its limit."""

from collections import Counter
from collections.abc import Iterable
from typing import Annotated

from pydantic import Field

from hpn.catalogue import Catalogue
from hpn.documents.gears import GearOrder, OrderAxis, gears_of, motor_of
from hpn.documents.revision import Frozen, FrozenAxis
from hpn.engine.candidates import LifeOf
from hpn.words.reply import Reply


class Summary(Reply, frozen=True):
    """A document in brief."""

    axes: Annotated[int, Field(description="Number of axes.")]
    quantity: Annotated[int, Field(description="Sum of the axes’ quantities.")]
    suitable: Annotated[int, Field(description="Axes whose gear is suitable.")]
    unsuitable: Annotated[
        int, Field(description="Axes without a suitable gear, or whose ordered gear is not suitable.")
    ]
    unrated: Annotated[int, Field(description="Axes whose gear can’t be rated.")]
    open: Annotated[int, Field(description="Axes without an answer.")]
    gears: Annotated[int | None, Field(description="Number of gears to order; null where the catalogue is not kept.")]
    kinds: Annotated[int | None, Field(description="Number of different designations among them; null likewise.")]
    weight_kg: Annotated[
        float | None, Field(description="Mass of all gears; null where the mass of a gear is not known.")
    ]
    utilisation: Annotated[float | None, Field(description="Largest utilisation of a suitable gear.")]
    utilisation_axis: Annotated[int | None, Field(description="Number of the axis with that figure.")]
    shortest_life_h: Annotated[float | None, Field(description="Shortest life of a suitable gear.")]
    shortest_life_of: Annotated[
        LifeOf | None, Field(description="Kind of this life: of gear or bearing, with its basis.")
    ]
    shortest_life_axis: Annotated[int | None, Field(description="Number of the axis with that figure.")]
    engine_versions: Annotated[tuple[str, ...], Field(description="Versions of the calculation in its answers.")]
    catalogue_versions: Annotated[tuple[str, ...], Field(description="Versions of the catalogue in its answers.")]


def gear_of(axis: FrozenAxis) -> str | None:
    """Designation of an axis's gear, from its ordering code or else the selected one; None without a gear."""
    return axis.answer.selected if axis.ordering_code is None else axis.answer.designation


def failing_inside(axes: Iterable[FrozenAxis]) -> tuple[int, ...]:
    """Numbers of the axes whose gear is suitable as given, but not over the whole tolerance."""
    return tuple(axis.number for axis in axes if axis.answer.status == "suitable" and axis.answer.holds is False)


def has_worst_case(axes: Iterable[FrozenAxis]) -> bool:
    """True if an axis has tolerances over which its gear is judged."""
    return any(axis.answer.holds is not None for axis in axes)


def order_of(axes: Iterable[FrozenAxis], catalogue: Catalogue) -> GearOrder:
    """Gears to order of the axes of a document."""
    placed = (
        OrderAxis(axis.number, axis.quantity, axis.ordering_code, axis.answer.selected, motor_of(axis.application))
        for axis in axes
    )
    return gears_of(placed, catalogue)


def summary_of(document: Frozen, catalogue: Catalogue | None) -> Summary:
    """Summary of a document, with the catalogue of its answers where that is kept."""
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

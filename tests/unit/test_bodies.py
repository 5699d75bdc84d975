"""Moments of inertia of bodies against an integration of r² over their volume."""

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from pydantic import ValidationError

from hpn.physics.motion.bodies import Body, bar_inertia, displaced_inertia, ring_inertia, sum_of

NODES, WEIGHTS = np.polynomial.legendre.leggauss(24)

Points = tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]


def over(*ranges: tuple[float, float]) -> list[NDArray[np.float64]]:
    """Nodes of a Gauss-Legendre rule over a box, and their weights, in mm."""
    axes = [(low + high) / 2 + (high - low) / 2 * NODES for low, high in ranges]
    weights = [(high - low) / 2 * WEIGHTS for low, high in ranges]
    return [*np.meshgrid(*axes, indexing="ij"), np.prod(np.meshgrid(*weights, indexing="ij"), axis=0)]


def cylinder(inner: float, outer: float, length: float) -> Points:
    """Points across a cylinder, x and y, and along it, z, with volumes: exact for squares of them."""
    r, phi, z, weight = over((inner, outer), (0, 2 * math.pi), (-length / 2, length / 2))
    return np.stack((r * np.cos(phi), r * np.sin(phi), z)), weight * r, z


def cuboid(length: float, width: float, height: float) -> Points:
    x, y, z, weight = over(*((-side / 2, side / 2) for side in (length, width, height)))
    return np.stack((x, y, z)), weight, z


# Body, its points, and which of their coordinates lie across the axis.
SHAPES: dict[str, tuple[dict[str, float], Callable[[], Points], tuple[int, int]]] = {
    "disc": ({"diameter_mm": 500, "height_mm": 20}, lambda: cylinder(0, 250, 20), (0, 1)),
    "ring": (
        {"diameter_mm": 500, "inner_diameter_mm": 410, "height_mm": 35},
        lambda: cylinder(205, 250, 35),
        (0, 1),
    ),
    "bar": ({"diameter_mm": 40, "length_mm": 700}, lambda: cylinder(0, 20, 700), (0, 2)),
    "block": ({"length_mm": 300, "width_mm": 120, "height_mm": 80}, lambda: cuboid(300, 120, 80), (0, 1)),
}


@pytest.mark.parametrize("shape", SHAPES)
@pytest.mark.parametrize("distance", [0.0, 180.0])
def test_inertia_and_mass_are_integrals_over_the_body(shape: str, distance: float) -> None:
    dimensions, points, (first, second) = SHAPES[shape]
    place, volume, _ = points()
    density = 7.85
    masses = volume * density * 1e-6
    squares = (place[first] + distance) ** 2 + place[second] ** 2

    body = Body.model_validate(
        {"shape": shape, "density_g_per_cm3": density, "distance_mm": distance, "count": 3, **dimensions}
    )

    assert body.total_mass_kg == pytest.approx(3 * masses.sum(), rel=1e-12)
    assert body.inertia_kgm2 == pytest.approx(3 * (masses * squares).sum() * 1e-6, rel=1e-12)


def test_equations_take_arrays() -> None:
    masses = np.array([1.0, 2.0])
    own = ring_inertia(mass_kg=masses, diameter_mm=np.array([200.0, 200.0]), inner_diameter_mm=np.zeros(2))
    assert own == pytest.approx(np.array([0.005, 0.01]))
    moved = displaced_inertia(inertia_kgm2=own, mass_kg=masses, distance_mm=np.full(2, 100.0))
    assert moved == pytest.approx(np.array([0.015, 0.03]))


def test_a_thin_bar_is_a_line() -> None:
    assert bar_inertia(mass_kg=3.0, length_mm=1000.0, diameter_mm=0.0) == pytest.approx(0.25)
    assert Body(shape="bar", mass_kg=3, length_mm=1000).inertia_kgm2 == pytest.approx(0.25)


def test_bodies_are_summed_and_those_off_the_axis_are_one_mass_at_its_mean_distance() -> None:
    table = Body(shape="disc", mass_kg=60, diameter_mm=500)
    fixtures = Body(shape="point_mass", mass_kg=5, distance_mm=180, count=4)
    arm = Body(shape="bar", mass_kg=10, length_mm=300, distance_mm=150)
    total = sum_of([table, fixtures, arm])
    assert total.inertia_kgm2 == pytest.approx(60 * 0.25 / 8 + 20 * 0.18**2 + 10 * (0.09 / 12 + 0.15**2))
    assert (total.mass_kg, total.gravity_mass_kg) == (90, 30)
    assert total.gravity_radius_mm == pytest.approx((20 * 180 + 10 * 150) / 30)
    assert sum_of([table]).gravity_radius_mm is None


@pytest.mark.parametrize(
    ("body", "fields"),
    [
        ({"shape": "disc", "mass_kg": 5}, {"diameter_mm"}),
        ({"shape": "ring", "mass_kg": 5, "diameter_mm": 100, "inner_diameter_mm": 100}, {"inner_diameter_mm"}),
        ({"shape": "disc", "diameter_mm": 100}, {"mass_kg"}),
        ({"shape": "disc", "diameter_mm": 100, "mass_kg": 1, "density_g_per_cm3": 8, "height_mm": 5}, {"mass_kg"}),
        ({"shape": "disc", "diameter_mm": 100, "density_g_per_cm3": 8}, {"height_mm"}),
        ({"shape": "bar", "length_mm": 100, "density_g_per_cm3": 8}, {"diameter_mm"}),
        ({"shape": "block", "mass_kg": 5, "diameter_mm": 9}, {"length_mm", "width_mm", "diameter_mm"}),
        ({"shape": "point_mass", "density_g_per_cm3": 8}, {"density_g_per_cm3"}),
        ({"shape": "point_mass", "mass_kg": 1, "distance_mm": -1}, {"distance_mm"}),
        ({"mass_kg": 1}, {"shape"}),
    ],
)
def test_a_fault_of_a_body_that_lacks_or_has_too_much_stands_at_its_field(
    body: dict[str, Any], fields: set[str]
) -> None:
    with pytest.raises(ValidationError) as refused:
        Body.model_validate(body)
    assert {error["loc"][0] for error in refused.value.errors()} == fields

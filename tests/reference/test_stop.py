"""Stops by the brake as they were worked out by hand and stepped in time beside this project."""

from typing import Any

import pytest

from hpn.catalogue import Catalogue
from tests.build import Json, answer, candidate, cycle, phase

PHASES = phase(40, 250), phase(-40, 250)


def stop_of(catalogue: Catalogue, designation: str, brake: Json, **requirements: Any) -> Json:
    """A gear's entry of the reply on typed phases that a brake stops."""
    count = requirements.pop("count", None)
    stop = {"brake": brake} | ({} if count is None else {"count": count})
    application = cycle(*PHASES, emergency_stop=stop, requirements=requirements)
    return candidate(answer(application, catalogue), designation)


@pytest.mark.parametrize(
    ("pull", "T_k", "course", "largest"),
    [
        ({}, 104.161, (0.572486, 445.170, 287.007), (23.3507, 12.4410)),
        ({"load_torque_Nm": 12}, 112.946, (0.817047, 636.165, 420.245), (22.2727, 11.5017)),
    ],
)
def test_a_swivel_is_stopped_as_worked_out(
    pull: Json, T_k: float, course: tuple[float, ...], largest: tuple[float, ...], catalogue: Catalogue
) -> None:
    """To the six digits that are printed."""
    brake = {"torque_Nm": 8, "reaction_time_s": 0.02, "rise_time_s": 0.005, "speed_rpm": 250} | pull
    inertias = {"load_inertia_kgm2": 0.8, "motor": {"inertia_kgm2": 0.0015}}
    gear = stop_of(catalogue, "HPN-20A-5", brake, **inertias)
    reserve = gear["reserve"]

    assert gear["stop_torque_Nm"] == pytest.approx(T_k, rel=5e-6)
    values = [gear[name] for name in ("stopping_time_s", "stopping_angle_deg", "stop_energy_J")]
    assert values == pytest.approx(list(course), rel=5e-6)
    assert [reserve[name] for name in ("brake_torque_Nm", "brake_torque_repeated_Nm")] == pytest.approx(
        list(largest), rel=5e-6
    )


def test_a_slow_axis_with_losses_is_stopped_as_worked_out(catalogue: Catalogue) -> None:
    brake = {
        **{"torque_Nm": 3, "reaction_time_s": 0.03, "rise_time_s": 0.01, "speed_rpm": 60},
        **{"load_torque_Nm": 20, "opposing_torque_Nm": 25},
    }
    inertias = {"load_inertia_kgm2": 1, "motor": {"inertia_kgm2": 0.0003}, "efficiency": 0.9}
    gear = stop_of(catalogue, "HPN-20A-25", brake, **inertias, count=1)

    assert gear["stop_torque_Nm"] == pytest.approx(203.860, abs=5e-4)
    assert gear["momentary_peak_count"] == 657_093
    values = [gear[name] for name in ("stopping_time_s", "stopping_angle_deg", "stop_energy_J")]
    assert values == pytest.approx([0.187258, 43.0275, 38.4598], rel=5e-6)
    assert gear["reserve"]["brake_torque_Nm"] == pytest.approx(4.06983, abs=5e-6)

"""Motions and phases that vary in the Asset Administration Shell."""

from typing import Any

from basyx.aas import model

from hpn.catalogue import Catalogue
from hpn.files.aas.submodel import environment, package
from tests.report.cases import CASES, MOVING, typed_export_of


def result_of(case: str, catalogue: Catalogue) -> dict[str, Any]:
    """Elements of the selection by name."""
    store = environment(typed_export_of((CASES | MOVING)[case], catalogue))
    [result] = [one for one in store if isinstance(one, model.Submodel) and one.id_short == "SelectionResult"]
    return {element.id_short or "": element for element in result.submodel_element}


def values(collection: Any) -> dict[str, Any]:
    """Values of the properties of a collection by name."""
    return {one.id_short: one.value for one in collection.value if isinstance(one, model.Property)}


def test_a_motion_stands_in_the_shell_with_its_phases(catalogue: Catalogue) -> None:
    elements = result_of("rotary table", catalogue)
    motion = {one.id_short: one for one in elements["Motion"].value}
    assert values(motion["Mechanism"])["inertia_kgm2"] == 0.8
    assert values(motion["Move_1"]) == {
        "profile": "trapezoidal",
        "angle_deg": 90,
        "time_s": 0.8,
        "acceleration_deg_per_s2": 900,
        "name": "turn",
    }
    assert values(elements["Duty"])["load_inertia_kgm2"] == 0.8
    phases = {one.id_short: one for one in elements["Phases"].value}
    assert phases["Count"].value == 8
    names = {one.id_short: one.display_name["de"] for one in phases["Phase_1"].value}
    assert names["peak_torque_Nm"].endswith("[Nm]")
    assert [values(phases[f"Phase_{k}"]).get("name") for k in (1, 3, 4)] == ["turn", "turn", None]


def test_phases_that_vary_stand_there_and_steady_ones_as_before(catalogue: Catalogue) -> None:
    phases = {one.id_short: one for one in result_of("phases that vary", catalogue)["Phases"].value}
    assert values(phases["Phase_1"])["rms_torque_Nm"] == 42
    assert "Phases" not in result_of("example", catalogue)


def test_of_very_many_moves_the_number_stands_there(catalogue: Catalogue) -> None:
    motion = {one.id_short for one in result_of("many moves", catalogue)["Motion"].value}
    assert motion == {"Mechanism", "Count"}
    assert package(typed_export_of(MOVING["many moves"], catalogue))

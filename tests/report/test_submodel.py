"""The Asset Administration Shell, read back by the library that wrote it and verified by another one."""

import hashlib
import subprocess
import sys
from dataclasses import replace
from datetime import UTC, datetime, timedelta, timezone
from functools import cache
from io import BytesIO
from typing import Any
from zipfile import ZipFile

import aas_core3.verification
import aas_core3.xmlization
import aas_core3_1.verification
import aas_core3_1.xmlization
import msgspec
import pytest
from aas_submodel_validate.api import validate
from aas_test_engines.file import check_aasx_file
from basyx.aas import model
from basyx.aas.adapter import aasx

from hpn.account.published import GROUPS, published
from hpn.application import Application
from hpn.catalogue import Catalogue, load_catalogue
from hpn.engine.kept import decode
from hpn.engine.selection import encode
from hpn.files.aas import Metamodel
from hpn.files.aas.submodel import package
from hpn.files.aas.technical import ARTICLE_NUMBER, ORDER_CODE, TECHNICAL_DATA, short_id
from hpn.files.export import DIGITS, LOSS_FREE
from hpn.files.report.pdf import pdf
from hpn.words.reader import Reader
from tests.build import worked_example
from tests.report.cases import CASES, EVERYTHING, MOVING, typed_export_of

Submodels = dict[str, model.Submodel]


def read(content: bytes) -> tuple[Submodels, aasx.DictSupplementaryFileContainer]:
    """Submodels by their short id, and the files beside them; anything amiss raises."""
    store: model.DictIdentifiableStore[model.Identifiable] = model.DictIdentifiableStore()
    files = aasx.DictSupplementaryFileContainer()  # type: ignore[no-untyped-call]
    with aasx.AASXReader(BytesIO(content), failsafe=False) as reader:
        reader.read_into(store, files)
    shells = [item for item in store if isinstance(item, model.AssetAdministrationShell)]
    submodels = {str(item.id_short): item for item in store if isinstance(item, model.Submodel)}
    assert len(shells) == 1
    assert {reference.resolve(store).id_short for reference in shells[0].submodel} == set(submodels)
    return submodels, files


def values(collection: object) -> dict[str, object]:
    """Values of the properties of a collection by name."""
    assert isinstance(collection, model.SubmodelElementCollection)
    return {str(element.id_short): element.value for element in collection if isinstance(element, model.Property)}


@cache
def packed(case: str, metamodel: Metamodel) -> bytes:
    """Package on a case, made once."""
    return package(typed_export_of(CASES[case], load_catalogue()), metamodel)


@pytest.mark.parametrize("case", CASES)
def test_package_says_what_the_reply_says(case: str, catalogue: Catalogue) -> None:
    export = typed_export_of(CASES[case], catalogue)
    submodels, files = read(packed(case, "3.1"))
    result = submodels["SelectionResult"]
    assert values(result.get_referable("Duty")) == msgspec.to_builtins(export.selection.duty)
    checks = result.get_referable("Checks")
    assert isinstance(checks, model.SubmodelElementCollection)
    for check in export.candidate.checks:
        known = {name: value for name, value in msgspec.to_builtins(check).items() if value is not None}
        view = values(checks.get_referable(known.pop("code")))
        assert {name: view[name] for name in known} == known
        assert set(view) <= {*known, "unit"}
    saved = BytesIO()
    files.write_file("/aasx/result.json", saved)
    assert decode(saved.getvalue()) == export.selection
    question = BytesIO()
    files.write_file("/aasx/application.json", question)
    assert Application.model_validate_json(question.getvalue()) == export.application


def test_package_holds_a_saved_reply_to_the_byte(catalogue: Catalogue) -> None:
    """A reply of an earlier version, which lacks fields of today's and has one of its own."""
    export = typed_export_of(EVERYTHING, catalogue)
    reply = msgspec.json.decode(encode(export.selection)) | {"of_then": 1}
    del reply["notices"][0]["values"]
    saved = msgspec.json.encode(reply)
    result = BytesIO()

    read(package(replace(export, selection=decode(saved), reply=saved), "3.1"))[1].write_file(
        "/aasx/result.json", result
    )

    assert result.getvalue() == saved


@pytest.mark.parametrize("case", CASES)
@pytest.mark.parametrize(("metamodel", "core"), [("3.0", aas_core3), ("3.1", aas_core3_1)])
def test_package_is_valid_by_an_independent_implementation(case: str, metamodel: Metamodel, core: Any) -> None:
    content = ZipFile(BytesIO(packed(case, metamodel))).read("aasx/data.xml")
    environment = core.xmlization.environment_from_str(content.decode())
    assert [f"{error.path}: {error.cause}" for error in core.verification.verify(environment)] == []


@pytest.mark.parametrize("case", ["example", "everything", "nothing suitable", "not rated"])
def test_package_passes_the_test_engines_of_IDTA(case: str, catalogue: Catalogue) -> None:
    """They check package, metamodel and constraints, and read 3.0 alone."""
    hostile = "<&> \U0001f600 བོ"
    inputs = typed_export_of(CASES[case], catalogue, title=hostile, reference=hostile)
    check: Any = check_aasx_file  # its annotation asks for text, of which no package is made
    result = check(BytesIO(package(inputs)))
    assert result.ok(), vars(result)
    assert not check(BytesIO(package(inputs, "3.1"))).ok()


@pytest.mark.parametrize("case", ["example", "everything", "rotary table"])
def test_technical_data_fit_the_template_of_IDTA(case: str, catalogue: Catalogue) -> None:
    """By a validator of its own, which reads the published template of 02003; it has none of 02021."""
    content = package(typed_export_of((CASES | MOVING)[case], catalogue))

    report = validate(content, format="aasx", meta="info")

    assert report.ok
    assert (report.findings, report.submodels_judged) == ([], 1)


def figures_of(technical: model.Submodel) -> dict[str, dict[str, object]]:
    """Figures of each section of the one area."""
    areas = technical.get_referable("TechnicalPropertyAreas")
    assert isinstance(areas, model.SubmodelElementList)
    (area,) = list(areas.value)
    assert isinstance(area, model.SubmodelElementCollection)
    return {str(section.id_short): values(section) for section in area}


def test_technical_data_have_the_published_figures_and_no_invented_number(catalogue: Catalogue) -> None:
    technical = read(package(typed_export_of(EVERYTHING, catalogue), "3.1"))[0]["TechnicalData"]
    gear = catalogue.by_designation["HPN-20A-5"]
    sections = figures_of(technical)
    assert {short_id(title) for title in GROUPS.values()} - {"AtTheInput", "Bolts"} == set(sections) - {"Kinematics"}
    assert sections["TorqueAtTheOutput"]["rated_torque_Nm"] == gear.rated_torque_Nm
    figures = {name: value for section in sections.values() for name, value in section.items()}
    assert all(figures[name] == getattr(gear, name.removeprefix("published_")) for name in figures)
    assert len(figures) == 3 + sum(line.value is not None for line in published(gear))
    general = values(technical.get_referable("GeneralInformation"))
    assert general["ManufacturerArticleNumber"] == general["ManufacturerOrderCode"] == gear.designation
    assert technical.semantic_id is not None
    assert technical.semantic_id.key[0].value == TECHNICAL_DATA


def test_the_order_code_is_the_saved_one(catalogue: Catalogue) -> None:
    export = typed_export_of(EVERYTHING, catalogue)
    coded = replace(export, heading=replace(export.heading, ordering_code="HPN-20A-5-J6"))
    submodels = read(package(coded, "3.1"))[0]
    general = submodels["TechnicalData"].get_referable("GeneralInformation")
    assert isinstance(general, model.SubmodelElementCollection)
    assert values(general)["ManufacturerOrderCode"] == "HPN-20A-5-J6"
    assert general.get_referable("ManufacturerOrderCode").description is None
    gearbox = submodels["PowerDriveTrainSizing"].get_referable(["SizingResult", "MainComponent_1"])
    assert isinstance(gearbox, model.Entity)
    codes = [one.value for one in gearbox.statement if isinstance(one, model.Property) and "Order" in str(one.id_short)]
    assert codes == ["HPN-20A-5-J6"]


def test_article_number_and_order_code_say_what_they_are(catalogue: Catalogue) -> None:
    technical = read(package(typed_export_of(EVERYTHING, catalogue), "3.1"))[0]["TechnicalData"]
    general = technical.get_referable("GeneralInformation")
    assert isinstance(general, model.SubmodelElementCollection)
    names: dict[str, Any] = {
        name: general.get_referable(f"Manufacturer{name}").description for name in ("ArticleNumber", "OrderCode")
    }
    assert names == {"ArticleNumber": ARTICLE_NUMBER, "OrderCode": ORDER_CODE}


def test_data_are_valid_from_the_day_they_were_saved(catalogue: Catalogue) -> None:
    """A selection that is not saved has no date."""
    export = typed_export_of(EVERYTHING, catalogue)
    for created, view in ((datetime(2026, 3, 1, 1, tzinfo=timezone(timedelta(hours=2))), "2026-02-28"), (None, None)):
        technical = read(package(replace(export, created=created), "3.1"))[0]["TechnicalData"]
        further = [one for one in technical.submodel_element if one.id_short == "FurtherInformation"]
        assert [str(values(one)["ValidDate"]) for one in further] == ([view] if view else [])


def test_what_is_not_saved_is_valid_from_the_day_of_its_making(catalogue: Catalogue) -> None:
    output = datetime(2026, 3, 1, 13, 30, tzinfo=timezone(timedelta(hours=2)))
    export = replace(typed_export_of(EVERYTHING, catalogue), created=None, moment=output)
    submodels = read(package(export, "3.1"))[0]
    assert str(values(submodels["TechnicalData"].get_referable("FurtherInformation"))["ValidDate"]) == "2026-03-01"
    information = values(submodels["PowerDriveTrainSizing"].get_referable("SizingProjectInformation"))
    assert information["DateCreated"] == datetime(2026, 3, 1, tzinfo=UTC)


def test_a_figure_that_is_not_published_is_left_out(catalogue: Catalogue) -> None:
    submodels, _ = read(package(typed_export_of(CASES["standing loads"], catalogue), "3.1"))
    figures = values(submodels["SelectionResult"].get_referable("Figures"))
    assert "life_L10_h" not in figures  # unlimited
    assert None not in figures.values()


@pytest.mark.parametrize("efficiency", [None, 0.9])
def test_motor_torques_without_an_efficiency_are_described_as_a_lower_bound(
    efficiency: float | None, catalogue: Catalogue
) -> None:
    application = worked_example(requirements={"efficiency": efficiency})
    submodels, _ = read(package(typed_export_of(application, catalogue), "3.1"))
    figures = submodels["SelectionResult"].get_referable("Figures")
    assert isinstance(figures, model.SubmodelElementCollection)
    for name in ("motor_peak_torque_Nm", "motor_rated_torque_Nm"):
        description = figures.get_referable(name).description
        assert (description["en"] if description else None) == (None if efficiency else LOSS_FREE)


def test_no_technical_data_where_no_gear_is_selected(catalogue: Catalogue) -> None:
    submodels = set(read(package(typed_export_of(CASES["nothing suitable"], catalogue), "3.1"))[0])
    assert submodels == {"PowerDriveTrainSizing", "SelectionResult"}


def test_the_report_is_in_the_package(catalogue: Catalogue) -> None:
    export, report = typed_export_of(EVERYTHING, catalogue), BytesIO()
    read(package(export, "3.1"))[1].write_file("/aasx/report.pdf", report)
    assert report.getvalue() == pdf(export, Reader(digits=DIGITS))


def test_ids_are_our_own_urns(catalogue: Catalogue) -> None:
    submodels, _ = read(package(typed_export_of(EVERYTHING, catalogue), "3.1"))
    assert all(submodel.id.startswith("urn:uuid:") for submodel in submodels.values())


MAKE = """
import sys
from hashlib import sha256
from hpn.catalogue import load_catalogue
from hpn.files.aas.submodel import package
from tests.report.cases import EVERYTHING, typed_export_of
print(sha256(package(typed_export_of(EVERYTHING, load_catalogue()))).hexdigest())
"""


def test_the_same_selection_gives_the_same_bytes_in_every_process(catalogue: Catalogue) -> None:
    here = hashlib.sha256(package(typed_export_of(EVERYTHING, catalogue))).hexdigest()
    for seed in ("1", "2"):
        run = subprocess.run(
            [sys.executable, "-c", MAKE], env={"PYTHONHASHSEED": seed}, capture_output=True, text=True, check=True
        )
        assert run.stdout.strip() == here

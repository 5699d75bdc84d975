"""Asset Administration Shell of a selection: one package with technical data, sizing and every check.

`TechnicalData` and `PowerDriveTrainSizing` follow templates of IDTA; `SelectionResult` is ours, since no registered
template has the checks. Beside them lie the parts that every file carries, the motion as CSV, and the report.

The library writes metamodel 3.1. The elements used here are the same in 3.0; only the namespace tells the version that
a package claims. Most other tools read only 3.0.
"""

from collections.abc import Iterable, Iterator, Mapping
from datetime import UTC
from io import BytesIO
from zipfile import ZIP_DEFLATED, ZipFile, ZipInfo

from basyx.aas import model
from basyx.aas.adapter import aasx
from pyecma376_2.core_properties import OPCCoreProperties

from hpn.account.account import UNLIMITED, CheckLine
from hpn.account.lines import Line, LineTable, Value
from hpn.files import formats
from hpn.files.aas import Metamodel
from hpn.files.aas.concepts import CONCEPTS, concept, concept_id, reference, texts, translations, urn
from hpn.files.aas.sections import CSV_TYPE
from hpn.files.aas.sizing import files_of, sizing
from hpn.files.aas.technical import technical_data
from hpn.files.carried import APPLICATION, DOCUMENT, RESULT, parts_of
from hpn.files.export import DIGITS, LOSS_FREE, Export
from hpn.installed import has_extra
from hpn.words.reader import Reader
from hpn.words.units import symbol_of
from hpn.words.wording import Sentence

VARYING = ("peak_torque_Nm", "peak_speed_rpm", "rms_torque_Nm")
"""Figures of a phase with varying torque or speed."""

WRITTEN: Metamodel = "3.1"
NAMESPACES: Mapping[Metamodel, bytes] = {
    "3.0": b"https://admin-shell.io/aas/3/0",
    "3.1": b"https://admin-shell.io/aas/3/1",
}

DATA_PART, PARTS = "/aasx/data.xml", "/aasx/"
CARRIED = {APPLICATION: "Application", RESULT: "Result", DOCUMENT: "Document"}
"""Parts that a package carries as JSON, and their short ids in the submodel."""

REPORT, PDF_TYPE = PARTS + "report.pdf", "application/pdf"

FIRST_DATE = (1980, 1, 1, 0, 0, 0)
"""Earliest time that a zip entry can have; the moment of saving stands in the content."""


def package(export: Export, metamodel: Metamodel = "3.0") -> bytes:
    """AASX package of an export in a version of the metamodel; the same bytes for the same selection.

    It contains the report where the report's extra is installed.
    """
    files = aasx.DictSupplementaryFileContainer()  # type: ignore[no-untyped-call]
    for name, part in parts_of(export, Reader()).items():
        files.add_file(PARTS + name, BytesIO(part), "application/json")
    for path, course in files_of(export).items():
        files.add_file(path, BytesIO(course), CSV_TYPE)
    if has_extra("report"):
        files.add_file(REPORT, BytesIO(formats.PDF.content(export, Reader(digits=DIGITS))), PDF_TYPE)
    packed = BytesIO()
    with aasx.AASXWriter(packed, failsafe=False) as writer:
        writer.write_core_properties(_properties(export))
        writer.write_all_aas_objects(DATA_PART, environment(export), files)
    return _package(packed.getvalue(), metamodel)


def environment(export: Export) -> model.DictIdentifiableStore[model.Identifiable]:
    """Shell, submodels and concept descriptions of an export."""
    submodels = [sizing(export), _selection_result(export)]
    suitable = export.candidate.status == "suitable"
    if suitable:
        submodels.insert(0, technical_data(export))
    kind = model.AssetKind.TYPE if suitable else model.AssetKind.NOT_APPLICABLE
    shell = model.AssetAdministrationShell(
        model.AssetInformation(kind, global_asset_id=urn("asset", export.link)),
        urn("shell", export.link),
        id_short="GearSelection",
        submodel=_InOrder(map(model.ModelReference.from_referable, submodels)),
    )
    store: model.DictIdentifiableStore[model.Identifiable] = model.DictIdentifiableStore()
    for item in (shell, *submodels, *map(concept, CONCEPTS)):
        store.add(item)
    return store


class _InOrder(set[model.ModelReference[model.Submodel]]):
    """Set that is always written in the same order, so that equal packages have equal bytes."""

    def __iter__(self) -> Iterator[model.ModelReference[model.Submodel]]:
        return iter(sorted(super().__iter__(), key=str))


# --- Selection --------------------------------------------------------------------------------------------------------


def _selection_result(export: Export) -> model.Submodel:
    elements: list[model.SubmodelElement] = [
        *_texts(export),
        *(model.File(id_short, "application/json", PARTS + name) for name, id_short in CARRIED.items()),
        *([model.File("Report", PDF_TYPE, REPORT)] if has_extra("report") else []),
        model.SubmodelElementCollection("Duty", _properties_of({one.field: one.value for one in export.account.cycle})),
        *_cycle(export),
        model.SubmodelElementCollection("Figures", _candidate_figures(export)),
        model.SubmodelElementCollection("Checks", [_check(check) for check in export.account.checks]),
        model.SubmodelElementCollection("Notices", _notices(export)),
    ]
    return model.Submodel(
        urn("selection-result", export.link),
        elements,
        id_short="SelectionResult",
        description=model.MultiLanguageTextType(
            {"en": "Selection of a planetary gear for a duty cycle", "de": "Auswahl eines Planetengetriebes"}
        ),
        semantic_id=reference(urn("submodel", "selection-result", "1")),
    )


def _texts(export: Export) -> Iterable[model.Property]:
    selection, candidate = export.selection, export.candidate
    values = {
        "Selected": selection.selected,
        "Candidate": candidate.designation,
        "Status": candidate.status,
        "GoverningCheck": candidate.governing_check,
        "Title": export.heading.title or None,
        "Reference": export.heading.reference or None,
        "Author": export.heading.author or None,
        "Revision": export.heading.revision or None,
        "OrderingCode": export.heading.ordering_code or None,
        "Created": export.created.astimezone(UTC).isoformat() if export.created else None,
        "Link": export.link,
        "EngineVersion": selection.engine_version,
        "CatalogueVersion": selection.catalogue_version,
    }
    return [model.Property(name, str, value) for name, value in values.items() if value is not None]


MOST_ITEMS = 100
"""Most moves or phases in the submodel one by one; with more, only the files have them."""


def _cycle(export: Export) -> Iterable[model.SubmodelElementCollection]:
    """Motion as it was given, and the phases of a motion, with names, or with varying torque or speed."""
    account, phases = export.account, export.account.phases
    if account.moves is not None:
        mechanism = model.SubmodelElementCollection("Mechanism", _figures(account.mechanism))
        yield model.SubmodelElementCollection("Motion", [mechanism, *_numbered("Move", account.moves)])
    if phases and (account.moves or any(phases.names.values) or any(c.head.field in VARYING for c in phases.columns)):
        yield model.SubmodelElementCollection("Phases", [*_numbered("Phase", phases)])


def _numbered(name: str, table: LineTable) -> Iterable[model.SubmodelElement]:
    """Number of rows, and each row up to MOST_ITEMS."""
    yield model.Property("Count", int, len(table))
    if len(table) <= MOST_ITEMS:
        for place in range(len(table)):
            yield model.SubmodelElementCollection(f"{name}_{place + 1}", _figures(table.row(place)))


def _figures(lines: Iterable[Line]) -> list[model.Property]:
    """Properties of a mechanism, a move or a phase, each with its name and unit in words."""
    return [
        model.Property(line.field, type(line.value), line.value, display_name=model.MultiLanguageNameType(_names(line)))
        for line in lines
    ]


def _names(line: Line) -> dict[str, str]:
    """Name of a line in every language, with its unit."""
    unit = symbol_of(line.code)
    return {code: f"{text} [{unit}]" if unit else text for code, text in texts(line.named.name).items()}


def _candidate_figures(export: Export) -> list[model.Property]:
    """Figures of the candidate; motor torques without an efficiency are described as a lower bound."""
    candidate, figures = export.candidate, export.account.figures
    values: dict[str, Value | None] = {name: getattr(candidate, name) for name in ("ratio", "stages", "utilisation")}
    values |= {line.field: line.value for line in figures if line.value != UNLIMITED}
    loss_free = (line.field for line in figures if line.is_lower_bound)
    return _properties_of(values, dict.fromkeys(loss_free, Sentence(LOSS_FREE)))


def _check(check: CheckLine) -> model.SubmodelElementCollection:
    definition, result = check.definition, check.result
    figures: dict[str, Value | None] = {
        "demand": result.demand,
        "limit": result.limit,
        "utilisation": result.utilisation,
        "status": result.status,
    }
    return model.SubmodelElementCollection(
        check.code,
        [*_properties_of(figures), *([model.Property("unit", str, definition.unit)] if definition.unit else [])],
        display_name=model.MultiLanguageNameType(texts(definition.title)),
        description=model.MultiLanguageTextType(texts(definition.basis)) if definition.basis else None,
    )


def _notices(export: Export) -> Iterable[model.MultiLanguageProperty]:
    return [
        model.MultiLanguageProperty(
            f"{notice.code}_{number}", model.MultiLanguageTextType(translations(notice.sentence))
        )
        for number, notice in enumerate(export.selection.notices, 1)
    ]


def _properties_of(
    figures: Mapping[str, Value | None], described: Mapping[str, Sentence] | None = None
) -> list[model.Property]:
    """Properties of the figures that have a value, with descriptions from `described`."""
    described = described or {}
    return [
        model.Property(
            name,
            type(value),
            value,
            semantic_id=reference(concept_id(name)),
            description=model.MultiLanguageTextType(translations(described[name])) if name in described else None,
        )
        for name, value in figures.items()
        if value is not None
    ]


# --- Package ----------------------------------------------------------------------------------------------------------


def _properties(export: Export) -> OPCCoreProperties:
    """Author and title of the package. Its time stands in the content: here a library would choose the XML prefix."""
    properties = OPCCoreProperties()  # type: ignore[no-untyped-call]
    properties.creator = "HPN Select"
    properties.title = export.heading.title or None
    return properties


def _package(packed: bytes, metamodel: Metamodel) -> bytes:
    """Package in the namespace of a metamodel, without the time of its making."""
    result = BytesIO()
    with ZipFile(BytesIO(packed)) as source, ZipFile(result, "w", ZIP_DEFLATED) as target:
        for name in source.namelist():
            entry = ZipInfo(name, FIRST_DATE)
            entry.compress_type = ZIP_DEFLATED
            content = source.read(name)
            if f"/{name}" == DATA_PART:
                content = content.replace(NAMESPACES[WRITTEN], NAMESPACES[metamodel], 1)
            target.writestr(entry, content)
    return result.getvalue()

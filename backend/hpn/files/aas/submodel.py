"""The Asset Administration Shell: technical data of the selected gear, and the selection with every check.

`TechnicalData` follows IDTA 02003-1-2 (Generic Frame for Technical Data for Industrial Equipment in Manufacturing, 1.2)
with its semantic ids. Article number and order code are the designation: the handbook prints no article number, and a
full order code names output version and motor adapter too; their descriptions say so. An unsaved selection has no date,
hence no `ValidDate`. `SelectionResult` is ours; no registered template exists for it.

The library writes metamodel 3.1, whose elements are those of 3.0 as far as they are used here: the namespace tells
which one a package claims. Most other tools read 3.0 alone.
"""

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import replace
from datetime import UTC
from io import BytesIO
from zipfile import ZIP_DEFLATED, ZipFile, ZipInfo

from basyx.aas import model
from basyx.aas.adapter import aasx
from pyecma376_2.core_properties import OPCCoreProperties

from hpn.account.account import UNLIMITED, CheckLine
from hpn.account.lines import Line, LineTable, Value
from hpn.account.published import line_of
from hpn.engine.candidates import Candidate
from hpn.engine.checks import BY_CODE
from hpn.files.aas import Metamodel
from hpn.files.aas.concepts import CONCEPTS, concept, concept_id, published, reference, texts, told, urn
from hpn.files.carried import APPLICATION, DOCUMENT, RESULT, carried
from hpn.files.export import LOSS_FREE, Export
from hpn.words.reader import Reader
from hpn.words.units import symbol_of
from hpn.words.wording import Sentence

VARYING = ("peak_torque_Nm", "peak_speed_rpm", "rms_torque_Nm")
"""Figures of a phase in which torque or speed varies."""

MANUFACTURER = "Harmonic Drive AG"
TECHNICAL_DATA = "https://admin-shell.io/ZVEI/TechnicalData/"
GENERAL_INFORMATION = {
    "ManufacturerName": "0173-1#02-AAO677#002",
    "ManufacturerProductDesignation": "0173-1#02-AAW338#001",
    "ManufacturerArticleNumber": "0173-1#02-AAO676#003",
    "ManufacturerOrderCode": "0173-1#02-AAO227#002",
}
"""Elements of the template and their semantic ids, as the template of IDTA gives them."""

ARTICLE_NUMBER = {
    "en": "Designation of the gear: the manufacturer’s engineering data print no article number.",
    "de": "Bezeichnung des Getriebes: Die Projektierungsunterlagen des Herstellers nennen keine Artikelnummer.",
}
ORDER_CODE = {
    "en": "Ordering code as far as it is known: output version and motor adapter follow (table 9.1).",
    "de": "Bestellschlüssel, soweit bekannt: Abtriebsausführung und Motoradapter folgen (Tab. 9.1).",
}

WRITTEN: Metamodel = "3.1"
NAMESPACES: Mapping[Metamodel, bytes] = {
    "3.0": b"https://admin-shell.io/aas/3/0",
    "3.1": b"https://admin-shell.io/aas/3/1",
}

DATA_PART, PARTS = "/aasx/data.xml", "/aasx/"
CARRIED = {APPLICATION: "Application", RESULT: "Result", DOCUMENT: "Document"}
"""Parts that a package carries as JSON, and what the submodel calls them."""

FIRST_DATE = (1980, 1, 1, 0, 0, 0)
"""Earliest time that a zip entry can have; the content says when the selection was saved."""


def package(export: Export, metamodel: Metamodel = "3.0") -> bytes:
    """The .aasx package on an export in a version of the metamodel; the same bytes for the same selection."""
    files = aasx.DictSupplementaryFileContainer()  # type: ignore[no-untyped-call]
    for name, part in carried(replace(export, made=None), Reader()).items():
        files.add_file(PARTS + name, BytesIO(part), "application/json")
    packed = BytesIO()
    with aasx.AASXWriter(packed, failsafe=False) as writer:
        writer.write_core_properties(_properties(export))
        writer.write_all_aas_objects(DATA_PART, environment(export), files)
    return _finished(packed.getvalue(), metamodel)


def environment(export: Export) -> model.DictIdentifiableStore[model.Identifiable]:
    """Shell, submodels and concept descriptions of an export."""
    submodels = [_selection_result(export)]
    suitable = export.candidate.status == "suitable"
    if suitable:
        submodels.insert(0, _technical_data(export))
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
    """A set that is always written in the same order, so that equal packages have equal bytes."""

    def __iter__(self) -> Iterator[model.ModelReference[model.Submodel]]:
        return iter(sorted(super().__iter__(), key=str))


# --- Technical data ---------------------------------------------------------------------------------------------------


def _technical_data(export: Export) -> model.Submodel:
    return model.Submodel(
        urn("technical-data", export.link),
        [_general_information(export), _technical_properties(export), _further_information(export)],
        id_short="TechnicalData",
        administration=model.AdministrativeInformation(version="1", revision="2"),
        semantic_id=reference(TECHNICAL_DATA + "Submodel/1/2"),
    )


def _general_information(export: Export) -> model.SubmodelElementCollection:
    designation = export.candidate.designation
    names = {"en": f"{designation} planetary gear", "de": f"{designation} Planetengetriebe"}
    ids = {name: reference(value) for name, value in GENERAL_INFORMATION.items()}

    def element(name: str, value: str, description: Mapping[str, str] | None = None) -> model.Property:
        text = model.MultiLanguageTextType(dict(description)) if description else None
        return model.Property(name, str, value, semantic_id=ids[name], description=text)

    return model.SubmodelElementCollection(
        "GeneralInformation",
        [
            element("ManufacturerName", MANUFACTURER),
            model.MultiLanguageProperty(
                "ManufacturerProductDesignation",
                model.MultiLanguageTextType(names),
                semantic_id=ids["ManufacturerProductDesignation"],
            ),
            element("ManufacturerArticleNumber", designation, ARTICLE_NUMBER),
            element("ManufacturerOrderCode", designation, ORDER_CODE),
        ],
        semantic_id=reference(TECHNICAL_DATA + "GeneralInformation/1/1"),
    )


def _technical_properties(export: Export) -> model.SubmodelElementCollection:
    """Published figures; what is not published is left out."""
    account, candidate = export.account, export.candidate
    figures: dict[str, Value | None] = {"size": candidate.size, "ratio": candidate.ratio, "stages": candidate.stages}
    lines = [line_of(account.gear, "ratio"), *account.published] if account.gear else []
    figures |= {published(_name(line)): line.value for line in lines}
    if not lines:
        figures |= {published(name): value for name, value in _limits(candidate)}
    sources = {published(_name(line)): line.source for line in lines if line.source}
    return model.SubmodelElementCollection(
        "TechnicalProperties",
        _properties_of(figures, sources),
        semantic_id=reference(TECHNICAL_DATA + "TechnicalProperties/1/1"),
    )


def _limits(candidate: Candidate) -> Iterator[tuple[str, Value | None]]:
    """Published figures that are the limit of a load check: what a kept answer says without its catalogue."""
    for check in candidate.checks:
        known = BY_CODE.get(check.code)
        if known and known.group == "load" and known.limited_by and known.unit == symbol_of(known.limited_by):
            yield known.limited_by, check.limit


def _further_information(export: Export) -> model.SubmodelElementCollection:
    statement = {
        "en": (
            "Figures of the manufacturer’s engineering data, written by an independent tool; not a statement of the "
            "manufacturer."
        ),
        "de": "Angaben aus den Projektierungsunterlagen des Herstellers, von einem unabhängigen Werkzeug geschrieben; "
        "keine Aussage des Herstellers.",
    }
    elements: list[model.SubmodelElement] = [
        model.MultiLanguageProperty(
            "TextStatement01",
            model.MultiLanguageTextType(statement),
            semantic_id=reference(TECHNICAL_DATA + "TextStatement/1/1"),
        )
    ]
    if export.created:
        day = model.datatypes.Date(*export.created.astimezone(UTC).timetuple()[:3])
        valid = reference(TECHNICAL_DATA + "ValidDate/1/1")
        elements.append(model.Property("ValidDate", model.datatypes.Date, day, semantic_id=valid))
    return model.SubmodelElementCollection(
        "FurtherInformation",
        elements,
        semantic_id=reference(TECHNICAL_DATA + "FurtherInformation/1/1"),
    )


# --- Selection --------------------------------------------------------------------------------------------------------


def _selection_result(export: Export) -> model.Submodel:
    elements: list[model.SubmodelElement] = [
        *_texts(export),
        *(model.File(id_short, "application/json", PARTS + name) for name, id_short in CARRIED.items()),
        model.SubmodelElementCollection("Duty", _duty(export)),
        *_cycle(export),
        model.SubmodelElementCollection("Figures", _calculated(export)),
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
"""Moves or phases of which each stands in the submodel; of more the files have them all."""


def _duty(export: Export) -> list[model.Property]:
    """Figures of the cycle; of a motion also the inertia of its load."""
    return _properties_of({_name(line): line.value for line in export.account.cycle})


def _cycle(export: Export) -> Iterable[model.SubmodelElementCollection]:
    """A motion as it was given, and the phases where torque or speed vary in them, or where they have names."""
    account, phases = export.account, export.account.phases
    if account.moves is not None:
        mechanism = model.SubmodelElementCollection("Mechanism", _said(account.mechanism))
        yield model.SubmodelElementCollection("Motion", [mechanism, *_numbered("Move", account.moves)])
    if phases and (account.moves or any(phases.names.values) or any(_name(c.head) in VARYING for c in phases.columns)):
        yield model.SubmodelElementCollection("Phases", [*_numbered("Phase", phases)])


def _numbered(name: str, table: LineTable) -> Iterable[model.SubmodelElement]:
    """How many rows there are, and each of them unless they are very many."""
    yield model.Property("Count", int, len(table))
    if len(table) <= MOST_ITEMS:
        for place in range(len(table)):
            yield model.SubmodelElementCollection(f"{name}_{place + 1}", _said(table.row(place)))


def _said(lines: Iterable[Line]) -> list[model.Property]:
    """Properties of a mechanism, a move or a phase, each with its name and unit in words."""
    return [
        model.Property(
            _name(line), type(line.value), line.value, display_name=model.MultiLanguageNameType(_named(line))
        )
        for line in lines
    ]


def _name(line: Line) -> str:
    """Field of a line, by which a property is called."""
    return line.code.rpartition(".")[2]


def _named(line: Line) -> dict[str, str]:
    """Name of a line in every language, with its unit."""
    unit = symbol_of(line.code)
    return {code: f"{text} [{unit}]" if unit else text for code, text in texts(line.named.name).items()}


def _calculated(export: Export) -> list[model.Property]:
    """Figures of the candidate; motor torques without an efficiency are described as a lower bound."""
    candidate, figures = export.candidate, export.account.figures
    values: dict[str, Value | None] = {name: getattr(candidate, name) for name in ("ratio", "stages", "utilisation")}
    values |= {_name(line): line.value for line in figures if line.value != UNLIMITED}
    loss_free = (_name(line) for line in figures if line.is_lower_bound)
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
        model.MultiLanguageProperty(f"{notice.code}_{number}", model.MultiLanguageTextType(told(notice.sentence)))
        for number, notice in enumerate(export.selection.notices, 1)
    ]


def _properties_of(
    figures: Mapping[str, Value | None], described: Mapping[str, Sentence] | None = None
) -> list[model.Property]:
    """Properties of the figures that have a value, described by their source or by what is to be known of them."""
    described = described or {}
    return [
        model.Property(
            name,
            type(value),
            value,
            semantic_id=reference(concept_id(name)),
            description=model.MultiLanguageTextType(told(described[name])) if name in described else None,
        )
        for name, value in figures.items()
        if value is not None
    ]


# --- Package ----------------------------------------------------------------------------------------------------------


def _properties(export: Export) -> OPCCoreProperties:
    """Author and title of the package; its time stands in the content, where no library chooses the prefix."""
    properties = OPCCoreProperties()  # type: ignore[no-untyped-call]
    properties.creator = "HPN Select"
    properties.title = export.heading.title or None
    return properties


def _finished(packed: bytes, metamodel: Metamodel) -> bytes:
    """The same package in the namespace of a metamodel, and without the time of its making."""
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

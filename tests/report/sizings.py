"""Sizings by IDTA 02021 as another tool may write them: in JSON, with short ids of its own."""

import io
import json
import zipfile

from hpn.files.aas.sizing_ids import SIZING, meaning
from tests.build import Json


def element(name: str, value: object, kind: str = "Property", short: str = "") -> Json:
    """An element of the template in JSON; its short id is of no account."""
    key = {"type": "GlobalReference", "value": f" {meaning(name).strip()} "}
    value_held = "statements" if kind == "Entity" else "value"
    return {
        "modelType": kind,
        "idShort": short or name,
        "semanticId": {"type": "ExternalReference", "keys": [key]},
        value_held: value,
    }


def shell(sections: list[Json], mechanism: Json | None = None, **more: Json) -> Json:
    """An environment with a sizing of these sections."""
    pattern = element("MotionPatternSections", sections, "SubmodelElementCollection")
    question = [element("MotionPattern", [pattern], "SubmodelElementCollection"), *more.values()]
    parts = [element("ApplicationRequirements", question, "SubmodelElementCollection")]
    if mechanism:
        parts.append(element("TransformationMechanism", [mechanism], "SubmodelElementCollection"))
    keys = [{"type": "Submodel", "value": SIZING}]
    return {
        "submodels": [
            {
                "modelType": "Submodel",
                "id": "urn:x",
                "semanticId": {"type": "ModelReference", "keys": keys},
                "submodelElements": parts,
            }
        ]
    }


def section(kind: str, columns: tuple[str, ...], file: str, **constants: object) -> Json:
    """A section with a course."""
    metadata = "MetadataLinearMotionFile" if kind == "LinearSection" else "MetadataRotativeMotionFile"
    return element(
        kind,
        [
            *(element(name, value, short=f"their{name}") for name, value in constants.items()),
            element(metadata, [element(name, "1") for name in columns], "SubmodelElementCollection"),
            element("MotionSectionFile", file, "File"),
        ],
        "SubmodelElementCollection",
    )


def packed(environment: Json, **files: str) -> bytes:
    """A package with an environment in JSON."""
    output = io.BytesIO()
    with zipfile.ZipFile(output, "w") as target:
        target.writestr("aasx/aasx-origin", "")
        target.writestr("aasx/data.json", json.dumps(environment))
        for name, content in files.items():
            target.writestr(f"aasx/{name}.csv", content)
    return output.getvalue()

"""`make sbom`: packages of an installed service, as CycloneDX.

It has the contents of the locks, with every file's hash and no address, so that the same locks give the same bytes.
"""

import json
import re
import sys
import tomllib
from base64 import b64decode
from collections.abc import Iterable
from itertools import chain
from pathlib import Path
from typing import Any
from uuid import NAMESPACE_OID, uuid5

from cyclonedx.model import ExternalReference, ExternalReferenceType, HashAlgorithm, HashType, XsUri
from cyclonedx.model.bom import Bom
from cyclonedx.model.component import Component, ComponentType
from cyclonedx.model.license import LicenseExpression
from cyclonedx.output.json import JsonV1Dot6
from packageurl import PackageURL

from tools.supply import licences, locks
from tools.supply.locks import Package

ALGORITHMS = {"sha256": HashAlgorithm.SHA_256, "sha512": HashAlgorithm.SHA_512}


def component(of: str, package: Package, licence: str, hashes: Iterable[tuple[str, str]]) -> Component:
    """Package with the hashes of its installation files."""
    address = PackageURL(of, name=package.name, version=package.version)
    files = [HashType(alg=ALGORITHMS[algorithm], content=digest) for algorithm, digest in hashes]
    return Component(
        type=ComponentType.LIBRARY,
        name=package.name,
        version=package.version,
        bom_ref=str(address),
        purl=address,
        licenses=[LicenseExpression(licence)],
        external_references=[
            ExternalReference(type=ExternalReferenceType.DISTRIBUTION, url=XsUri(str(address)), hashes=files)
        ],
    )


def of_python() -> list[Component]:
    """Run-time packages of the service."""
    return [
        component("pypi", package, licences.of_python(package.name), re.findall(r"(sha256):(\w+)", package.hashes))
        for package in locks.python(locks.RUN_LOCK)
    ]


def of_page() -> list[Component]:
    """Packages sent to browsers."""
    found = licences.of_page(development=False)
    integrity = {
        folder.rpartition("node_modules/")[2]: package["integrity"] for folder, package in locks.page().items()
    }
    split = {name: text.partition("-")[::2] for name, text in integrity.items()}
    return [
        component("npm", package, licence, [(split[package.name][0], b64decode(split[package.name][1]).hex())])
        for package, licence in found.items()
    ]


def bill() -> Bom:
    """Bill of materials. The locks do not tell dependencies of packages: it has those of the project itself."""
    project: dict[str, Any] = tomllib.loads((locks.ROOT / "pyproject.toml").read_text())["project"]
    root = Component(
        type=ComponentType.APPLICATION,
        name=project["name"],
        version=project["version"],
        bom_ref=project["name"],
        licenses=[LicenseExpression(project["license"])],
    )
    python, page = of_python(), of_page()
    asked = [*project["dependencies"], *chain.from_iterable(project["optional-dependencies"].values())]
    named = {re.split(r"[^\w.-]", line)[0] for line in asked}
    bom = Bom(components=[*python, *page])
    bom.metadata.component = root
    bom.register_dependency(root, [package for package in python if package.name in named] + page)
    locked = locks.RUN_LOCK.read_text() + (locks.PAGE / "package-lock.json").read_text()
    bom.serial_number = uuid5(NAMESPACE_OID, f"{project['version']} {locked}")
    return bom


def text() -> str:
    """Text of the file, without the time of writing."""
    document = json.loads(JsonV1Dot6(bill()).output_as_string())
    del document["metadata"]["timestamp"]
    return json.dumps(document, indent=2) + "\n"


if __name__ == "__main__":
    written = Path(sys.argv[1])
    written.write_text(text())
    print(written)

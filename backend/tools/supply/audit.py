"""`make audit`: checks the locks against the known vulnerabilities of PyPI and npm.

Ends with 0 where none is known, 1 where one is, and 3 where a package could not be looked up: such a package is not
called sound. pip-audit alone ends with 0 where an index without that data answers 404.
"""

import json
import subprocess
import sys
from collections.abc import Iterator, Sequence
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, NamedTuple

from tools.supply import locks
from tools.supply.locks import Package

SOUND, VULNERABLE, NOT_ASKED = 0, 1, 3
LOCKS = (locks.RUN_LOCK, *locks.DEVELOPMENT_LOCKS)


class Audit(NamedTuple):
    """Findings on some packages."""

    packages: int
    unasked: Sequence[str]
    found: Sequence[str]


def of_python(packages: Sequence[Package]) -> Audit:
    """Findings of pip-audit on all packages, those for other versions of Python and other systems included."""
    flags = ["--disable-pip", "--require-hashes", "--progress-spinner=off", "--format=json"]
    unasked, found = [], []
    for some in _one_version_of_each(packages):
        with TemporaryDirectory() as folder:
            listed = Path(folder) / "requirements.txt"
            listed.write_text("".join(f"{name}=={version} \\\n{hashes}" for name, version, hashes in some))
            said = _json([sys.executable, "-m", "pip_audit", *flags, f"--requirement={listed}"])
        for package in said.get("dependencies", ()):
            unasked += [package["skip_reason"]] if "skip_reason" in package else []
            found += [_flaw(package, flaw) for flaw in package.get("vulns", ())]
        unasked += [] if "dependencies" in said else [said["error"]] * len(some)
    return Audit(len(packages), unasked, found)


def _one_version_of_each(packages: Sequence[Package]) -> Iterator[Sequence[Package]]:
    """Split packages so that no name occurs twice, which pip-audit refuses."""
    while packages:
        chosen = {package.name: package for package in packages}
        yield list(chosen.values())
        packages = [package for package in packages if package not in chosen.values()]


def _flaw(package: dict[str, Any], flaw: dict[str, Any]) -> str:
    mended = ", ".join(flaw["fix_versions"]) or "no version"
    return f"{package['name']} {package['version']}: {' '.join([flaw['id'], *flaw['aliases']])}, mended in {mended}"


def of_page() -> Audit:
    """Findings of npm on all packages of the page's lock."""
    packages = locks.page()
    said = _json(["npm", "audit", "--json"], locks.PAGE)
    if "vulnerabilities" not in said:
        return Audit(len(packages), [said.get("message") or said["error"]] * len(packages), [])
    found = [
        f"{name} {flaw['range']}: {', '.join(via if isinstance(via, str) else via['title'] for via in flaw['via'])}"
        for name, flaw in said["vulnerabilities"].items()
    ]
    return Audit(len(packages), [], found)


def _json(command: Sequence[str], folder: Path = locks.ROOT) -> dict[str, Any]:
    """JSON output of a tool, or its last line of error text under `error`."""
    run = subprocess.run(command, cwd=folder, capture_output=True, text=True)
    try:
        said: dict[str, Any] = json.loads(run.stdout)
    except ValueError:
        return {"error": (run.stderr.strip().splitlines() or [f"it ended with {run.returncode}"])[-1]}
    return said


def report(answers: dict[str, Audit]) -> int:
    """Print the findings; returns the exit code."""
    for name, (packages, unasked, found) in answers.items():
        print(f"{name}: {packages} packages, {len(unasked)} could not be looked up, {len(found)} known vulnerabilities")
        for line in (*unasked[:1], *found):
            print(f"  {line}")
    if any(answer.found for answer in answers.values()):
        return VULNERABLE
    if any(answer.unasked for answer in answers.values()):
        print("NOT AUDITED: no database of vulnerabilities answered for these packages; this says nothing about them")
        return NOT_ASKED
    return SOUND


if __name__ == "__main__":
    chosen = [Path(name) for name in sys.argv[1:]] or LOCKS
    python = sorted({package for lock in chosen for package in locks.python(lock)})
    sys.exit(report({"Python": of_python(python), "npm": of_page()}))

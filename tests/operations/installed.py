"""The package as pip installs it: built without the network, in an environment of its own, used from another folder.

Its dependencies are those of this environment, by links: nothing is downloaded.
"""

import shutil
import subprocess
import sys
import venv
from collections.abc import Iterator
from dataclasses import dataclass
from importlib.metadata import Distribution, distribution
from pathlib import Path

from packaging.requirements import Requirement

from tests.operations.dockerfile import machine

ROOT = Path(__file__).parents[2]
BUILD = ROOT / ".venv/build"
PARTS = ("LICENSE", "README.md", "pyproject.toml", ".gitignore", "backend", "catalogue", "frontend")


def copy_of_checkout(folder: Path) -> Path:
    """Copy of all that a build reads, the built assets included, in a folder without git."""
    for name in PARTS:
        source, ignored = ROOT / name, shutil.ignore_patterns("node_modules", "__pycache__")
        if source.is_dir():
            shutil.copytree(source, folder / name, ignore=ignored)
        else:
            folder.mkdir(exist_ok=True)
            shutil.copy(source, folder / name)
    return folder


def build(source: Path, target: Path, *options: str) -> "subprocess.CompletedProcess[str]":
    """Build sdist and wheel into a folder as `make package` does; the wheel comes out of the sdist."""
    words = [BUILD / "bin/uv", "build", "--offline", "--no-build-isolation", "--python", sys.executable]
    environment = machine() | {"PYTHONPATH": str(BUILD)}
    return subprocess.run(
        [*map(str, words), "--out-dir", str(target), *options, str(source)],
        env=environment,
        capture_output=True,
        text=True,
    )


@dataclass(frozen=True)
class Installed:
    """An environment that has the package with some of its extras, and an empty folder to work in."""

    environment: Path
    elsewhere: Path

    @property
    def hpn(self) -> str:
        """The command."""
        return str(self.environment / "bin/hpn")

    def run(self, *words: str | Path, **variables: str) -> "subprocess.CompletedProcess[str]":
        """Run the command in the folder until it ends."""
        return subprocess.run(
            [self.hpn, *words], cwd=self.elsewhere, env=machine() | variables, capture_output=True, text=True
        )


def install(wheel: Path, folder: Path, *extras: str) -> Installed:
    """Install a wheel with these extras."""
    environment, elsewhere = folder / "environment", folder / "elsewhere"
    elsewhere.mkdir(parents=True)
    venv.create(environment, symlinks=True)
    packages = next(environment.glob("lib/python*/site-packages"))
    for name in {name for result in needed("hpn-select", *extras) for name in _tops(result)}:
        source = Path(str(distribution("numpy").locate_file(name)))
        (packages / name).symlink_to(source)
    uv = [BUILD / "bin/uv", "pip", "install", "--quiet", "--offline", "--no-deps", "--python", environment, wheel]
    subprocess.run([*map(str, uv)], env=machine(), check=True)
    return Installed(environment, elsewhere)


def needed(name: str, *extras: str) -> list[Distribution]:
    """Packages that one needs with these extras, and those need, itself left out."""
    result: dict[tuple[str, str], Distribution] = {}
    values = [(name, extra) for extra in ("", *extras)]
    while values:
        of, extra = values.pop()
        if (of, extra) in result:
            continue
        result[of, extra] = distribution(of)
        for requirement in map(Requirement, result[of, extra].requires or ()):
            if requirement.marker is None or requirement.marker.evaluate({"extra": extra}):
                values += [(requirement.name, more) for more in ("", *requirement.extras)]
    return [package for (of, _), package in result.items() if of != name]


def brings(name: str, *extras: str) -> set[str]:
    """Modules that may be imported where a package is installed with these extras, itself left out."""
    return {top.removesuffix(".py").partition(".")[0] for package in needed(name, *extras) for top in _tops(package)}


def _tops(package: Distribution) -> Iterator[str]:
    """Names of a package in the folder where packages are installed."""
    for file in package.files or ():
        if file.parts[0] not in ("..", "__pycache__"):
            yield file.parts[0]

"""Debian's packages of any release, from where this machine's own apt fetches its packages.

Releases that the machine is not of are asked in a configuration apart, so that its own stays as it is.
"""

import os
import re
import shutil
import subprocess
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

RELEASES = ("bookworm", "trixie", "forky", "sid")
"""Oldest first: the first that has a version is taken."""

KEYRING = "/usr/share/keyrings/debian-archive-keyring.gpg"


class UnavailableError(Exception):
    """Something that is needed can't be had here; the reason in one sentence."""


@dataclass(frozen=True)
class Debian:
    """Packages of all releases, with what apt keeps of them in a folder."""

    folder: Path

    @cached_property
    def mirror(self) -> str:
        """Address that this machine's apt has Debian from."""
        known = _run(["apt-get", "indextargets", "--format", "$(ORIGIN) $(REPO_URI)"])
        for origin, address in map(str.split, known.splitlines()):
            if origin == "Debian" and "security" not in address:
                return address
        raise UnavailableError("apt knows no archive of Debian here")

    def release_with(self, package: str, version: str) -> str:
        """Oldest release whose package begins with a version; an epoch does not count."""
        result = _run(["apt-cache", *self._options, "madison", package])
        for release in RELEASES:
            versions = re.findall(rf"\| +(?:\d+:)?(\S+) \| \S+ {release}/", result)
            if any(re.match(rf"{re.escape(version)}(\D|$)", each) for each in versions):
                return release
        raise UnavailableError(f"no release of Debian has {package} {version}")

    def download(self, package: str, release: str) -> Path:
        """Its files, unpacked but not installed."""
        goal = self.folder / f"{package}-{release}"
        if not goal.exists():
            _run(["apt-get", *self._options, "--quiet", "download", f"{package}/{release}"], self.folder)
            (file,) = self.folder.glob(f"{package}_*.deb")
            _run(["dpkg-deb", "--extract", str(file), f"{goal}.part"])
            file.unlink()
            os.replace(f"{goal}.part", goal)
        return goal

    def system(self, release: str) -> Path:
        """Archive of the smallest system of a release, made once."""
        archive = self.folder / f"{release}.tar.gz"
        if not archive.exists():
            install("debootstrap")
            root = self.folder / f"{release}.root"
            _run(["rm", "-rf", str(root)])
            # Scripts are the same for all releases that are newer than debootstrap itself.
            script = release if Path(f"/usr/share/debootstrap/scripts/{release}").exists() else "sid"
            flags = ["--variant=minbase", f"--keyring={KEYRING}", "--include=ca-certificates"]
            _run(["debootstrap", *flags, release, str(root), self.mirror, script])
            # How this machine's apt reaches its archive, a proxy for instance, holds inside, too.
            (root / "etc/apt/apt.conf.d/80machine").write_text(_run(["apt-config", "dump", "Acquire"]))
            _run(["sh", "-c", f"rm -rf {root}/var/cache/apt/archives/*.deb {root}/var/lib/apt/lists/*"])
            _run(["tar", "-C", str(root), "-I", "gzip -1", "-cf", f"{archive}.part", "."])
            os.replace(f"{archive}.part", archive)
            _run(["rm", "-rf", str(root)])
        return archive

    @cached_property
    def _options(self) -> list[str]:
        """Flags of an apt that knows these releases and nothing of the machine's configuration."""
        apt = self.folder / "apt"
        for name in ("lists/partial", "cache/archives/partial"):
            (apt / name).mkdir(parents=True, exist_ok=True)
        sources = "".join(f"deb [signed-by={KEYRING}] {self.mirror} {release} main\n" for release in RELEASES)
        (apt / "sources.list").write_text(sources)
        settings = {
            "Dir::Etc::SourceList": apt / "sources.list",
            "Dir::Etc::SourceParts": "/dev/null",
            "Dir::State::Lists": apt / "lists",
            "Dir::Cache": apt / "cache",
            "Acquire::Languages": "none",
            "Acquire::IndexTargets::deb::DEP-11::DefaultEnabled": "false",
            "APT::Sandbox::User": "root",
        }
        options = [word for name, value in settings.items() for word in ("-o", f"{name}={value}")]
        _run(["apt-get", *options, "--quiet", "update"])
        return options


def install(package: str, program: str | None = None) -> None:
    """Install a package of this machine's own release, unless its program is there."""
    if shutil.which(program or package):
        return
    if os.getuid() != 0 or not Path("/etc/debian_version").exists():
        raise UnavailableError(f"{program or package} is missing, and only root on Debian can have it installed")
    command = ["apt-get", "install", "--quiet", "--yes", "--no-install-recommends", package]
    try:
        _run(command)
    except UnavailableError:
        _run(["apt-get", "--quiet", "update"])
        _run(command)


def _run(command: list[str], folder: Path | None = None) -> str:
    environment = os.environ | {"DEBIAN_FRONTEND": "noninteractive"}
    try:
        run = subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True)
    except FileNotFoundError as error:
        raise UnavailableError(f"{command[0]} is missing") from error
    if run.returncode:
        last = (run.stderr.strip() or run.stdout.strip()).splitlines()[-1:]
        raise UnavailableError(f"{' '.join(command[:2])} ended with {run.returncode}: {' '.join(last)}")
    return run.stdout

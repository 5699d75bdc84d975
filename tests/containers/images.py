"""Images that the files name: pulled, or where no registry answers, stand-ins made of Debian's packages.

A stand-in has the same user, folders, programs and environment as far as the files rely on them. It has a name of its
own, so that none is ever taken for the real one.
"""

import hashlib
import os
import re
import subprocess
import tempfile
from dataclasses import dataclass, field
from pathlib import Path

from tests.containers.debian import Debian, UnavailableError
from tests.containers.engine import Engine

RECIPES = Path(__file__).parent / "recipes"
PACKAGES = {"python": "python3", "nginx": "nginx", "postgres": "postgresql-{major}"}
"""Package that shows which release of Debian has the version that a name asks for."""

PULL_S = 180.0
KEPT = "1GB"
"""Of the layers that builds leave."""

CERTIFICATES = Path("/etc/ssl/certs/ca-certificates.crt")
HANDED_ON = re.compile(r"(PIP|UV|NPM_CONFIG)_|(HTTPS?|NO|ALL)_PROXY$|SSL_CERT_FILE$|NODE_EXTRA_CA_CERTS$", re.I)
"""Settings of this machine by which an installation inside the build finds its packages."""


@dataclass
class Images:
    """Images by the names that stand in the files."""

    engine: Engine
    debian: Debian
    had: dict[str, str] = field(default_factory=dict)
    made: set[str] = field(default_factory=set)
    silent: str = ""

    def of(self, text: str) -> str:
        """The text of a file with the names of images that there are."""
        names = re.findall(r"\b(?:python|nginx|postgres):[\w.-]+(?:@sha256:[0-9a-f]{64})?", text)
        for name in sorted(set(names), key=len, reverse=True):
            text = text.replace(name, self.have(name))
        return text

    def have(self, name: str) -> str:
        """Name under which the engine has an image."""
        if name not in self.had:
            self.had[name] = name if self._pulled(name) else self._stand_in(name)
        return self.had[name]

    def lines(self) -> list[str]:
        """A line for each image: real, or what stands in for it."""
        return [
            f"{name.partition('@')[0]}: {'real' if have == name else _contents(self.engine, have)}"
            for name, have in sorted(self.had.items())
        ]

    def tidy(self) -> None:
        """Leave nothing in somebody else's engine; in our own, what makes the next run quick."""
        if not self.engine.own:
            for name in self.made:
                self.engine.docker("image", "rm", "--force", name, check=False)
            return
        listed = self.engine.docker("image", "ls", "--format", "{{.Repository}}:{{.Tag}}", "hpn-*/*").split()
        for name in set(listed) - self.made:
            self.engine.docker("image", "rm", "--force", name, check=False)
        self.engine.docker("volume", "prune", "--force")
        self.engine.docker("image", "prune", "--force")
        self.engine.docker("builder", "prune", "--force", "--keep-storage", KEPT)

    def _pulled(self, name: str) -> bool:
        if self.engine.docker("image", "ls", "--quiet", name, check=False):
            return True
        if self.silent:
            return False
        try:
            self.engine.docker("pull", "--quiet", name, seconds=PULL_S)
        except (RuntimeError, subprocess.TimeoutExpired) as error:
            self.silent = str(error)  # one registry has them all: the others are not waited for
            return False
        return True

    def _stand_in(self, name: str) -> str:
        kind, tag = re.findall(r"^(\w+):([\w.-]+)", name)[0]
        version, slim = tag.split("-")[0], "slim" in tag
        recipe = (RECIPES / f"{kind}{'-slim' if slim else ''}.dockerfile").read_text()
        recipe = recipe.replace("{major}", version.partition(".")[0])
        inside = "".join(sorted(path.read_text() for path in RECIPES.glob("*.sh")))
        mark = hashlib.sha256((recipe + inside).encode()).hexdigest()[:8]
        own = f"hpn-stand-in/{kind}:{tag}-{mark}"
        if not self.engine.docker("image", "ls", "--quiet", own):
            package = PACKAGES[kind].format(major=version.partition(".")[0])
            release = self.debian.release_with(package, version)
            self._build(own, recipe.replace("{base}", self._base(release)))
        self.made.add(own)
        return own

    def _base(self, release: str) -> str:
        name = f"hpn-stand-in/debian:{release}"
        if not self.engine.docker("image", "ls", "--quiet", name):
            self.engine.docker("import", str(self.debian.system(release)), name)
        self.made.add(name)
        return name

    def _build(self, name: str, recipe: str, folder: Path = RECIPES) -> None:
        with tempfile.NamedTemporaryFile("w", suffix=".dockerfile") as file:
            file.write(recipe)
            file.flush()
            words = ["--network", "host", "--tag", name, "--file", file.name, str(folder)]
            try:
                self.engine.docker("build", *words, seconds=1800)
            except (RuntimeError, subprocess.TimeoutExpired) as error:
                raise UnavailableError(f"{name} can't be made: {error}") from error

    def with_machine(self, dockerfile: str) -> str:
        """A Dockerfile whose first stage installs with this machine's certificates and registries."""
        dockerfile = self.of(dockerfile)
        base = re.search(r"^FROM (\S+) AS install", dockerfile, re.M)
        if base is None:
            raise UnavailableError("backend/Dockerfile has no stage named install")
        own = f"hpn-build/{re.sub('[:/@]', '-', base[1])}:here"
        with tempfile.TemporaryDirectory() as name:
            settings = {key: value for key, value in os.environ.items() if HANDED_ON.match(key)} | _npm()
            lines = [f"FROM {base[1]}", *(f"ENV {key}={_quoted(value)}" for key, value in settings.items() if value)]
            if CERTIFICATES.exists():
                (Path(name) / "certificates.crt").write_bytes(CERTIFICATES.read_bytes())
                lines.append(f"COPY certificates.crt {CERTIFICATES}")
            self._build(own, "\n".join(lines), Path(name))
        self.made.add(own)
        return dockerfile.replace(f"FROM {base[1]} AS", f"FROM {own} AS")


def _quoted(value: str) -> str:
    return '"{}"'.format(re.sub(r'(["$\\])', r"\\\1", value))


def _npm() -> dict[str, str]:
    """The registry that npm is set to use, where there is an npm."""
    try:
        run = subprocess.run(["npm", "config", "get", "registry"], capture_output=True, text=True)
    except FileNotFoundError:
        return {}
    return {"npm_config_registry": run.stdout.strip()} if run.returncode == 0 else {}


def _contents(engine: Engine, name: str) -> str:
    return "stand-in, " + engine.docker("run", "--rm", "--network", "none", "--entrypoint", "cat", name, "/stand-in")

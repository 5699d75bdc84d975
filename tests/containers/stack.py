"""The compose file as an operator starts it, from a copy of the checkout with a `.env` and certificates of its own."""

import json
import os
import shutil
import socket
import ssl
import subprocess
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import httpx
from ruamel.yaml import YAML

from tests.build import worked_example
from tests.containers.engine import Engine
from tests.containers.images import Images
from tests.operations.proxy import certify

ROOT = Path(__file__).parents[2]
PROJECT = "hpn-containers"
IMAGE = f"{PROJECT}/web"
PASSWORD = 'trial\'s pass$word & 100% "real"'
"""A password of awkward characters, as .env.example promises any."""

Run = subprocess.CompletedProcess[str]


@dataclass
class Stack:
    """Containers of a compose file, and how they are reached."""

    engine: Engine
    folder: Path
    https: int
    http: int
    settings: dict[str, str] = field(default_factory=dict)

    def run(self, *words: str, seconds: float = 600, text: str | None = None) -> Run:
        """Run a command in the copy of the checkout."""
        return subprocess.run(
            words,
            cwd=self.folder,
            env=self.engine.environment | {"COMPOSE_ANSI": "never"},
            input=text,
            capture_output=True,
            text=True,
            timeout=seconds,
        )

    def compose(self, *words: str, seconds: float = 600) -> str:
        """Run `docker compose`; its output."""
        run = self.run("docker", "compose", *words, seconds=seconds)
        if run.returncode:
            raise RuntimeError(f"compose {' '.join(words)} ended with {run.returncode}: {run.stderr.strip()[-1500:]}")
        return run.stdout.strip()

    def up(self, **settings: str) -> None:
        """Bring the stack to what the file and these settings say, and wait until it is healthy."""
        self.write_settings(**settings)
        run = self.run("docker", "compose", "up", "--detach", "--wait", "--wait-timeout", "180")
        if run.returncode:
            logs = [f"{service}: {self.logs(service, 3)}" for service in self.compose("config", "--services").split()]
            raise RuntimeError("\n".join([f"up --wait: {run.stderr.strip().splitlines()[-1]}", *logs]))

    def write_settings(self, **settings: str) -> None:
        """Write `.env` with the settings that the trials need, and these."""
        words = (self.settings | settings).items()
        (self.folder / ".env").write_text("".join(f"{name}='{_quoted(value)}'\n" for name, value in words))

    def inside(self, service: str, *words: str, text: str | None = None, seconds: float = 120) -> Run:
        """Run a command in a running container."""
        return self.run("docker", "compose", "exec", "-T", service, *words, text=text, seconds=seconds)

    def python(self, program: str, service: str = "web", seconds: float = 120) -> str:
        """Output of a program in the container of the service."""
        run = self.inside(service, "python", "-", text=program, seconds=seconds)
        if run.returncode:
            raise RuntimeError(f"python in {service} ended with {run.returncode}: {run.stderr.strip()[-600:]}")
        return run.stdout.strip()

    def container(self, service: str) -> str:
        """Id of a container."""
        return self.compose("ps", "--all", "--quiet", service)

    def inspect(self, service: str) -> dict[str, Any]:
        """State of a container, as the engine has it."""
        result: list[dict[str, Any]] = json.loads(self.engine.docker("inspect", self.container(service)))
        return result[0]

    def logs(self, service: str, lines: int = 30) -> str:
        """The end of a container's log."""
        return self.compose("logs", "--no-log-prefix", "--tail", str(lines), service)

    def trust(self) -> ssl.SSLContext:
        """Context of a client that knows the certificate."""
        return ssl.create_default_context(cafile=str(self.folder / "certificates/fullchain.pem"))

    @contextmanager
    def client(self, seconds: float = 60) -> Iterator[httpx.Client]:
        """A client of the published port."""
        address = f"https://localhost:{self.https}"
        with httpx.Client(base_url=address, verify=self.trust(), timeout=seconds, trust_env=False) as client:
            yield client

    def status(self, path: str = "/readyz") -> int:
        """Status of an answer, 0 where there is none."""
        try:
            with self.client(20) as client:
                return client.get(path).status_code
        except httpx.TransportError:
            return 0

    def save(self, title: str) -> str:
        """Id of a selection that is saved now."""
        with self.client() as client:
            answer = client.post("/api/v1/selections", json={"application": worked_example(), "title": title})
        assert answer.status_code == 201, f"saving: {answer.status_code} {answer.text[:200]}"
        return str(answer.json()["id"])

    def has(self, id: str) -> bool:
        """True for a selection that is there."""
        with self.client() as client:
            status = client.get(f"/api/v1/selections/{id}").status_code
        assert status in (200, 404), status
        return status == 200

    def renew(self) -> None:
        """Put a new certificate where the proxy reads it, from links as letsencrypt makes them."""
        archive, live = self.folder.parent / "archive", self.folder.parent / "live"
        for folder in (archive, live):
            shutil.rmtree(folder, ignore_errors=True)
            folder.mkdir(mode=0o700)
        certify(archive)
        for name in ("fullchain.pem", "privkey.pem"):
            (archive / name).chmod(0o600)
            (live / name).symlink_to(archive / name)
        output = self.run("make", "certificates", f"FROM={live}")
        if output.returncode:
            raise RuntimeError(f"make certificates ended with {output.returncode}: {output.stderr.strip()[-600:]}")

    def down(self) -> None:
        """Remove containers, networks and volumes."""
        self.run("docker", "compose", "--profile", "backup", "down", "--volumes", "--remove-orphans", "--timeout", "5")


@contextmanager
def stack(engine: Engine, images: Images, tree: Path) -> Iterator[Stack]:
    """A stack of the files of a tree, not yet started; nothing of it is left when the block ends."""
    with tempfile.TemporaryDirectory(prefix="hpn-stack-") as name:
        folder = Path(name) / "hpn"
        _copy(tree, folder)
        Path(name).chmod(0o755)
        compose = folder / "docker-compose.yml"
        compose.write_text(images.of(compose.read_text()))
        dockerfile = folder / "backend/Dockerfile"
        dockerfile.write_text(images.with_machine(dockerfile.read_text()))
        _override(folder)
        https, http = _free_port(), _free_port()
        settings = {
            "POSTGRES_PASSWORD": PASSWORD,
            "PUBLISH": f"127.0.0.1:{https}",
            "PUBLISH_HTTP": f"127.0.0.1:{http}",
            "HPN_ALLOWED_HOSTS": "localhost",
            "COMPOSE_PROJECT_NAME": PROJECT,
        }
        output = Stack(engine, folder, https, http, settings)
        output.write_settings()
        (folder / "certificates").mkdir()
        certify(folder / "certificates")
        (folder / "certificates/privkey.pem").chmod(0o644)
        try:
            yield output
        finally:
            output.down()


def _copy(tree: Path, folder: Path) -> None:
    """Files of a checkout as they are now, without what git ignores."""
    listed = subprocess.run(
        ["git", "ls-files", "-z", "--cached", "--others", "--exclude-standard"],
        cwd=tree,
        check=True,
        capture_output=True,
    )
    for name in os.fsdecode(listed.stdout).split("\0"):
        if name and (tree / name).is_file():
            (folder / name).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy2(tree / name, folder / name)


def _override(folder: Path) -> None:
    """Add a file that names the image for these trials and has it built in this machine's network."""
    own = {"services": {"web": {"image": IMAGE, "build": {"network": "host"}}}}
    YAML().dump(own, folder / "docker-compose.override.yml")


def _quoted(value: str) -> str:
    return value.replace("'", "\\'")


def _free_port() -> int:
    with socket.socket() as value_held:
        value_held.bind(("127.0.0.1", 0))
        return int(value_held.getsockname()[1])

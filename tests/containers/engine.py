"""A container engine: the one that answers here, else one that is started and ends with the trials."""

import os
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path

from tests.containers.debian import Debian, UnavailableError, install

NEWEST_FILE = (2, 24)
"""Version of Compose that the file asks for."""

WAYS = ((), ("--storage-driver=vfs",), ("--storage-driver=vfs", "--iptables=false"))
"""To start dockerd, where a kernel lacks what the one before needs."""


@dataclass(frozen=True)
class Engine:
    """An engine, and the environment in which `docker` and `docker compose` reach it."""

    own: bool
    environment: dict[str, str] = field(repr=False)

    def docker(self, *words: str, check: bool = True, seconds: float = 600) -> str:
        """Run `docker`; its output."""
        command = ["docker", *words]
        run = subprocess.run(command, env=self.environment, capture_output=True, text=True, timeout=seconds)
        if check and run.returncode:
            message = f"{run.stdout[-1500:]}\n{run.stderr[-1500:]}".strip()
            raise RuntimeError(f"docker {words[0]} ended with {run.returncode}: {message}")
        return run.stdout.strip()

    @property
    def version(self) -> str:
        """Versions of engine and Compose, and how layers are kept."""
        server = self.docker("info", "--format", "Docker {{.ServerVersion}}, {{.Driver}}, cgroup v{{.CgroupVersion}}")
        return f"{server}, Compose {self.docker('compose', 'version', '--short')}"


@contextmanager
def engine(cache: Path, debian: Debian) -> Iterator[Engine]:
    """An engine with Compose, until the block ends; UnavailableError where there is none and none can be had."""
    with tempfile.TemporaryDirectory(prefix="hpn-engine-") as name:
        folder = Path(name)
        if _works(Engine(False, dict(os.environ)), "info"):
            yield _with_compose(Engine(False, dict(os.environ)), folder, debian)
            return
        install("docker.io", "dockerd")
        install("iptables")
        with _started(folder, cache / "engine") as started:
            yield _with_compose(started, folder, debian)


def _with_compose(engine: Engine, folder: Path, debian: Debian) -> Engine:
    """The engine with a Compose that reads the file; Debian's, where the machine has none or an older one."""
    if _works(engine, "compose", "version"):
        version = engine.docker("compose", "version", "--short").lstrip("v").split(".")
        if (int(version[0]), int(version[1])) >= NEWEST_FILE:
            return engine
    (program,) = debian.download("docker-compose", "trixie").glob("**/cli-plugins/docker-compose")
    plugins = folder / "client/cli-plugins"
    plugins.mkdir(parents=True)
    (plugins / "docker-compose").symlink_to(program)
    return Engine(engine.own, engine.environment | {"DOCKER_CONFIG": str(folder / "client")})


def _works(engine: Engine, *words: str) -> bool:
    try:
        engine.docker(*words, seconds=20)
    except (OSError, RuntimeError, subprocess.TimeoutExpired):
        return False
    return True


@contextmanager
def _started(folder: Path, data: Path) -> Iterator[Engine]:
    """An engine of our own; what it changes in the machine's network is undone with its end."""
    engine = Engine(True, os.environ | {"DOCKER_HOST": f"unix://{folder}/socket"})
    filters = "".join(_output("iptables-save", "-t", table) for table in ("filter", "nat"))
    forwards = Path("/proc/sys/net/ipv4/ip_forward")
    forwarding = forwards.read_text()
    daemon = _start(engine, folder, data)
    try:
        yield engine
    finally:
        for container in engine.docker("ps", "--all", "--quiet", check=False).split():
            engine.docker("rm", "--force", "--volumes", container, check=False)
        engine.docker("network", "prune", "--force", check=False)
        daemon.send_signal(signal.SIGTERM)
        daemon.wait(timeout=120)
        subprocess.run(["umount", str(folder / "run/netns/default")], capture_output=True)
        subprocess.run(["ip", "link", "delete", "docker0"], capture_output=True)
        subprocess.run(["iptables-restore"], input=filters, text=True, check=False)
        forwards.write_text(forwarding)


def _start(engine: Engine, folder: Path, data: Path) -> "subprocess.Popen[bytes]":
    data.mkdir(parents=True, exist_ok=True)
    log = folder / "dockerd.log"
    own = [
        f"--data-root={data}",
        f"--exec-root={folder}/run",
        f"--pidfile={folder}/pid",
        f"--host=unix://{folder}/socket",
    ]
    for way in WAYS:
        with log.open("ab") as output:
            # In a session of its own: Ctrl+C is for the trials, which then stop it in order.
            daemon = subprocess.Popen(["dockerd", *own, *way], stdout=output, stderr=output, start_new_session=True)
        answers = False
        try:
            answers = _answers(engine, daemon)
        finally:
            if not answers:
                daemon.kill()
                daemon.wait()
        if answers:
            return daemon
    print(log.read_text()[-2000:], file=sys.stderr)
    raise UnavailableError("dockerd does not start here; the end of its log stands above")


def _answers(engine: Engine, daemon: "subprocess.Popen[bytes]") -> bool:
    """True once it answers, False if it ends or takes half a minute."""
    for _ in range(60):
        if daemon.poll() is not None:
            break
        if _works(engine, "info"):
            return True
        time.sleep(0.5)
    return False


def _output(*command: str) -> str:
    return subprocess.run(command, check=True, capture_output=True, text=True).stdout

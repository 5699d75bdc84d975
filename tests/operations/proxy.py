"""nginx in front of a service: the command and the configuration of the compose file, on loopback."""

import os
import socket
import ssl
import subprocess
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from ruamel.yaml import YAML

from tests.operations.service import held_port

ROOT = Path(__file__).parents[2]
SERVICE: dict[str, Any] = YAML(typ="safe").load(ROOT / "docker-compose.yml")["services"]["proxy"]
HOST = "localhost"


@dataclass(frozen=True)
class Proxy:
    """A running nginx."""

    process: "subprocess.Popen[bytes]"
    http: int
    https: int
    folder: Path

    @property
    def url(self) -> str:
        """Its address."""
        return f"https://{HOST}:{self.https}"

    def trust(self, *protocols: str) -> ssl.SSLContext:
        """Context of a client that knows its certificate."""
        context = ssl.create_default_context(cafile=str(self.folder / "fullchain.pem"))
        if protocols:
            context.set_alpn_protocols(protocols)
        return context

    def connect(self, *protocols: str, source: str = "127.0.0.1", receiving: int = 0) -> ssl.SSLSocket:
        """A connection to it, with TLS, of a client that has room for so many bytes."""
        plain = socket.socket()
        if receiving:
            plain.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, receiving)
        plain.settimeout(20)
        plain.bind((source, 0))
        plain.connect(("127.0.0.1", self.https))
        return self.trust(*protocols).wrap_socket(plain, server_hostname=HOST)


@contextmanager
def proxied(service: int, balancers: str = "", names: str = f"{HOST},127.0.0.1", readers: str = "") -> Iterator[Proxy]:
    """Run the proxy before a service's port, behind load balancers at these addresses, until the block ends.

    It answers for these names, and for these readers of metrics.
    """
    with tempfile.TemporaryDirectory(prefix="hpn-nginx-") as name, held_port() as http, held_port() as https:
        folder = Path(name)
        folder.chmod(0o755)  # the workers of a root's nginx are somebody else
        certify(folder)
        own = {
            "PROXY_CONFIGURATION": str(ROOT / "backend/nginx.conf"),
            "PROXY_CERTIFICATES": name,
            "PROXY_HTTP": f"127.0.0.1:{http}",
            "PROXY_HTTPS": f"127.0.0.1:{https}",
            "PROXY_SERVICE": f"127.0.0.1:{service}",
            "PROXY_RESOLVER": "127.0.0.1",  # asks nobody: the service's address is no name
            "PROXY_NAMES": names,
            "PROXY_BALANCERS": balancers,
            "PROXY_READERS": readers,
        }
        command = [word.replace("$$", "$") for word in SERVICE["command"]]
        with (folder / "log").open("ab") as log:  # its two logs would write over each other
            process = subprocess.Popen(command, cwd=folder, env=os.environ | own, stdout=log, stderr=log)
        try:
            await_port(https, process, folder / "log")
            yield Proxy(process, http, https, folder)
        finally:
            process.terminate()
            process.wait(timeout=30)


def certify(folder: Path) -> None:
    """Make a certificate for loopback that lives two days."""
    command = "openssl req -x509 -newkey ec -pkeyopt ec_paramgen_curve:prime256v1 -nodes -days 2 -subj /CN=localhost"
    names = ["-addext", "subjectAltName=DNS:localhost,IP:127.0.0.1"]
    files = ["-keyout", f"{folder}/privkey.pem", "-out", f"{folder}/fullchain.pem"]
    subprocess.run([*command.split(), *names, *files], check=True, capture_output=True)


def await_port(port: int, process: "subprocess.Popen[bytes]", log: Path) -> None:
    """Wait until a process listens."""
    for _ in range(300):
        try:
            socket.create_connection(("127.0.0.1", port), 5).close()
            return
        except OSError:
            if process.poll() is not None:
                break
            time.sleep(0.1)
    raise RuntimeError(f"nginx did not start:\n{log.read_text()}")

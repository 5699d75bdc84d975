"""The audit, with the real pip-audit and npm, against databases on this machine that know or refuse."""

import json
import os
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from threading import Thread
from typing import Any

from tools.supply import locks
from tools.supply.audit import Audit, report

LOCK = locks.ROOT / "requirements-build.lock"
PACKAGES = locks.python(LOCK)
OF_PYPI = {
    "vulns": [
        {
            "id": "PYSEC-0000-1",
            "aliases": ["CVE-0000-1"],
            "summary": "made up",
            "affected": [{"package": {"name": "uv", "ecosystem": "PyPI"}}],
        }
    ]
}
OF_NPM = {
    "htmx.org": [
        {"id": 1, "url": "", "title": "Made up", "severity": "high", "vulnerable_versions": "*", "cwe": [], "cvss": {}}
    ]
}


def test_nothing_known_is_sound() -> None:
    assert report({"Python": Audit(2, [], []), "npm": Audit(1, [], [])}) == 0


def test_known_vulnerabilities_are_named() -> None:
    with databases(python=OF_PYPI, npm=OF_NPM) as address:
        audit = run(address)

    assert audit.returncode == 1, audit.stdout
    uv = next(package for package in PACKAGES if package.name == "uv")
    assert f"uv {uv.version}: PYSEC-0000-1 CVE-0000-1, mended in no version" in audit.stdout
    assert f"npm: {len(locks.page())} packages, 0 could not be looked up, 1 known" in audit.stdout
    assert "htmx.org : Made up" in audit.stdout


def test_a_database_that_refuses_is_no_sign_of_safety() -> None:
    with databases() as address:
        audit = run(address)

    assert audit.returncode == 3, audit.stdout
    assert f"Python: {len(PACKAGES)} packages, {len(PACKAGES)} could not be looked up" in audit.stdout
    assert "405" in audit.stdout
    assert "NOT AUDITED" in audit.stdout


def run(address: str) -> "subprocess.CompletedProcess[str]":
    """Audit a short lock, and the page's, at these databases."""
    environment = os.environ | {
        "PIP_AUDIT_VULNERABILITY_SERVICE": "osv",
        "PIP_AUDIT_OSV_URL": address,
        "npm_config_registry": address,
        "npm_config_fetch_retries": "0",
        "NO_PROXY": "127.0.0.1",
    }
    command = [sys.executable, "-m", "tools.supply.audit", LOCK.name]
    return subprocess.run(command, cwd=locks.ROOT, env=environment, capture_output=True, text=True)


@contextmanager
def databases(python: Any = None, npm: Any = None) -> Iterator[str]:
    """OSV's database and npm's, which answer this to every question, or refuse each."""

    class Handler(BaseHTTPRequestHandler):
        def do_POST(self) -> None:
            self.rfile.read(int(self.headers["Content-Length"]))
            self.send_response(200 if python else 405)
            self.end_headers()
            self.wfile.write(json.dumps(npm if "/npm/" in self.path else python).encode())

        def do_GET(self) -> None:
            self.send_error(404)

        def log_message(self, *_: object) -> None:
            """Print nothing."""

    server = ThreadingHTTPServer(("127.0.0.1", 0), Handler)
    thread = Thread(target=server.serve_forever)
    thread.start()
    yield f"http://127.0.0.1:{server.server_port}/"
    server.shutdown()
    thread.join()
    server.server_close()

"""Plans of make, which are not carried out."""

import os
import subprocess
from pathlib import Path

import pytest

from hpn.words.reader import path_of
from tools import messages

ROOT = Path(__file__).parents[2]


def planned(target: str, **environment: str) -> str:
    """Commands of a target, which are not run."""
    own = ("HPN_", "MAKE", "MFLAGS", "HOST", "PORT")
    clean = {name: value for name, value in os.environ.items() if not name.startswith(own)}
    return subprocess.run(
        ["make", "--dry-run", target], cwd=ROOT, env=clean | environment, capture_output=True, text=True, check=True
    ).stdout


@pytest.mark.parametrize(
    ("environment", "address"),
    [
        ({}, '--host "127.0.0.1" --port "8000"'),
        ({"HPN_HOST": "::1", "HPN_PORT": "8123"}, '--host "::1" --port "8123"'),
        ({"HPN_PORT": "8123", "PORT": "8124"}, '--host "127.0.0.1" --port "8124"'),
    ],
)
def test_run_listens_where_make_or_the_settings_say(environment: dict[str, str], address: str) -> None:
    assert address in planned("run", **environment)


def test_a_plain_users_path_leads_to_the_installed_proxy() -> None:
    looking = ["make", "--eval", "found:;@command -v nginx", "found"]

    result = subprocess.run(looking, cwd=ROOT, env={"PATH": "/usr/bin:/bin"}, check=False)

    assert result.returncode == 0


PYTEST = """#!/bin/sh
echo "$*" >> "$0.calls"
case "$*" in tests/browser/test_lighthouse.py|"--soak tests/browser/test_lighthouse.py") exit 0 ;; esac
exit 1
"""
INSTALLED = ("install", "browser", "office", "curl", "nginx", "pdfua")


@pytest.mark.parametrize(
    ("target", "failed"),
    [
        ("test", ["together", "another-processor", "browsers"]),
        ("soak", ["under-load", "together", "browsers", "last-bits-up", "last-bits-down", "last-bits-mixed"]),
    ],
)
def test_a_part_that_fails_keeps_no_other_from_running_and_is_named_at_the_end(
    target: str, failed: list[str], tmp_path: Path
) -> None:
    for name, program in (("pytest", PYTEST), ("python", "#!/bin/sh\necho AVX2\n")):
        (tmp_path / name).write_text(program)
        (tmp_path / name).chmod(0o755)
    old = [word for name in INSTALLED for word in ("--old-file", name)]  # nothing is installed for this
    clean = {name: value for name, value in os.environ.items() if not name.startswith(("MAKE", "MFLAGS", "PYTEST"))}

    run = subprocess.run(
        ["make", *old, target, f"BIN={tmp_path}"], cwd=ROOT, env=clean, capture_output=True, text=True, timeout=60
    )

    assert run.returncode != 0
    assert len((tmp_path / "pytest.calls").read_text().splitlines()) == len(failed) + 1
    values = [line for line in run.stderr.splitlines() if "failed" in line]
    assert values == [f"make {target}: failed: {name}" for name in failed]
    assert run.stderr.splitlines()[-1].startswith("make: ***")


def test_clean_takes_nothing_that_git_tracks() -> None:
    assert "bench-results.json" not in planned("clean")


def test_messages_leaves_the_date_of_a_catalogue_alone(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    before = path_of("de").read_text()
    written = tmp_path / "hpn.po"
    monkeypatch.setattr("tools.messages.path_of", lambda code: written)

    messages.update("de")

    (date,) = [line for line in written.read_text().splitlines() if "POT-Creation-Date" in line]
    assert date in before

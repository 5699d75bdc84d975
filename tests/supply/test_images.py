"""Base images: named once and by digest, and `make digests` writes newer ones. No image registry is at hand."""

import os
import re
import shutil
import subprocess
from pathlib import Path

ROOT = Path(__file__).parents[2]
FILES = ("docker-compose.yml", "backend/Dockerfile")
PINNED = re.compile(r"[a-z]+:[\w.-]+@sha256:[0-9a-f]{64}")
NEWER = "sha256:" + "0123456789abcdef" * 4


def named(folder: Path) -> list[str]:
    """Images that compose file and Dockerfile take from elsewhere, as often as they are named."""
    compose, dockerfile = ((folder / name).read_text() for name in FILES)
    images = re.findall(r"^FROM (\S+)|^(?: +image:|x-\w+: &\w+) ([^\s*]\S*)$", f"{dockerfile}\n{compose}", re.M)
    return [built or taken for built, taken in images if taken != "hpn-select"]


def test_every_image_is_named_once_and_by_digest() -> None:
    images = named(ROOT)

    assert {image.partition(":")[0] for image in images} >= {"python", "postgres", "nginx"}
    assert [image for image in images if not PINNED.fullmatch(image)] == []
    assert sorted(set(images)) == sorted(images)


def test_make_digests_writes_the_digest_of_each_tag(tmp_path: Path) -> None:
    outcome = digests(tmp_path, f"echo {NEWER}")

    assert outcome.returncode == 0, outcome.stderr
    assert named(tmp_path) == [re.sub("@.*", f"@{NEWER}", image) for image in named(ROOT)]


def test_make_digests_changes_nothing_where_no_registry_answers(tmp_path: Path) -> None:
    outcome = digests(tmp_path, "exit 1")

    assert outcome.returncode != 0
    assert "no digest" in outcome.stderr
    assert named(tmp_path) == named(ROOT)


def digests(folder: Path, answer: str) -> "subprocess.CompletedProcess[str]":
    """Run the target on copies in a folder, with an engine's client that answers this."""
    for name in ("Makefile", *FILES):
        (folder / name).parent.mkdir(exist_ok=True)
        shutil.copy(ROOT / name, folder / name)
    client = folder / "bin" / "docker"
    client.parent.mkdir()
    client.write_text(f"#!/bin/sh\n{answer}\n")
    client.chmod(0o755)
    environment = {"PATH": f"{client.parent}:{os.environ['PATH']}", "HOME": str(folder)}
    return subprocess.run(["make", "digests"], cwd=folder, env=environment, capture_output=True, text=True)

"""Certificates as people have them: `make certificates` checks and prepares them, the proxy says what is wrong."""

import os
import shutil
import subprocess
import tempfile
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from tests.operations.proxy import SERVICE, certify

ROOT = Path(__file__).parents[2]
BY_ROOT = os.geteuid() == 0
FILES = ("fullchain.pem", "privkey.pem")


@pytest.fixture
def folder() -> Iterator[Path]:
    """A folder that every user can look into, with the certificate and key of a live folder: mode 600, by links."""
    with tempfile.TemporaryDirectory(prefix="hpn-certificates-") as name:
        folder = Path(name)
        folder.chmod(0o755)
        (folder / "archive").mkdir()
        (folder / "live").mkdir()
        certify(folder / "archive")
        for file in FILES:
            (folder / "archive" / file).chmod(0o600)
            (folder / "live" / file).symlink_to(f"../archive/{file}")
        yield folder


def prepared(folder: Path, source: str = "live") -> "subprocess.CompletedProcess[str]":
    """Outcome of what `make certificates FROM=source` runs, in the folder."""
    command = ["sh", str(ROOT / "backend/certificates.sh"), source]
    return subprocess.run(command, cwd=folder, capture_output=True, text=True)


def started(folder: Path) -> "subprocess.CompletedProcess[str]":
    """Outcome of the proxy's start, as its user, up to where it would serve."""
    user = ["setpriv", "--reuid=101", "--regid=101", "--clear-groups"] if BY_ROOT else []
    own = {
        # User 101 may have no way into the checkout.
        "PROXY_CONFIGURATION": str(shutil.copy(ROOT / "backend/nginx.conf", folder)),
        "PROXY_CERTIFICATES": str(folder / "certificates"),
        "PROXY_HTTP": "127.0.0.1:18080",
        "PROXY_HTTPS": "127.0.0.1:18443",
        "PROXY_SERVICE": "127.0.0.1:1",
        "PROXY_RESOLVER": "127.0.0.1",
        "PROXY_NAMES": "localhost",
        "PROXY_BALANCERS": "",
        "PROXY_READERS": "",
    }
    command = [word.replace("$$", "$").replace("exec nginx", "exec nginx -t") for word in SERVICE["command"]]
    with tempfile.TemporaryDirectory(prefix="hpn-nginx-") as work:
        os.chmod(work, 0o777)
        log = Path(work, "log")
        log.touch()
        log.chmod(0o666)  # nginx opens its output again
        with log.open("w") as output:
            return subprocess.run(
                [*user, *command], cwd=work, env=os.environ | own, stdout=output, stderr=subprocess.PIPE, text=True
            )


def test_the_files_of_a_live_folder_become_readable_for_the_proxy_and_for_it_alone(folder: Path) -> None:
    outcome = prepared(folder)

    if not BY_ROOT:
        assert "sudo make certificates FROM=live" in outcome.stderr
        return
    assert outcome.returncode == 0, outcome.stderr
    assert "notAfter=" in outcome.stdout
    certificate, key = (folder / "certificates" / file for file in FILES)
    assert not certificate.is_symlink()
    assert (key.stat().st_uid, key.stat().st_mode & 0o777) == (101, 0o400)
    assert started(folder).returncode == 0, started(folder).stderr


def test_files_that_stand_in_the_folder_already_are_put_right_there(folder: Path) -> None:
    (folder / "certificates").mkdir()
    for file in FILES:
        (folder / "certificates" / file).symlink_to(f"../archive/{file}")

    assert prepared(folder, "certificates").returncode == (0 if BY_ROOT else 1)
    assert (folder / "certificates/privkey.pem").is_symlink() is not BY_ROOT


def missing(live: Path) -> None:
    (live / "privkey.pem").unlink()


def dangling(live: Path) -> None:
    shutil.rmtree(live.parent / "archive")


def swapped(live: Path) -> None:
    (live / "fullchain.pem").rename(live / "other")
    (live / "privkey.pem").rename(live / "fullchain.pem")


def with_a_passphrase(live: Path) -> None:
    openssl = "openssl pkey -aes256 -passout pass:secret -in privkey.pem -out locked.pem"
    subprocess.run(openssl.split(), cwd=live, check=True, capture_output=True)
    (live / "locked.pem").rename(live / "privkey.pem")


def of_another(live: Path) -> None:
    openssl = "openssl genpkey -algorithm EC -pkeyopt ec_paramgen_curve:prime256v1 -out other.pem"
    subprocess.run(openssl.split(), cwd=live, check=True, capture_output=True)
    (live / "other.pem").rename(live / "privkey.pem")


def expired(live: Path) -> None:
    openssl = "openssl x509 -in fullchain.pem -signkey privkey.pem -days -1 -out old.pem"
    subprocess.run(openssl.split(), cwd=live, check=True, capture_output=True)
    (live / "old.pem").rename(live / "fullchain.pem")


@pytest.mark.parametrize(
    ("spoil", "words"),
    [
        (missing, "live/privkey.pem is missing"),
        (dangling, "live/fullchain.pem is missing"),
        (swapped, "live/privkey.pem is missing"),
        (with_a_passphrase, "live/privkey.pem must be a key in PEM without a passphrase"),
        (of_another, "live/privkey.pem is the key of another certificate"),
        (expired, "live/fullchain.pem has expired: notAfter="),
    ],
)
def test_a_wrong_certificate_is_named_in_a_sentence_and_not_copied(
    folder: Path, spoil: Callable[[Path], None], words: str
) -> None:
    spoil(folder / "live")

    outcome = prepared(folder)

    assert outcome.returncode == 1
    (line,) = outcome.stderr.splitlines()
    assert words in line
    assert not (folder / "certificates").exists()


@pytest.mark.parametrize("file", FILES)
def test_the_proxy_says_in_a_sentence_which_file_it_can_not_read(folder: Path, file: str) -> None:
    certificates = folder / "certificates"
    shutil.copytree(folder / "archive", certificates)
    for each in FILES:
        (certificates / each).chmod(0o644 if each != file else 0)

    unreadable = started(folder)
    (certificates / file).unlink()
    (certificates / file).symlink_to("../../archive/none.pem")
    leads_nowhere = started(folder)

    for outcome in (unreadable, leads_nowhere):
        (line,) = outcome.stderr.splitlines()
        assert outcome.returncode == 1
        assert line.startswith(f"certificates/{file} is missing, a link, or not readable for user ")
        assert "make certificates" in line


def test_the_proxy_names_the_key_that_does_not_belong_to_the_certificate(folder: Path) -> None:
    certificates = folder / "certificates"
    shutil.copytree(folder / "archive", certificates)
    of_another(certificates)
    for each in FILES:
        (certificates / each).chmod(0o644)

    outcome = started(folder)

    assert outcome.returncode == 1
    assert "certificates/privkey.pem" in outcome.stderr
    assert "key values mismatch" in outcome.stderr

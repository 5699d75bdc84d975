"""The settings, as the example file and docs/settings.md list them."""

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest
from pydantic import ValidationError

from hpn.cli import main
from hpn.web.settings import Settings
from tests.reliability.faults import as_user

ROOT = Path(__file__).parents[2]
OF_COMPOSE_ALONE = {
    *("POSTGRES_PASSWORD", "PUBLISH", "PUBLISH_HTTP", "LOAD_BALANCERS", "SPOOL_SIZE", "WEB_MEMORY"),
    *("METRICS_FROM", "BACKUP_HOURS", "BACKUP_KEEP"),
}
NAMES = {f"HPN_{name.upper()}" for name in Settings.model_fields}


def example() -> dict[str, str]:
    """Variables of the example file, set or commented out."""
    lines = re.findall(r"^#?([A-Z_]+)=(.*)$", (ROOT / ".env.example").read_text(), re.M)
    assert len(lines) == len(dict(lines))
    return dict(lines)


def test_the_example_file_has_every_setting_and_no_other() -> None:
    assert set(example()) == NAMES | OF_COMPOSE_ALONE


def test_the_example_file_shows_the_defaults(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(ROOT)
    for name, value in example().items():
        monkeypatch.setenv(name, value)
    view, default = Settings(), Settings.model_construct()

    for name in set(Settings.model_fields) - {"catalogue_folder"}:
        assert getattr(view, name) == getattr(default, name), name
    assert view.catalogue_folder.resolve() == default.catalogue_folder


def test_the_compose_file_names_no_variable_of_the_service_that_is_no_setting() -> None:
    named = set(re.findall(r"\bHPN_[A-Z_]+", (ROOT / "docker-compose.yml").read_text()))

    assert named <= NAMES


def test_the_page_on_settings_lists_every_one() -> None:
    listed = set(re.findall(r"^\| `(HPN_[A-Z_]+)` \|", (ROOT / "docs/settings.md").read_text(), re.M))

    assert listed == NAMES


def test_every_setting_is_described() -> None:
    assert [name for name, field in Settings.model_fields.items() if not field.description] == []


@pytest.mark.parametrize(
    ("name", "value", "words"),
    [
        ("cors_origins", "plm.example", "such as https://plm.example"),
        ("cors_origins", "https://erp.example https://plm.example/", "'https://plm.example/' is none"),
        ("cors_origins", "https://plm.example/app", "no path"),
        ("cors_origins", "https://PLM.example", "small letters"),
        ("cors_origins", "https://plm.example:443", "a port unless it is the usual one"),
        ("allowed_hosts", "https://plm.example", "without scheme"),
        ("allowed_hosts", "plm.example:8443", "port"),
        ("allowed_hosts", "*", "such as plm.example"),
        ("allowed_hosts", "PLM.example", "small letters"),
        ("trusted_proxies", "not-an-ip", "such as 10.0.0.0/8"),
        ("trusted_proxies", "10.0.0.1/8", "has host bits set"),
        ("trusted_proxies", "*,10.0.0.1", "alone"),
        ("spool_folder", "/there/is/none", "exists"),
        ("spool_folder", __file__, "must be a folder"),
        ("secrets_folder", "/there/is/none", "exists"),
        ("secrets_folder", __file__, "must be a folder"),
        ("batch_rate", "0/minute", "at least 1"),
        ("batch_rate", "5/minute;1/second", "one rate"),
        ("batch_rate", "often", "such as 120/minute"),
    ],
)
def test_a_setting_that_would_do_nothing_is_refused_and_told_what_would_be_right(
    name: str, value: str, words: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv(f"HPN_{name.upper()}", value)

    with pytest.raises(ValidationError) as caught:
        Settings()

    (entry,) = caught.value.errors()
    assert entry["loc"] == (name,)
    assert words in entry["msg"]


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("cors_origins", "http://localhost:5173, https://plm.example:8443 http://[::1]:8000 app://plm"),
        ("cors_origins", "*"),
        ("trusted_proxies", "127.0.0.1, 10.0.0.0/8 2001:db8::/32 ::1"),
        ("trusted_proxies", "*"),
        ("allowed_hosts", "plm.example, *.plm.example 10.0.0.7 [2001:db8::1]"),
        ("spool_folder", str(ROOT)),
        ("batch_rate", "1200 per 2 hours"),
    ],
)
def test_right_values_are_taken(name: str, value: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv(f"HPN_{name.upper()}", value)

    assert getattr(Settings(), name)


@pytest.mark.parametrize(
    ("name", "intended_name"),
    [("HPN_API_KEY", "HPN_API_KEYS"), ("HPN_WORKER", "HPN_WORKERS"), ("hpn_database", "HPN_DATABASE_URL")],
)
def test_a_misspelt_variable_keeps_the_service_from_starting(
    name: str, intended_name: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv(name, "1")

    assert main(["serve"]) == 2
    assert capsys.readouterr().err == f"{name} is not a setting; it looks like {intended_name}\n"


SERVICE = {
    "HPN_PORT": "tcp://10.96.0.7:8000",
    "HPN_SERVICE_HOST": "10.96.0.7",
    "HPN_SERVICE_PORT": "8000",
    "HPN_SERVICE_PORT_HTTP": "8000",
    "HPN_PORT_8000_TCP": "tcp://10.96.0.7:8000",
    "HPN_PORT_8000_TCP_PROTO": "tcp",
    "HPN_PORT_8000_TCP_PORT": "8000",
    "HPN_PORT_8000_TCP_ADDR": "10.96.0.7",
}
"""Variables that Kubernetes sets beside a service named hpn."""


@pytest.mark.parametrize("service", ["HPN", "HPN_DB", "HPN_DATABASE", "HPN_SELECT", "HPN_WEB"])
def test_variables_that_kubernetes_sets_beside_a_service_change_nothing(
    service: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    before = Settings()
    for name, value in SERVICE.items():
        monkeypatch.setenv(name.replace("HPN", service), value)

    assert Settings() == before


def test_a_setting_is_read_from_a_file_unless_a_variable_gives_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("HPN_SECRETS_FOLDER", str(tmp_path))
    (tmp_path / "..data").mkdir()  # as Kubernetes mounts them
    (tmp_path / "..data/hpn_database_password").write_text("ü@:/?#\n")
    (tmp_path / "hpn_database_password").symlink_to("..data/hpn_database_password")
    (tmp_path / "hpn_api_keys").write_text(f"erp:{'0' * 64}\nplm:{'1' * 64}\n")
    (tmp_path / "hpn_port").write_text("8001")
    (tmp_path / "of_another_program").write_bytes(b"\xff")
    monkeypatch.setenv("HPN_PORT", "8002")

    settings = Settings()

    assert settings.database()["password"] == "ü@:/?#"
    assert [key.name for key in settings.api_keys] == ["erp", "plm"]
    assert settings.port == 8002


@pytest.mark.parametrize(
    ("name", "content", "words"),
    [
        ("hpn_api_keys", b"erp", "hpn_api_keys: "),
        ("hpn_port", b"many", "hpn_port: "),
        ("hpn_port", b"", "hpn_port: "),
        ("hpn_database_password", b"\xff\xfe", "hpn_database_password: can’t be read: "),
        ("hpn_database_password", None, "hpn_database_password: can’t be read: "),
        ("hpn_api_key", b"erp", "hpn_api_key is not a setting; it looks like HPN_API_KEYS"),
    ],
)
def test_a_file_that_can_not_be_meant_keeps_the_service_from_starting(
    name: str,
    content: bytes | None,
    words: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.setenv("HPN_SECRETS_FOLDER", str(tmp_path))
    if content is None:
        (tmp_path / name).mkdir()
    else:
        (tmp_path / name).write_bytes(content)

    assert main(["serve"]) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert words in line
    assert line.startswith(str(tmp_path))
    assert "made a mistake" not in line


@pytest.mark.parametrize("name", ["secrets", "secrets/inside"])
def test_a_folder_of_secrets_that_can_not_be_read_is_not_taken_for_one_without_keys(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr("hpn.web.settings.SECRETS", tmp_path / name)
    monkeypatch.setattr(Path, "is_dir", os.path.isdir)  # as from Python 3.14 on: False where this user may not look
    (tmp_path / name).mkdir(parents=True)
    (tmp_path / "secrets").chmod(0)
    with as_user(65534):
        code = main(["catalogue"])

    assert code == 2
    assert f"{tmp_path}/secrets" in capsys.readouterr().err


def test_variables_of_others_are_left_alone(monkeypatch: pytest.MonkeyPatch) -> None:
    for name in ("HPN_KEY", "HPN_CUSTOMER", "hpn_port"):
        monkeypatch.setenv(name, "1")

    assert Settings().port == 1


def test_no_setting_of_the_machine_reaches_the_tests() -> None:
    settings = {"HPN_CATALOGUE_SUPPLEMENT": "/there/is/none", "hpn_api_keys": "erp"}
    tests = "-p no:cacheprovider tests/unit/test_cli.py -k version_names"
    command = [sys.executable, "-m", "pytest", *tests.split()]

    run = subprocess.run(command, cwd=ROOT, env=os.environ | settings, capture_output=True, text=True, timeout=120)

    assert run.returncode == 0, run.stdout

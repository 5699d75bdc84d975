"""Answers on the published port, and the confinement of its containers."""

import socket
import ssl
import time

import httpx

from hpn import ENGINE_VERSION
from tests.build import worked_example
from tests.containers.stack import IMAGE, Stack
from tests.containers.trials import trial

SERVICES = ("proxy", "web", "db")
WRITABLE = {
    "proxy": {"/tmp"},
    "web": {"/tmp", "/data"},
    "db": {"/tmp", "/run/postgresql", "/var/lib/postgresql/data"},
}
WRITABLE_NOW = r"find / \( -path /proc -o -path /dev -o -path /sys \) -prune -o -type d -writable -print"
UNBOUNDED = 2**60
"""From here on a limit of version 1 of the kernel's control groups is none."""


@trial("TLS 1.2 and 1.3 answer, 1.1 does not; HTTP/2 and 1.1; plain HTTP leads to TLS")
def tls(stack: Stack) -> str:
    """Versions that are agreed on."""
    agreed = []
    for version in (ssl.TLSVersion.TLSv1_2, ssl.TLSVersion.TLSv1_3):
        agreed.append(f"{_agreed(stack, version, ['h2', 'http/1.1'])}")
    assert [each.split()[0] for each in agreed] == ["TLSv1.2", "TLSv1.3"], agreed
    assert all(each.endswith(" h2") for each in agreed), agreed
    assert _agreed(stack, ssl.TLSVersion.TLSv1_3, ["http/1.1"]).endswith(" http/1.1")
    try:
        old = _agreed(stack, ssl.TLSVersion.TLSv1_1, [])
    except ssl.SSLError:
        old = ""
    assert not old, old
    answer = httpx.get(f"http://127.0.0.1:{stack.http}/?T=40", headers={"Host": "localhost"}, trust_env=False)
    assert (answer.status_code, answer.headers["location"]) == (308, "https://localhost/?T=40"), answer.headers
    with stack.client() as client:
        assert "max-age" in client.get("/").headers["strict-transport-security"]
    return ", ".join(agreed)


def _agreed(stack: Stack, version: ssl.TLSVersion, protocols: list[str]) -> str:
    context = stack.trust()
    context.minimum_version = context.maximum_version = version
    context.set_ciphers("ALL:@SECLEVEL=0" if version < ssl.TLSVersion.TLSv1_2 else "DEFAULT")
    context.set_alpn_protocols(protocols)
    with (
        socket.create_connection(("127.0.0.1", stack.https), 10) as plain,
        context.wrap_socket(plain, server_hostname="localhost") as connection,
    ):
        return f"{connection.version()} {connection.selected_alpn_protocol()}"


@trial("page with its styles, selection, report, batch of lines, fleet, saved selection")
def answers(stack: Stack) -> str:
    """Every kind of answer."""
    application = worked_example()
    fleet = "axis,torque_Nm,speed_rpm,duration_s\n" + "".join(f'{n},"[40]","[250]","[2]"\n' for n in range(500))
    with stack.client() as client:
        page = client.get("/")
        styles = [client.get(path).status_code for path in _links(page.text)]
        select = client.post("/api/v1/select", json=application)
        report = client.post("/api/v1/report.pdf", json=application)
        lines = client.post(
            "/api/v1/select/batch",
            content=b"".join(httpx.Request("POST", "http://x", json=application).content + b"\n" for _ in range(50)),
            headers={"Content-Type": "application/x-ndjson"},
        )
        sized = client.post("/api/v1/fleet", content=fleet, headers={"Content-Type": "text/csv"})
    assert page.status_code == select.status_code == 200, (page.status_code, select.status_code)
    assert styles and set(styles) == {200}, styles
    assert report.content.startswith(b"%PDF"), (report.status_code, report.text[:200])
    assert lines.status_code == 200 and lines.content.count(b"\n") == 50, (lines.status_code, lines.text[:200])
    assert sized.status_code == 200 and sized.content.count(b"\n") == 501, (sized.status_code, sized.text[:200])
    assert stack.has(stack.save("as an operator sees it"))
    return f"{len(styles)} files of the page"


def _links(page: str) -> list[str]:
    return [word.split('"')[0] for word in page.split('"') if word.startswith("/static/")]


@trial("every process has a user without rights, and can get none")
def users(stack: Stack) -> str:
    """Users of the containers."""
    result = []
    for service in SERVICES:
        status = stack.inside(service, "sh", "-c", "cat /proc/[0-9]*/status").stdout
        fields = [line.split() for line in status.splitlines()]
        users = {words[1] for words in fields if words and words[0] == "Uid:"}
        rights = {words[1] for words in fields if words and words[0] in ("CapEff:", "CapPrm:", "CapBnd:")}
        locked = {words[1] for words in fields if words and words[0] == "NoNewPrivs:"}
        assert users and "0" not in users, (service, users)
        assert rights == {"0" * 16} and locked == {"1"}, (service, rights, locked)
        result.append(f"{service} {'/'.join(sorted(users))}")
    return ", ".join(result)


@trial("nothing is writable but what the file says")
def folders(stack: Stack) -> str:
    """Folders that can be written to."""
    message = []
    for service in SERVICES:
        writable = set(stack.inside(service, "sh", "-c", WRITABLE_NOW).stdout.split())
        tops = {path for path in writable if not any(path.startswith(f"{other}/") for other in writable)}
        assert tops <= WRITABLE[service], (service, tops - WRITABLE[service])
        refused = stack.inside(service, "touch", "/etc/trial", "/usr/trial")
        assert refused.returncode and "Read-only" in refused.stderr, (service, refused.stderr)
        message.append(f"{service} {' '.join(sorted(tops))}")
    return "; ".join(message)


@trial("limits of memory and processes are the engine's, without swap")
def limits(stack: Stack) -> str:
    """Memory and processes of the containers."""
    message = []
    for service in SERVICES:
        inputs = stack.inspect(service)["HostConfig"]
        memory, swap, processes = inputs["Memory"], inputs["MemorySwap"], inputs["PidsLimit"]
        assert 0 < memory < UNBOUNDED and processes, (service, memory, processes)
        assert swap == memory, f"{service} may swap: memory {memory}, with swap {swap}"
        message.append(f"{service} {memory >> 20} MiB, {processes} processes")
    return "; ".join(message)


@trial("a program that takes all memory or processes is refused, and the service goes on")
def greedy(stack: Stack) -> str:
    """Ends of the greedy processes."""
    before = {service: stack.inspect(service)["State"]["StartedAt"] for service in SERVICES}
    message = []
    for service in ("proxy", "db"):
        limit = stack.inspect(service)["HostConfig"]["Memory"]
        eaten = stack.inside(service, "sh", "-c", f"head -c {2 * limit} /dev/zero | tail > /dev/null; echo $?")
        assert eaten.stdout.strip() == "137", (service, eaten.stdout, eaten.stderr)
        message.append(f"{service}: killed at {limit >> 20} MiB")
    bomb = "i=0; while [ $i -lt 600 ]; do sleep 5 & i=$((i+1)); done; echo all"
    for service in SERVICES:
        many = stack.inside(service, "sh", "-c", bomb)
        assert "all" not in many.stdout, service
        assert "fork" in many.stderr, (service, many.stderr[-200:])
    time.sleep(6)  # until they are gone
    assert stack.status() == 200
    now = {service: stack.inspect(service)["State"]["StartedAt"] for service in SERVICES}
    assert now == before, "a container was started again"
    return "; ".join(message)


@trial("only the proxy is published, on the address given; web and db lead nowhere else")
def networks(stack: Stack) -> str:
    """Ports that are published."""
    published = {}
    for service in SERVICES:
        ports = stack.inspect(service)["NetworkSettings"]["Ports"] or {}
        bound = [each for some in ports.values() for each in some or ()]
        published[service] = sorted(f"{each['HostIp']}:{each['HostPort']}" for each in bound)
    own = sorted([f"127.0.0.1:{stack.https}", f"127.0.0.1:{stack.http}"])
    assert published == {"proxy": own, "web": [], "db": []}, published
    for service in ("web", "db"):
        for network in stack.inspect(service)["NetworkSettings"]["Networks"]:
            internal = stack.engine.docker("network", "inspect", "--format", "{{.Internal}}", network)
            assert internal == "true", f"{service} is in {network}, which leads out"
    assert stack.inside("proxy", "getent", "hosts", "db").returncode, "the proxy knows the database"
    assert not stack.inside("proxy", "getent", "hosts", "web").returncode
    return ", ".join(own)


@trial("the image has no pip and no compiler, and says which version it is")
def image(stack: Stack) -> str:
    """Its version."""
    search = "for each in pip pip3 uv cc gcc make; do command -v $each; done; python -c 'import pip' 2>&1"
    result = stack.inside("web", "sh", "-c", search).stdout
    assert "No module named 'pip'" in result, result
    programs = [line for line in result.splitlines() if line.startswith("/")]
    assert not programs, programs
    label = '{{index .Config.Labels "org.opencontainers.image.version"}}'
    message = stack.engine.docker("image", "inspect", "--format", label, IMAGE)
    with stack.client() as client:
        runs = client.get("/readyz").json()["engine_version"]
    assert message == runs == ENGINE_VERSION, (message, runs)
    return message


@trial("the image alone starts read-only with any user of group 0, and beside a Kubernetes service named hpn")
def anywhere(stack: Stack) -> str:
    """Users with whom it started."""
    alone = ["run", "--detach", "--read-only", "--tmpfs=/tmp", "--cap-drop=ALL", "--network=none", "--volume=/data"]
    ways = {"10001:10001": "8000", "123456:0": "8000", "123457:0": "tcp://10.0.0.1:8000"}
    for user, port in ways.items():
        name = stack.engine.docker(*alone, "--user", user, "--env", f"HPN_PORT={port}", IMAGE)
        try:
            _await_healthy(stack, name)
        finally:
            stack.engine.docker("rm", "--force", "--volumes", name)
    return ", ".join(ways)


def _await_healthy(stack: Stack, name: str) -> None:
    for _ in range(60):
        state = stack.engine.docker("inspect", "--format", "{{.State.Status}} {{.State.Health.Status}}", name)
        if state == "running healthy":
            return
        if not state.startswith("running"):
            break
        time.sleep(1)
    logs = stack.run("docker", "logs", "--tail", "5", name)
    raise AssertionError(f"{state}: {logs.stdout[-600:]}{logs.stderr[-600:]}")

"""Work of an operator: certificates, backups, a full spool, another address, the end, a new password."""

import contextlib
import os
import ssl
import threading
import time

import httpx

from tests.containers.stack import Stack
from tests.containers.trials import trial

RELOAD = "exec -T proxy nginx -p /tmp/ -c /tmp/nginx.conf -s reload"
SPOOL_BYTES = 8_000_000
LATER_S = 8.0
"""Longest that a database which is away delays a start; HPN_DATABASE_SECONDS is 5."""

FOUND_AGAIN_S = 30.0
UNFINISHED = ".unfinished."
"""Beginning of the name of a file that is being written."""

GRACE_S = 38.0
"""A stop that takes longer was no end but a kill: the file gives 40 s."""


@trial("a new certificate is served after a reload, and no connection breaks")
def certificate(stack: Stack) -> str:
    """Time for which the old certificate was served."""
    before = _served(stack)
    with stack.client() as client:
        assert client.get("/healthz").status_code == 200
        stack.renew()
        stack.compose(*RELOAD.split())
        start = time.monotonic()
        while _served(stack) == before:
            assert time.monotonic() - start < 20, "the old certificate is still served"
            time.sleep(0.1)
        waited = time.monotonic() - start
    assert stack.status() == 200
    return f"after {waited:.1f} s"


@trial("a key that the proxy can't read is named in its log; make certificates mends it")
def unreadable(stack: Stack) -> str:
    """Text of the log."""
    key = stack.folder / "certificates/privkey.pem"
    key.chmod(0o600)
    os.chown(key, 0, 0)
    stack.compose("restart", "proxy")
    end = time.monotonic() + 30
    while "make certificates" not in (message := stack.logs("proxy", 1)):
        assert time.monotonic() < end, message
        time.sleep(0.5)
    output = stack.run("make", "certificates")
    assert output.returncode == 0, output.stderr
    end = time.monotonic() + 60
    while stack.status() != 200:
        assert time.monotonic() < end, stack.logs("proxy", 3)
        time.sleep(0.5)
    return message


def _served(stack: Stack) -> str:
    return ssl.get_server_certificate(("127.0.0.1", stack.https))


@trial("a backup brings back what was deleted; refused while web runs; the database from before is kept")
def restore(stack: Stack) -> str:
    """Names of the backup and of the database that is kept."""
    record = stack.save("before the backup")
    name = stack.compose("run", "--rm", "backup").splitlines()[-1]
    assert name in stack.compose("run", "--rm", "backup", "ls")
    later = stack.save("after the backup")
    with stack.client() as client:
        assert client.delete(f"/api/v1/selections/{record}").status_code == 204
    refused = stack.run("make", "restore", f"NAME={name}")
    assert refused.returncode and "web" in refused.stderr, (refused.returncode, refused.stderr[-300:])
    assert stack.has(later) and not stack.has(record)
    stack.compose("stop", "web")
    outcome = stack.run("make", "restore", f"NAME={name}")
    assert outcome.returncode == 0, outcome.stderr[-800:]
    stack.up()
    assert stack.has(record) and not stack.has(later)
    stack.save("after the restore")
    old = [each for each in _databases(stack) if each.startswith("hpn_")]
    assert len(old) == 1, old
    return f"{name}, {old[0]}"


@trial("a broken backup changes nothing")
def broken(stack: Stack) -> str:
    """Output of the command."""
    record = stack.save("here before the broken backup")
    name = stack.compose("run", "--rm", "backup").splitlines()[-1]
    stack.compose(
        "run", "--rm", "backup", "sh", "-c", f"head -c 3000 {name} > broken.dump; echo nothing > nothing.dump"
    )
    before = _databases(stack)
    message = []
    stack.compose("stop", "web")
    for each in ("broken.dump", "nothing.dump", "missing.dump"):
        outcome = stack.run("make", "restore", f"NAME={each}")
        assert outcome.returncode, f"{each} was restored"
        message.append(
            next(line for line in outcome.stderr.splitlines() if "nothing has changed" in line or "no backup" in line)
        )
    assert _databases(stack) == before
    stack.up()
    assert stack.has(record)
    return "; ".join(message)


def _databases(stack: Stack) -> list[str]:
    command = ["psql", "-U", "hpn", "-d", "postgres", "-Atc", "SELECT datname FROM pg_database ORDER BY 1"]
    return stack.inside("db", *command).stdout.split()


@trial("a spool of 8 MB is full: 503 with a reason, nothing is left, and small fleets go on")
def spool(stack: Stack) -> str:
    """Answers to a fleet that does not fit."""
    stack.up(SPOOL_SIZE=str(SPOOL_BYTES))
    try:
        with stack.client(120) as client:
            large = client.post("/api/v1/fleet", content=fleet(400_000), headers={"Content-Type": "text/csv"})
            assert large.status_code == 503, (large.status_code, large.text[:300])
            assert large.headers["content-type"] == "application/problem+json"
            left = stack.inside("web", "find", "/data", "-mindepth", "1").stdout
            assert not left, left
            small = client.post("/api/v1/fleet", content=fleet(100), headers={"Content-Type": "text/csv"})
            assert small.status_code == 200, (small.status_code, small.text[:300])
            assert stack.status() == 200
            return f"{large.json()['detail']}"
    finally:
        stack.up()


def fleet(axes: int) -> bytes:
    """A table of axes."""
    rows = "".join(f'{n},"[40, 32, 20]","[250, 500, 250]","[0.3, 3, 0.4]"\n' for n in range(axes))
    return f"axis,torque_Nm,speed_rpm,duration_s\n{rows}".encode()


@trial("web at another address is found again, with the same proxy")
def address(stack: Stack) -> str:
    """Addresses, and how long it took."""
    network = f"{stack.settings['COMPOSE_PROJECT_NAME']}_middle"
    web, started = stack.container("web"), stack.inspect("proxy")["State"]["StartedAt"]
    image = stack.inspect("db")["Config"]["Image"]
    before = stack.inspect("web")["NetworkSettings"]["Networks"][network]["IPAddress"]
    stack.engine.docker("network", "disconnect", network, web)
    words = f"run --detach --network {network} --entrypoint sleep {image} 600".split()
    other = stack.engine.docker(*words)
    try:
        stack.engine.docker("network", "connect", "--alias", "web", network, web)
        after = stack.inspect("web")["NetworkSettings"]["Networks"][network]["IPAddress"]
        assert after != before, "the address is the same"
        start = time.monotonic()
        while stack.status() != 200:
            assert time.monotonic() - start < FOUND_AGAIN_S, f"not found within {FOUND_AGAIN_S:.0f} s"
            time.sleep(0.2)
        waited = time.monotonic() - start
        assert stack.inspect("proxy")["State"]["StartedAt"] == started, "the proxy was started again"
    finally:
        stack.engine.docker("rm", "--force", other)
        stack.compose("up", "--detach", "--wait", "--force-recreate", "web", "proxy")
    return f"{before} to {after}, {waited:.1f} s"


@trial("a fleet under way ends with web, in time and with nothing left")
def shutdown(stack: Stack) -> str:
    """Time of the stop."""
    answers: list[str] = []

    def send() -> None:
        with contextlib.suppress(httpx.TransportError), stack.client(300) as client:
            answer = client.post("/api/v1/fleet", content=fleet(1_500_000), headers={"Content-Type": "text/csv"})
            answers.append(f"{answer.status_code} {answer.text[:150]}")

    sender = threading.Thread(target=send)
    sender.start()
    _await_fleet(stack)
    start = time.monotonic()
    stack.compose("stop", "web")
    took = time.monotonic() - start
    sender.join(60)
    state = stack.inspect("web")["State"]
    stack.up()
    left = stack.inside("web", "find", "/data", "-mindepth", "1").stdout
    assert not left, left
    assert (state["ExitCode"], state["OOMKilled"]) == (0, False), state
    assert took < GRACE_S, took
    return f"{took:.1f} s, exit code 0; its caller got {answers or 'no answer'}"


def _await_fleet(stack: Stack) -> None:
    """Wait until answers are being written: a file of the fleet's folder tells that, whatever its process is called."""
    for _ in range(300):
        if stack.inside("web", "find", "/data", "-name", f"{UNFINISHED}*").stdout:
            return
        time.sleep(0.2)
    raise AssertionError("no fleet is under way")


@trial("another POSTGRES_PASSWORD is no healthy stack; ALTER USER makes it one")
def password(stack: Stack) -> str:
    """Output of `up --wait`."""
    stack.write_settings(POSTGRES_PASSWORD="another")
    up = stack.run("docker", "compose", "up", "--detach", "--wait", "--wait-timeout", "90")
    try:
        assert up.returncode, "up --wait found a stack healthy that can't save"
        assert stack.status("/") == 200, "nothing is calculated"
        _alter(stack, "another")
        stack.up(POSTGRES_PASSWORD="another")
        stack.save("with another password")
    finally:
        _alter(stack, stack.settings["POSTGRES_PASSWORD"])
    return up.stderr.strip().splitlines()[-1]


def _alter(stack: Stack, password: str) -> None:
    """Tell the database a password, and stop the service that has another: one that is unhealthy ends `up` at once."""
    notice = "ALTER USER hpn PASSWORD '{}'".format(password.replace("'", "''"))
    stack.compose("exec", "-T", "db", "psql", "--username", "hpn", "--command", notice)
    stack.compose("stop", "web")


@trial("web without a database at its start answers what needs none, nearly as soon as with one")
def without_database(stack: Stack) -> str:
    """Seconds until the page is there, with a database and without."""
    usual = _page_after_start(stack, "web")
    waited = _page_after_start(stack, "web", "db")
    ready = stack.status()
    assert ready == 503, ready
    assert waited < usual + LATER_S, f"the page is there after {waited:.1f} s, with a database after {usual:.1f} s"
    stack.compose("start", "db")
    start = time.monotonic()
    while stack.status() != 200:
        assert time.monotonic() - start < 90, "not ready within 90 s"
        time.sleep(0.5)
    return f"{waited:.1f} s, with one {usual:.1f} s; ready {time.monotonic() - start:.0f} s after it"


def _page_after_start(stack: Stack, *stopped: str) -> float:
    """Seconds from the start of web alone to its page, after some are stopped."""
    stack.compose("stop", *stopped)
    start = time.monotonic()
    stack.engine.docker("start", stack.container("web"))
    while stack.status("/") != 200:
        assert time.monotonic() - start < 120, "no page within 120 s"
        time.sleep(0.2)
    return time.monotonic() - start

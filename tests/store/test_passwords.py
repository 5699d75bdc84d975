"""A database password may have any characters: by its own setting as it is, in an address encoded."""

from collections.abc import Iterator
from pathlib import Path
from typing import Any
from urllib.parse import quote, urlsplit

import psycopg
import pytest
from psycopg import sql
from ruamel.yaml import YAML

from hpn.store import Store, StoreUnavailableError
from hpn.web.settings import Settings
from tests.databases import PostgreSQL

COMPOSE: dict[str, Any] = YAML(typ="safe").load(Path(__file__).parents[2] / "docker-compose.yml")
PASSWORDS = ["@:/?#%[]&=+;,!*()|^~`<>{}", "%41%zz", "ü€ß漢", " '\"\\$x${Y} "]


@pytest.fixture(scope="module")
def address(postgresql: PostgreSQL) -> Iterator[str]:
    """Address of a database whose user must give a password."""
    database = postgresql.new_database()
    name = urlsplit(database).path.removeprefix("/")
    with psycopg.connect(database, autocommit=True) as connection:
        for statement in ("CREATE ROLE named LOGIN", "CREATE SCHEMA AUTHORIZATION named"):
            connection.execute(statement.encode())
        (rules,) = connection.execute("SHOW hba_file").fetchone() or ("",)
        before = Path(rules).read_text()
        Path(rules).write_text(f"local {name} named scram-sha-256\nhost {name} named all scram-sha-256\n{before}")
        connection.execute("SELECT pg_reload_conf()")
        yield database.replace("postgres@", "named@", 1)
        Path(rules).write_text(before)
        connection.execute("SELECT pg_reload_conf()")


@pytest.fixture(params=PASSWORDS)
def password(request: pytest.FixtureRequest, address: str) -> str:
    """A password that the database has just been given."""
    with psycopg.connect(address.replace("named@", "postgres@", 1), autocommit=True) as connection:
        connection.execute(sql.SQL("ALTER ROLE named PASSWORD {}").format(sql.Literal(request.param)))
    return str(request.param)


async def answers(**settings: Any) -> bool:
    """True where the database answers a service with these settings."""
    store = Store(**Settings(**settings).database())
    try:
        await store.check()
    except StoreUnavailableError:
        return False
    finally:
        await store.close()
    return True


@pytest.mark.anyio
async def test_a_password_of_its_own_is_taken_as_it_is(address: str, password: str) -> None:
    assert await answers(database_url=address, database_password=password)


@pytest.mark.anyio
async def test_a_password_in_an_address_is_encoded(address: str, password: str) -> None:
    assert await answers(database_url=address.replace("named@", f"named:{quote(password, safe='')}@"))


@pytest.mark.anyio
async def test_its_own_setting_goes_before_the_address_and_a_wrong_one_is_refused(
    address: str, password: str, caplog: pytest.LogCaptureFixture
) -> None:
    with_wrong = address.replace("named@", "named:wrong-secret@")

    assert await answers(database_url=with_wrong, database_password=password)
    assert not await answers(database_url=with_wrong)
    assert "wrong-secret" not in caplog.text
    assert password not in repr(Settings(database_password=password))


def test_compose_hands_over_the_password_as_it_is(monkeypatch: pytest.MonkeyPatch) -> None:
    inputs = COMPOSE["services"]["web"]["environment"]

    assert "PASSWORD" not in inputs["HPN_DATABASE_URL"]
    assert inputs["HPN_DATABASE_PASSWORD"] == COMPOSE["services"]["db"]["environment"]["POSTGRES_PASSWORD"]
    monkeypatch.setenv("HPN_DATABASE_PASSWORD", "@:/?#% ü")
    assert Settings().database()["password"] == "@:/?#% ü"

"""Settings, each from an environment variable `HPN_…` or a secret file `hpn_…`; the README's table lists them."""

import os
import re
import stat
import warnings
from dataclasses import dataclass
from ipaddress import ip_network
from pathlib import Path
from typing import Annotated, Any, Literal, Self, TypedDict

import limits
from pydantic import AfterValidator, BeforeValidator, Field, SecretStr, model_validator
from pydantic.fields import FieldInfo
from pydantic_settings import (
    BaseSettings,
    NoDecode,
    PydanticBaseSettingsSource,
    SecretsSettingsSource,
    SettingsConfigDict,
    SettingsError,
)

from hpn.catalogue import AVERAGING_S, HANDBOOK_FOLDER, Catalogue, load_catalogue
from hpn.words.likeness import likeness

RouteGroup = Literal["calculator", "batch", "writing", "listing", "deleting", "reading", "metrics"]
"""Kinds of requests that keys and rate limits distinguish; each route declares its kind."""


KEY_PAIR = re.compile(r"([A-Za-z0-9._-]{1,64}):([0-9a-fA-F]{64})")


@dataclass(frozen=True, slots=True)
class ApiKey:
    """Name of a key and its SHA-256; the key has 192 random bits, so it needs no slow hash."""

    name: str
    digest: bytes

    @classmethod
    def parse(cls, pair: str) -> "ApiKey":
        """Key of a `name:sha256` pair; ValueError for any other text, which may be a secret and is not quoted."""
        match = KEY_PAIR.fullmatch(pair)
        if match is None:
            raise ValueError("must be name:sha256 pairs, as `hpn key NAME` prints them")
        return cls(match[1], bytes.fromhex(match[2]))


def _split(text: object) -> object:
    return text.replace(",", " ").split() if isinstance(text, str) else text


def _keys(words: object) -> object:
    return (
        [ApiKey.parse(word) if isinstance(word, str) else word for word in words] if isinstance(words, list) else words
    )


def _rate(text: str) -> str:
    try:
        items = [] if text == "off" else limits.parse_many(text)
    except ValueError:
        raise ValueError("must be a rate, such as 120/minute, or off") from None
    if len(items) > 1 or any(item.amount < 1 for item in items):
        raise ValueError("must be one rate of at least 1, such as 120/minute, or off for no limit")
    return text


def _proxies(words: tuple[str, ...]) -> tuple[str, ...]:
    for word in words if words != ("*",) else ():
        try:
            ip_network(word)
        except ValueError as error:
            raise ValueError(f"must be addresses or networks, such as 10.0.0.0/8, or * alone; {error}") from None
    return words


def _origins(words: tuple[str, ...]) -> tuple[str, ...]:
    for word in words:
        if word != "*" and not ORIGIN.fullmatch(word):
            raise ValueError(
                "must be origins as browsers send them, such as https://plm.example: scheme and host in small letters, "
                f"a port unless it is the usual one, no path and no slash at the end; {word!r} is none"
            )
    return words


def _hosts(words: tuple[str, ...]) -> tuple[str, ...]:
    for word in words:
        if not HOST.fullmatch(word):
            raise ValueError(
                "must be hosts without scheme, port or path, in small letters, such as plm.example, *.plm.example or "
                f"[2001:db8::1]; {word!r} is none"
            )
    return words


def _folder(path: Path | None) -> Path | None:
    if path is not None and not (path.is_dir() and os.access(path, os.W_OK | os.X_OK)):
        raise ValueError(f"must be a folder that exists and can be written to; {str(path)!r} is none")
    return path


def _existing_folder(path: Path | None) -> Path | None:
    if path is not None and not path.is_dir():
        raise ValueError(f"must be a folder that exists; {str(path)!r} is none")
    return path


def _own_port(value: object) -> object:
    """Default port in place of an address: Kubernetes sets HPN_PORT to the address of a service that is named hpn."""
    return PORT if isinstance(value, str) and value.startswith("tcp://") else value


PORT = 8000
SECRETS = Path("/run/secrets")
"""Folder of secret files in containers, unless HPN_SECRETS_FOLDER names another."""
ORIGIN = re.compile(
    r"(?!http://[^/]*:80$|https://[^/]*:443$)[a-z][a-z0-9+.-]*://([a-z0-9._-]+|\[[0-9a-f:]+\])(:[0-9]+)?"
)
HOST = re.compile(r"(\*\.)?[a-z0-9_-]+(\.[a-z0-9_-]+)*|\[[0-9a-f:.]+\]")
Words = Annotated[tuple[str, ...], NoDecode, BeforeValidator(_split)]
Rate = Annotated[str, AfterValidator(_rate)]


GONE = {
    "HPN_MAXIMUM_BYTES_IN_FLIGHT": "max_conns and client_max_body_size",
    "HPN_MAXIMUM_CONNECTIONS": "worker_connections and max_conns",
    "HPN_HEAD_SECONDS": "client_header_timeout",
}
"""Variables of former settings, and their replacements in backend/nginx.conf."""


class DatabaseSettings(TypedDict):
    """Arguments for the store."""

    address: str
    seconds: float
    password: str | None


class SecretFiles(SecretsSettingsSource):
    """Settings from files, such as /run/secrets/hpn_api_keys; the error for an unreadable file names it."""

    def __call__(self) -> dict[str, Any]:
        """Settings by name; the check of `secrets_folder` refuses a folder that doesn't exist."""
        self.secrets_dir = _secrets_folder(self.current_state.get("secrets_folder"))
        return super().__call__()

    def get_field_value(self, field: FieldInfo, field_name: str) -> tuple[Any, str, bool]:
        """Content of a setting's file, if it exists; SettingsError if it can't be read."""
        try:
            with warnings.catch_warnings(action="error"):  # warns of a file that it leaves out
                return super().get_field_value(field, field_name)
        except (OSError, UnicodeDecodeError, UserWarning) as error:
            raise SettingsError(f"{self.secrets_dir}/hpn_{field_name}: can’t be read: {error}") from error


def _secrets_folder(named: str | Path | None) -> Path | None:
    """Folder of secret files, None if there is none; OSError for a lack of permission, which is_dir() would hide."""
    folder = Path(named or SECRETS)
    try:
        return folder if stat.S_ISDIR(folder.stat().st_mode) else None
    except (FileNotFoundError, NotADirectoryError):
        return None


def source_of(name: str) -> str:
    """Name of the variable or path of the file that gives a setting."""
    variable = f"HPN_{name.upper()}"
    names = {key.upper(): value for key, value in os.environ.items()}
    folder = _secrets_folder(names.get("HPN_SECRETS_FOLDER"))
    files = [file for file in folder.iterdir() if file.name.upper() == variable] if folder else []
    return str(files[0]) if files and not names.get(variable) else variable


class Settings(BaseSettings):
    """Settings of one process, read once at start and passed on; never global."""

    model_config = SettingsConfigDict(
        env_prefix="HPN_", env_ignore_empty=True, extra="ignore", hide_input_in_errors=True
    )

    catalogue_folder: Path = Field(HANDBOOK_FOLDER, description="Folder of the catalogue’s CSV files.")
    catalogue_supplement: Path | None = Field(
        None, description="Folder of CSV files that fill or correct catalogue cells."
    )
    averaging_seconds: float = Field(
        AVERAGING_S,
        gt=0,
        description="Longest time on end above n_av(max) that is taken to average out thermally; longer gets a notice. "
        "Our assumption: the handbook gives no time scale.",
    )
    database_url: SecretStr = Field(
        SecretStr("sqlite:///hpn.sqlite3"),
        description="Database of the saved selections: sqlite:///file, relative to the working directory (four slashes "
        "for an absolute path), or postgresql://user:password@host/database.",
    )
    database_password: SecretStr | None = Field(
        None, description="Password of PostgreSQL’s user, of any characters, instead of one in the address."
    )
    database_seconds: float = Field(5.0, gt=0, description="Longest wait for the database.")
    maximum_body_bytes: int = Field(2_000_000, gt=0, description="Largest body of a request for one application.")
    maximum_batch_body_bytes: int = Field(32_000_000, gt=0, description="Largest body of a batch request.")
    maximum_batch_count: int = Field(10_000, gt=0, le=10_000, description="Most applications in one batch request.")
    body_seconds: float = Field(
        30.0,
        gt=0,
        description="Longest time for a body to arrive, and for the client of a batch of lines to leave its answers "
        "unread.",
    )
    batch_seconds: float = Field(60.0, gt=0, description="Longest computing time of one batch request.")
    maximum_fleet_bytes: int = Field(200_000_000, gt=0, description="Largest body of a request for a fleet.")
    fleet_seconds: float = Field(
        300.0,
        gt=0,
        description="Longest time for the body of a fleet to arrive, and again for its turn and its sizing.",
    )
    fleet_workers: int = Field(1, ge=1, le=64, description="Threads that size one fleet.")
    fleet_processes: int = Field(
        1, ge=1, le=64, description="Fleets that one process of the service has sized at once; few more wait."
    )
    fleet_memory_bytes: int = Field(
        1_000_000_000, ge=500_000_000, description="Most memory of each process that sizes a fleet."
    )
    spool_folder: Annotated[Path | None, AfterValidator(_folder)] = Field(
        None,
        description="Folder for batches of lines on their way, and for the files of fleets; the system’s for temporary "
        "files by default.",
    )
    maximum_spool_bytes: int = Field(
        2_000_000_000,
        gt=0,
        description="Most bytes that fleets and batches of lines of one process set aside together, a seventh for each "
        "batch; most bytes of all files of one fleet.",
    )
    maximum_unsaved_fleet_bytes: int = Field(
        1_000_000_000,
        gt=0,
        description="Most bytes in the database of all unsaved machines that the page has calculated, each kept for a "
        "day; a new one beyond it gets a 503.",
    )
    host: str = Field("127.0.0.1", description="Address that `hpn serve` listens on.")
    port: Annotated[int, BeforeValidator(_own_port)] = Field(
        PORT, ge=0, le=65535, description="Port that `hpn serve` listens on."
    )
    workers: int = Field(1, ge=1, le=64, description="Processes that `hpn serve` starts.")
    worker_seconds: int = Field(
        30, gt=0, description="Time without an answer after which one of several processes is replaced."
    )
    shutdown_seconds: int = Field(30, ge=0, description="Longest time that running requests get to finish at the end.")
    log_level: Literal["debug", "info", "warning", "error"] = Field("info", description="Least level that is logged.")
    api_keys: Annotated[tuple[ApiKey, ...], NoDecode, BeforeValidator(_keys), BeforeValidator(_split)] = Field(
        (), description="Keys as name:sha256 pairs, separated by commas or spaces; `hpn key NAME` makes one."
    )
    guarded: Annotated[frozenset[RouteGroup], NoDecode, BeforeValidator(_split)] = Field(
        frozenset({"batch", "writing", "listing", "deleting"}),
        description="Groups that need a key where there are keys, out of calculator, batch, writing, listing, "
        "deleting, reading and metrics.",
    )
    calculator_rate: Rate = Field(
        "off",
        description="Most calculations, readings and pages, and apart from them metrics, per key or else address, and "
        "process, such as 120/minute.",
    )
    batch_rate: Rate = Field("off", description="Most batches likewise.")
    writing_rate: Rate = Field("off", description="Most savings and deletions likewise.")
    trusted_proxies: Annotated[Words, AfterValidator(_proxies)] = Field(
        (),
        description="Addresses or networks of proxies whose X-Forwarded-For and X-Forwarded-Proto count; * for all.",
    )
    allowed_hosts: Annotated[Words, AfterValidator(_hosts)] = Field(
        (),
        description="Hosts that the service answers for, such as plm.example or *.plm.example, whatever the port; by "
        "default any, but over loopback, and not through a trusted proxy, localhost, 127.0.0.1 and [::1] alone.",
    )
    cors_origins: Annotated[Words, AfterValidator(_origins)] = Field(
        (),
        description="Origins whose scripts may use the API, such as https://plm.example.",
    )

    secrets_folder: Annotated[Path | None, AfterValidator(_existing_folder)] = Field(
        None, description="Folder of files that give settings, such as hpn_api_keys; /run/secrets by default."
    )

    @classmethod
    def settings_customise_sources(
        cls,
        settings_cls: type[BaseSettings],
        init_settings: PydanticBaseSettingsSource,
        env_settings: PydanticBaseSettingsSource,
        dotenv_settings: PydanticBaseSettingsSource,
        file_secret_settings: PydanticBaseSettingsSource,
    ) -> tuple[PydanticBaseSettingsSource, ...]:
        """Sources by precedence: arguments, variables, files."""
        return init_settings, env_settings, SecretFiles(settings_cls)

    def catalogue(self) -> Catalogue:
        """Catalogue with its supplement; raises CatalogueError."""
        return load_catalogue(self.catalogue_folder, self.catalogue_supplement, self.averaging_seconds)

    def database(self) -> "DatabaseSettings":
        """Arguments that open the store."""
        password = self.database_password and self.database_password.get_secret_value()
        return {
            "address": self.database_url.get_secret_value(),
            "seconds": self.database_seconds,
            "password": password or None,
        }

    @model_validator(mode="after")
    def _no_name_misspelt(self) -> Self:
        """Raise ValueError for a variable or file with a misspelt setting's name: its protection would be missing."""
        known = [f"HPN_{name.upper()}" for name in type(self).model_fields]
        folder = _secrets_folder(self.secrets_folder)
        sources = {name: name for name in os.environ}
        sources |= {file.name: str(file) for file in (folder.iterdir() if folder else ())}
        for name in sorted(sources):
            likely = None if name.upper() in {*known, *GONE} else likeness(name, known, 0.85)
            if likely and name.upper().startswith("HPN_"):
                raise ValueError(f"{sources[name]} is not a setting; it looks like {likely}")
        return self

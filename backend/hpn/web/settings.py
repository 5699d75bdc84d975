"""Every setting of the service, by environment variable `HPN_…`; the README's table lists them."""

from pathlib import Path

from pydantic import Field, SecretStr
from pydantic_settings import BaseSettings, SettingsConfigDict

from hpn.catalogue import HANDBOOK_FOLDER


class Settings(BaseSettings):
    """Settings of one process; read once at start and passed on, never global."""

    model_config = SettingsConfigDict(env_prefix="HPN_", env_ignore_empty=True, extra="ignore")

    catalogue_folder: Path = Field(HANDBOOK_FOLDER, description="Folder of the catalogue's CSV files.")
    catalogue_supplement: Path | None = Field(
        None, description="Folder of CSV files that fill or correct catalogue cells."
    )
    database_url: SecretStr = Field(
        SecretStr("sqlite:///hpn.sqlite3"),
        description="Database of the saved selections: sqlite:///file, relative to the working directory (four slashes "
        "for an absolute path), or postgresql://user:password@host/database.",
    )
    database_seconds: float = Field(5.0, gt=0, description="Longest wait for the database.")
    maximum_body_bytes: int = Field(2_000_000, gt=0, description="Largest body of a request for one application.")
    maximum_batch_body_bytes: int = Field(32_000_000, gt=0, description="Largest body of a batch request.")
    maximum_batch_count: int = Field(10_000, gt=0, le=10_000, description="Most applications in one batch request.")
    body_seconds: float = Field(30.0, gt=0, description="Longest time for a request's body to arrive.")
    batch_seconds: float = Field(60.0, gt=0, description="Longest computing time of one batch request.")

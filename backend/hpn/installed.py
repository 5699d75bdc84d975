"""What this installation has beside its modules: the folders of data, and the packages of the extras."""

from importlib.resources import files
from pathlib import Path


def data_folder(name: str) -> Path:
    """`catalogue`, `frontend/templates` or `frontend/dist`: in the package where the build put them there, else of the
    checkout that this is.
    """
    packed = Path(str(files("hpn") / "data"))
    return (packed if packed.is_dir() else Path(__file__).parents[2]) / name

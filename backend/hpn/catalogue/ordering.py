"""Ordering codes: HPN-20A-5-J6-BH-AF1 is gear, output version and code for the motor adapter (table 9.1)."""

import re
from collections.abc import Mapping
from dataclasses import dataclass

from hpn.catalogue.catalogue import Catalogue, OutputVersion
from hpn.catalogue.gear import Gear
from hpn.words.wording import N_, Sentence

MOTOR_CODE = r"[A-Za-z0-9]{1,8}([.\-][A-Za-z0-9]{1,8}){0,3}"
"""Pattern of codes for the motor adapter, such as `BH-AF1` or `xx.xx`; only the maker knows the code for a motor."""

NOT_A_MOTOR_CODE = N_("letters and digits, in groups separated by - or . such as BH-AF1")
NOT_A_CODE = N_("must be a gear of the catalogue, an output version and the motor adapter, such as HPN-20A-5-J6-BH-AF1")


@dataclass(frozen=True, slots=True)
class OrderingCode:
    """A code as far as known, its parts, and the fault of the typed part."""

    text: str
    gear: Gear
    output: str
    motor: str
    versions: tuple[OutputVersion, ...]
    problem: str | None = None

    @property
    def labels(self) -> Mapping[str, str]:
        """Labels of the code in a link; the default version is left out."""
        return {"order_output": "" if self.output == self.versions[0].code else self.output, "order_motor": self.motor}


def ordering_code(catalogue: Catalogue, gear: Gear, output: str = "", motor: str = "") -> OrderingCode:
    """Code of a gear with an output version, the first version for a missing or unknown one."""
    versions = tuple(version for version in catalogue.output_versions if version.position == "output")
    output = output if any(version.code == output for version in versions) else versions[0].code
    motor = motor.strip()[:60]
    valid = re.fullmatch(MOTOR_CODE, motor) is not None
    problem = None if valid or not motor else NOT_A_MOTOR_CODE
    parts = [gear.designation, output, *([motor.upper()] if valid else [])]
    return OrderingCode("-".join(parts), gear, output, motor, versions, problem)


def read_ordering_code(catalogue: Catalogue, text: str) -> OrderingCode | Sentence:
    """Code from a text such as `hpn-20a-5-j6-bh-af1`, or an error message; motor and output may be left out from the
    end.
    """
    head, gear_size, ratio, output, motor = (*text.strip().upper().split("-", 4), "", "", "", "", "")[:5]
    gear = catalogue.find(f"{head}-{gear_size}-{ratio}")
    if gear is None:
        return Sentence(NOT_A_CODE)
    code = ordering_code(catalogue, gear, output, motor)
    return Sentence(NOT_A_CODE) if code.problem or output not in ("", code.output) else code

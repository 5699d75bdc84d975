"""`python -m tests.fuzz [DOOR …] [--count N] [--first SEED] [--show]`: attacks doors, or shows one input."""

import argparse
import sys

from tests.fuzz.doors import DOORS
from tests.fuzz.run import attack_in_parts, input_of


def main() -> int:
    """Report each door's outcome and findings; 1 where there is a finding."""
    parser = argparse.ArgumentParser(prog="python -m tests.fuzz", description=__doc__)
    parser.add_argument("doors", nargs="*", metavar="DOOR", help=f"out of {', '.join(DOORS)}; all by default")
    parser.add_argument("--count", type=int, default=200_000, help="inputs for each door")
    parser.add_argument("--first", type=int, default=0, help="seed of the first input")
    parser.add_argument("--processes", type=int, default=2)
    parser.add_argument("--show", action="store_true", help="write the input of the first seed, and send nothing")
    inputs = parser.parse_args()
    if inputs.show:
        sys.stdout.buffer.write(input_of(inputs.doors[0], inputs.first)[1])
        return 0
    result = 0
    for door in inputs.doors or DOORS:
        outcome = attack_in_parts(door, inputs.first, inputs.count, inputs.processes)
        print(f"{door}: {outcome}", *outcome.findings, sep="\n", flush=True)
        result += len(outcome.findings)
    return min(result, 1)


if __name__ == "__main__":
    sys.exit(main())

"""`python -m tests.benchmarks.serve FACTORY` serves an application with the options of `hpn serve`."""

import sys

import uvicorn

from hpn.web.serve import options
from hpn.web.settings import Settings

if __name__ == "__main__":
    uvicorn.run(sys.argv[1], log_level="warning", **options(Settings()))

"""What the tests share: the program, and files that it has made for them (make_files.py)."""

import os
import pathlib
import subprocess
import sys

NOT_HERE = 77  # exit code of a test that cannot run here; ctest counts it as skipped

try:
    import h5py
    import matplotlib
    import numpy
except ImportError as error:
    print(f"skipped: {error.name} is missing for {sys.executable}; packages.txt names what Kerf needs")
    sys.exit(NOT_HERE)

SOURCES = pathlib.Path(__file__).resolve().parents[2]
PROGRAM = os.environ["KERF_PROGRAM"]
FILES = pathlib.Path(os.environ["KERF_TEST_FILES"])


def kerf(*arguments, folder=None, seconds=None):
    """Runs the program: the finished process, with stdout and stderr as texts. Raises where it takes longer."""
    words = [PROGRAM, *map(str, arguments)]
    environment = {**os.environ, "KERF_PYTHON": sys.executable}
    return subprocess.run(
        words, capture_output=True, text=True, cwd=folder, env=environment, check=False, timeout=seconds
    )


def skip(reason):
    """Ends a file of tests that cannot run here."""
    print(f"skipped: {reason}")
    sys.exit(NOT_HERE)

"""Runs a command of the package beside it: main.py report|export|inspect ... (`kerf` calls it so)."""

import sys

PACKAGES = {"h5py": "python3-h5py", "numpy": "python3-numpy"}


def main():
    sys.dont_write_bytecode = True  # a checkout or an installed place may be somebody else's
    try:
        from kerf import commands
    except ImportError as error:
        package = PACKAGES.get(error.name, error.name)
        remedy = f"Install {package}, or name a Python with KERF_PYTHON"
        sys.stderr.write(f"kerf: {error.name} is missing for {sys.executable}. {remedy}.\n")
        return 2
    return commands.run_guarded(sys.argv[1:])


if __name__ == "__main__":
    sys.exit(main())

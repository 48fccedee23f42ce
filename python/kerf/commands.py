"""The commands report, export, inspect. Exit codes as of the program: 1 the command, 2 a file."""

import argparse
import os
import pathlib
import signal
import sys

from . import files

USAGE = """usage:
  kerf report FILE.h5|FOLDER... [--output DIR] [--force]
      one page about runs and studies, and its figures: into results/report
  kerf export --volume RUN [--body NAME] [--output FILE.vtkhdf] [--force]
      a run's cells with fields over time, for ParaView: beside the run
  kerf inspect FILE...
      what is in a file: a run, study, surface, checkpoint
"""


def refuse(text):
    raise files.Complaint(f"{text}.\n{USAGE}", 1)


def parse(arguments, names):
    """The arguments of a command: names -> what argparse takes."""
    parser = argparse.ArgumentParser(add_help=False, allow_abbrev=False)
    parser.error = refuse
    for name, options in names.items():
        parser.add_argument(name, **options)
    return parser.parse_args(arguments)


def report(arguments):
    names = {
        "files": {"nargs": "+"},
        "--output": {"default": "results/report"},
        "--force": {"action": "store_true"},
    }
    given = parse(arguments, names)
    from . import report as reports

    page, figures = reports.make(given.files, given.output, given.force)
    print(
        f"report in {page} ({page.stat().st_size / 1e6:.1f} MB), "
        f"{len(figures)} figures as PNG and SVG in {page.parent / 'figures'}"
    )


def export(arguments):
    names = {
        "--volume": {"metavar": "RUN"},
        "--body": {},
        "--output": {},
        "--force": {"action": "store_true"},
    }
    given = parse(arguments, names)
    if given.volume is None:
        refuse("say what to export: --volume RUN")
    from . import runs, volume_file

    run = runs.Run(given.volume)
    body = body_of(run, given.body)
    target = pathlib.Path(given.output or run.path.parent / f"volume_{body.name}.vtkhdf")
    if target.exists() and not given.force:
        raise files.Complaint(
            f"{target}: is there already. Replace it with --force, or choose another with --output.", 1
        )
    with files.told(run.path):
        volume_file.write(target, body)
    print(f"{len(body)} frames of {body.name} in {target}")


def body_of(run, name):
    if not run.bodies:
        raise files.complaint(run.path, "has no frames", "Run the scene to its first step")
    if name is None and len(run.bodies) == 1:
        return next(iter(run.bodies.values()))
    if name not in run.bodies:
        what = f"has no body '{name}'" if name else "has several bodies"
        raise files.Complaint(f"{run.path}: {what}. Name one with --body: {', '.join(run.bodies)}.", 1)
    return run.bodies[name]


def inspect(arguments):
    given = parse(arguments, {"files": {"nargs": "+"}})
    from . import inspect_file

    for i, path in enumerate(given.files):
        print(("\n" if i else "") + "\n".join(inspect_file.described(path)))


def missing(error):
    """What to say of a package that is not there."""
    packages = {
        "h5py": "python3-h5py",
        "numpy": "python3-numpy",
        "matplotlib": "python3-matplotlib",
        "PIL": "python3-pil",
    }
    package = packages.get((error.name or "").split(".")[0], error.name)
    return f"{error.name} is missing for {sys.executable}. Install {package}, or name a Python with KERF_PYTHON."


def run(arguments):
    """Runs a command; returns the exit code."""
    command = {"report": report, "export": export, "inspect": inspect}.get(arguments[0] if arguments else None)
    try:
        if command is None or "--help" in arguments or "-h" in arguments:
            print(USAGE, end="", file=sys.stderr if command is None else sys.stdout)
            return 1 if command is None else 0
        command(arguments[1:])
        sys.stdout.flush()
        return 0
    except files.Complaint as complaint:
        sys.stderr.write(f"kerf: {complaint}\n")
        return complaint.exit_code
    except ImportError as error:
        sys.stderr.write(f"kerf: {missing(error)}\n")
        return 2
    except BrokenPipeError:
        sys.stderr.close()
        return 0


def run_guarded(arguments):
    """As run, in a process of its own: on some broken bytes the HDF5 library itself crashes, which is told here."""
    child = os.fork()
    if child == 0:
        signal.signal(signal.SIGINT, signal.SIG_DFL)
        os._exit(run(arguments))
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    status = os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])
    if -status in (signal.SIGSEGV, signal.SIGBUS, signal.SIGABRT, signal.SIGFPE):
        name = signal.Signals(-status).name
        sys.stderr.write(f"kerf: {' '.join(arguments)}: a file is damaged: reading it crashed ({name}). Make it again.\n")
        return 2
    return status if status >= 0 else 128 - status

"""One page about any number of runs and studies, and its figures as files for a paper."""

import pathlib
import re

from . import files, page, run_figures, run_parts, runs, studies, study_figures, study_parts

SURFACES = 5_000_000  # bytes of the page that all surfaces may take together
KINDS = ("study", "stability", "run")  # in the order of the page


def names_of(paths):
    """A short name for each file, no two alike: of its folder, or its own where the folder's says nothing."""
    stems = [p.resolve().parent.name if p.name in files.NAMES else p.stem for p in paths]
    stems = [re.sub(r"[^A-Za-z0-9_-]+", "-", stem).strip("-") or "file" for stem in stems]
    names = []
    for stem in stems:
        n = 2
        name = stem
        while name in names:
            name, n = f"{stem}-{n}", n + 1
        names.append(name)
    return names


def read(path):
    """(kind, Run or Study) of a file that a report can be about."""
    with files.open_h5(path) as file, files.told(path):
        kind = files.kind_of(file)
    if kind not in KINDS:
        what = "is HDF5, but no file of Kerf's" if kind is None else f"is {files.KINDS[kind]}"
        raise files.complaint(
            path, f"{what}; reports are about runs and studies", "See what is in it: kerf inspect FILE"
        )
    return kind, runs.Run(path) if kind == "run" else studies.Study(path, kind)


def read_all(paths):
    """[(kind, name, Run or Study)], studies first. A file that is named twice is read once."""
    found = list(dict.fromkeys(files.find(path).resolve() for path in paths))
    items = [(*read(path), name) for path, name in zip(found, names_of(found))]
    return [(kind, name, item) for wanted in KINDS for kind, item, name in items if kind == wanted]


def together(items, figures):
    """What several studies, and several runs, have to say side by side."""
    timed = [(name, s) for kind, name, s in items if kind == "study" and studies.has_times(s)]
    several = [(name, s) for name, s in timed if "error" in studies.norms(s)]
    runs_ = [(name, r) for kind, name, r in items if kind == "run"]
    pieces = []
    if len(several) > 1:
        labels, all_studies = zip(*several)
        figure = study_figures.error_against_time(all_studies, labels)
        caption = "Error against CPU time of set-up and all steps, a panel a study. Rings: the Pareto front."
        pieces.append(figures.add("studies_error_time", figure, caption))
    if len(runs_) > 1:
        labels, all_runs = zip(*runs_)
        caption = "What the runs both record."
        pieces.append(figures.add("runs_series", run_figures.compared(all_runs, labels), caption))
    text = "".join(pieces)
    return page.heading("Side by side", "side-by-side", first=True) + text if text else ""


def overview(items):
    header = [("what", ""), ("name", ""), ("outcome", ""), ("size", ""), ("commit", ""), ("file", "")]
    rows = []
    for kind, name, item in items:
        size = f"{len(item.time)} steps" if kind == "run" else f"{item.n_rows} rows"
        rows.append([kind, name, item.outcome, size, item.info.get("git_commit", ""), item.path])
    return page.table("overview", header, rows)


def part(kind, name, item, figures, budget):
    if kind == "run":
        return run_parts.run_part(item, name, figures, budget)
    make = study_parts.study_part if kind == "study" else study_parts.stability_part
    return make(item, name, figures)


def check_names(items):
    """An empty study has nothing to show, and says so."""
    for kind, _, item in items:
        if kind != "run" and item.n_rows == 0:
            raise files.complaint(item.path, "has no rows yet", "Let the study finish a row: kerf study --resume")


def make(paths, folder, replace):
    """Writes FOLDER/report.html and FOLDER/figures; returns the page's path and the names of the figures."""
    folder = pathlib.Path(folder)
    target = folder / "report.html"
    if target.exists() and not replace:
        raise files.Complaint(
            f"{target}: there is a report. Replace it with --force, or choose a folder with --output.", 1
        )
    items = read_all(paths)
    check_names(items)
    figures = page.Figures(folder / "figures")
    n_runs = sum(kind == "run" for kind, _, _ in items)
    pieces = [overview(items), together(items, figures)]
    for kind, name, item in items:
        with files.told(item.path):
            pieces.append(part(kind, name, item, figures, SURFACES // max(n_runs, 2)))
    contents = [(f"{kind} {name}", name) for kind, name, _ in items]
    body = "\n".join(pieces)
    title = "Kerf: " + ", ".join(name for _, name, _ in items)
    files.write(target, page.whole(title, contents, body, 'class="viewer"' in body).encode())
    return target, figures.names

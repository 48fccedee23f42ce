"""What a report says of a run: surface, frames, series, times, scene, provenance."""

import json
import pathlib

import numpy as np

from . import page, run_figures, surface_view


def images_of(run, most=6):
    """Paths of at most so many of the run's images, evenly spread."""
    paths = sorted((pathlib.Path(run.path).parent / "frames").glob("*.png"))
    if not paths:
        return []
    return [paths[i] for i in sorted(set(np.linspace(0, len(paths) - 1, most).round().astype(int).tolist()))]


def notes(run):
    lines = []
    if run.outcome == "running":
        lines.append("The run is under way, or was killed: what follows is as far as it came.")
    if run.failure:
        lines.append(f"The run ended early, '{run.outcome}': {run.failure}")
    if not any(len(body) for body in run.bodies.values()):
        lines.append("The run has no frames: no surface is drawn.")
    if not run.series:
        lines.append("The scene records no observables: name some in its section 'Observables'.")
    return "".join(page.note(line) for line in lines)


def surface_part(run, name, budget):
    """The surface that is turned by hand, and its data; notes where it cannot be."""
    if not any(len(body) for body in run.bodies.values()):
        return ""
    if not page.three_is_there():
        return page.note(
            "three.js is missing, so surfaces cannot be turned here: install libjs-three and report again."
        )
    view = surface_view.encoded(run, budget)
    if view is None:
        return page.note("The surface is too large for this page: only pictures of it follow.")
    shown = len(view["frames"])
    every = "" if shown == view["n_all"] else f" {shown} of {view['n_all']} frames, to keep this page small."
    text = f"Drag to turn, wheel to come closer, slide through time.{every} Grey-brown: the skin; other colours: cuts."
    data = page.data_element(f"{name}-view", json.dumps(view))
    return f'{page.viewer(f"{name}-view")}{data}<p class="on-screen">{page.escaped(text)}</p>'


def series_table(run, name):
    """First, last, smallest and largest of each series."""
    header = [
        ("series", ""),
        ("unit", ""),
        ("first", ""),
        ("last", ""),
        ("smallest", ""),
        ("largest", ""),
        ("source", ""),
    ]
    rows = []
    for one in run.series.values():
        if len(one.values):
            ends = (one.values[0], one.values[-1], np.nanmin(one.values), np.nanmax(one.values))
            rows.append([one.name, one.unit, *(page.number(float(v), ".5g") for v in ends), one.source])
    return page.table(f"{name}-series", header, rows) if rows else ""


def stages_table(run, name):
    rows = [[stage, page.number(float(series.values.sum()), ".4g")] for stage, series in run.timing.items()]
    return page.table(f"{name}-stages", [("stage", ""), ("wall-clock time", "s")], rows)


def run_part(run, name, figures, budget):
    """The part of a run; `budget` [bytes] for its surface."""
    steps = f"{len(run.time)} output steps, to {run.time[-1]:.4g} s" if len(run.time) else "no output step"
    bodies = ", ".join(f"{n} ({len(b)} frames)" for n, b in run.bodies.items()) or "none"
    images = images_of(run)
    return "\n".join(
        [
            page.heading(f"Run {name}", name),
            page.paragraph(f"Outcome: {run.outcome}. {steps[0].upper()}{steps[1:]}. Bodies: {bodies}."),
            notes(run),
            surface_part(run, name, budget),
            figures.add(
                f"{name}_surface",
                run_figures.surface_in_frames(run),
                f"{name}: the surface in three frames, in one scale; what flies far off is out of the picture.",
            ),
            page.frames(images) if images else "",
            figures.add(f"{name}_series", run_figures.over_time(run), f"{name}: what the run records over time."),
            figures.add(f"{name}_stages", run_figures.time_per_stage(run), f"{name}: where its wall-clock time went."),
            page.details("Series in numbers", series_table(run, name) + stages_table(run, name)),
            page.details("Scene", page.preformatted(run.scene)),
            page.details("What was composed and left out", page.preformatted("\n".join(run.composition))),
            page.details("Files that the scene reads (SHA-256)", page.preformatted("\n".join(run.inputs))),
            page.details("Provenance", page.facts(f"{name}-info", [("file", run.path.resolve()), *run.info.items()])),
        ]
    )

"""Figures of runs: series over time by unit, time per stage, the surface in a few frames."""

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.collections import PolyCollection

from . import drawing

UNITS = {"J": "energy", "1": "number", "m": "length", "kg": "mass", "m^3": "volume", "N": "force", "Pa": "stress"}
SKIN, CUTS = "#c9b8a8", ["#D55E00", "#0072B2", "#009E73", "#CC79A7", "#E69F00", "#56B4E9"]


def groups(series):
    """Groups of series that belong into one panel: one unit; numbers without a unit are each for themselves."""
    found = {}
    for one in series.values():
        found.setdefault(one.unit if one.unit not in ("1", "") else one.name, []).append(one)
    return list(found.values())


def thinned(series, most=1000):
    """Times and values of at most about so many entries: of each stretch the smallest and the largest."""
    n = len(series.values)
    if n <= most:
        return series.time, series.values
    edges = np.unique(np.linspace(0, n, most // 2 + 1).astype(int))
    values = np.nan_to_num(series.values)
    ends = [(a + values[a:b].argmin(), a + values[a:b].argmax()) for a, b in zip(edges[:-1], edges[1:])]
    keep = np.unique(np.concatenate([[0, n - 1], np.ravel(ends)]))
    return series.time[keep], series.values[keep]


def keep_flat(axes, group):
    """Shows what changes by round-off alone as a flat line, not as noise with an offset."""
    values = np.concatenate([one.values[np.isfinite(one.values)] for one in group])
    if len(values) and 0 < np.abs(values).max() and np.ptp(values) <= 1e-9 * np.abs(values).max():
        axes.set_ylim(*sorted((0.95 * values[0], 1.05 * values[0])))


def draw_group(axes, group):
    """The series of one panel, named in it."""
    for number, one in enumerate(group):
        style = drawing.look(number)
        time, values = thinned(one)
        axes.plot(time, values, label=one.name, markevery=max(1, len(time) // 8), **{**style, "markersize": 3.5})
    keep_flat(axes, group)
    unit = group[0].unit
    axes.set_ylabel(f"{UNITS.get(unit, '')} [{unit}]".strip())
    axes.set_xlabel("time [s]")
    if len(group) == 1:
        axes.set_title(group[0].name)
    else:
        axes.legend(fontsize=6.5, handlelength=2.4)


def over_time(run):
    """A panel a unit; None of a run without series."""
    several = groups(run.series)
    if not several or len(run.time) == 0:
        return None
    figure, axes = drawing.panels(len(several), n_columns=3, width=3.3)
    for one, group in zip(axes, several):
        draw_group(one, group)
    figure.tight_layout()
    return figure


def shared(several):
    """Names of the series that at least two of the runs have, in the same unit."""
    names = dict.fromkeys(name for run in several for name in run.series)
    units = {name: [run.series[name].unit for run in several if name in run.series] for name in names}
    return [name for name in names if len(units[name]) > 1 and len(set(units[name])) == 1]


def compared(several, labels):
    """The series that runs share, a panel each, a line a run; None where there are none."""
    names = shared(several)
    if not names:
        return None
    figure, axes = drawing.panels(len(names), n_columns=3, width=3.3)
    for one, name in zip(axes, names):
        for number, (run, label) in enumerate(zip(several, labels)):
            if name in run.series:
                time, values = thinned(run.series[name])
                style = {**drawing.look(number), "markersize": 3.5}
                one.plot(time, values, label=label, markevery=max(1, len(time) // 8), **style)
        one.set_title(name)
        one.set_ylabel(f"[{next(r.series[name].unit for r in several if name in r.series)}]")
        one.set_xlabel("time [s]")
    drawing.legend_beside(figure, axes)
    return figure


def time_per_stage(run):
    """Seconds of each stage in all, and how they spread over the run."""
    stages = {name: series.values for name, series in run.timing.items() if series.values.sum() > 0}
    if not stages:
        return None
    figure, (left, right) = plt.subplots(1, 2, figsize=(8, 2.6), width_ratios=(1, 1.6))
    total = sum(values.sum() for values in stages.values())
    edges = np.unique(np.linspace(0, len(run.time), 61).astype(int))
    bottom = np.zeros(len(edges) - 1)
    for number, (name, values) in enumerate(stages.items()):
        left.barh(number, values.sum(), **drawing.fill(name))
        left.text(
            values.sum(), number, f" {values.sum():.3g} s, {100 * values.sum() / total:.0f} %", va="center", fontsize=7
        )
        part = np.add.reduceat(values, edges[:-1])
        at = run.time[edges[:-1]]
        right.bar(at, part, np.diff([*at, run.time[-1]]), bottom, align="edge", **drawing.fill(name))
        bottom += part
    left.set_yticks(range(len(stages)), stages)
    left.invert_yaxis()
    left.set_xlim(0, 1.5 * max(values.sum() for values in stages.values()))
    left.set_xlabel("wall-clock time [s]")
    right.set_xlabel("time in the scene [s]")
    right.set_ylabel("wall-clock time\nof a 60th of the run [s]")
    figure.tight_layout()
    return figure


def triangle_colours(surface, inside):
    """(m, 3), 0 .. 1: the inside's colours where there are some; the skin in one, each cut in its own."""
    palette = np.array([plt.matplotlib.colors.to_rgb(c) for c in [SKIN, *CUTS]])
    labels = surface.labels.astype(int)
    colours = palette[np.where(labels == 0, 0, 1 + (labels - 1) % len(CUTS))]
    if inside is not None:
        known = np.isfinite(inside[:, 0])
        colours[known] = inside[known] / 255
    return colours


VIEW = np.array([[0.84, 0.54, 0.0], [-0.21, 0.33, 0.92], [-0.50, 0.77, -0.39]])  # right, up, into the picture


def draw_surfaces(axes, surfaces):
    """[(Surface, inside's colours)] in the frame's positions, from the right, the front and above: far ones first."""
    corners = np.concatenate([s.points[s.triangles] for s, _ in surfaces]) @ VIEW.T
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    length = np.maximum(np.linalg.norm(normals, axis=1), 1e-300)
    light = 0.45 + 0.55 * np.abs(normals @ [0.3, 0.5, -0.81]) / length
    colours = np.concatenate([triangle_colours(*s) for s in surfaces]) * light[:, None]
    order = np.argsort(-corners[:, :, 2].mean(axis=1))
    order = order[np.einsum("ij,j->i", normals, [0, 0, 1.0])[order] >= 0]  # the rest turns its back to us
    axes.add_collection(
        PolyCollection(
            corners[order, :, :2], facecolors=colours[order], edgecolors="face", linewidths=0.4, rasterized=True
        )
    )
    axes.set_aspect("equal")
    axes.axis("off")


def surfaces_of(run, frame):
    """[(Surface, inside's colours)] of the bodies that have this frame (counted from 0) and a surface."""
    bodies = [b for b in run.bodies.values() if frame < len(b) and b.surface(frame) is not None]
    return [(b.surface(frame), b.colours(frame)) for b in bodies]


def window(frames):
    """Lower and upper ends of what holds all points, but goes beyond the first frame by at most half its size."""
    first_low, first_high = frames[0].min(axis=0), frames[0].max(axis=0)
    beyond = (first_high - first_low).max() / 2
    low = np.min([points.min(axis=0) for points in frames], axis=0)
    high = np.max([points.max(axis=0) for points in frames], axis=0)
    return np.maximum(low, first_low - beyond), np.minimum(high, first_high + beyond)


def surface_in_frames(run):
    """The first, a middle and the last frame side by side, in one scale; None of a run without frames."""
    n = max((len(body) for body in run.bodies.values()), default=0)
    frames = sorted({0, n // 2, n - 1}) if n else []
    shown = [(f, surfaces_of(run, f)) for f in frames]
    shown = [(f, surfaces) for f, surfaces in shown if surfaces]
    if not shown:
        return None
    figure, axes = drawing.panels(len(shown), n_columns=3, width=3, height=2.8)
    low, high = window([np.concatenate([s.points for s, _ in surfaces]) @ VIEW.T for _, surfaces in shown])
    for one, (_, surfaces) in zip(axes, shown):
        draw_surfaces(one, surfaces)
        one.set_xlim(low[0], high[0])
        one.set_ylim(low[1], high[1])
        one.set_title(f"{surfaces[0][0].time:.4g} s")
    figure.tight_layout()
    return figure

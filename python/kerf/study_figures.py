"""Figures of studies: error against time, error against h, time per stage."""

import pathlib

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.ticker import FuncFormatter

from . import drawing, files, runs, studies


def percent(axis):
    """Ticks of an axis of errors [1] in per cent."""
    axis.set_major_formatter(FuncFormatter(lambda value, _: f"{100 * value:g}"))


def draw_error_against_time(axes, study, norm, numbers):
    """One study in one panel: a line a method, its rows by time, with bars as wide as the times of repetitions are apart;
    rings mark fronts. numbers: method -> its line's."""
    rows, times, errors = studies.comparable(study, norm)
    for method, members in studies.methods(study).items():
        mine = np.flatnonzero(np.isin(rows, members))
        mine = mine[np.argsort(times[mine], kind="stable")]
        style = drawing.look(numbers[method])
        if len(studies.problems(study)) > 1:
            style["linestyle"] = "none"  # rows of different problems: a line between them would mean nothing
        label = method if mine.size else f"{method}: no row has an error"
        axes.plot(times[mine], errors[mine], label=label, **style)
        half = studies.half_spreads(study)[rows[mine]]
        if (half > 0).any():
            ends = np.maximum(times[mine] - half, 0.01 * times[mine]), times[mine] + half
            axes.hlines(errors[mine], *ends, colors=style["color"], linewidth=4, alpha=0.35)
    for index in studies.fronts(study, norm):
        at = np.flatnonzero(rows == index)[0]
        axes.plot(times[at], errors[at], "o", ms=11, mfc="none", mec="#555555", mew=1.1, label="on the Pareto front")
    axes.set_xscale("log")
    axes.set_yscale("log")
    percent(axes.yaxis)
    axes.set_xlabel("CPU time of set-up and all steps [s]")
    axes.set_ylabel(f"{norm.replace('_', ' ')} [%]")


def error_against_time(several, labels, norm="error"):
    """A panel a study; a method looks the same in all of them."""
    names = dict.fromkeys(method for study in several for method in studies.methods(study))
    numbers = {name: number for number, name in enumerate(names)}
    figure, axes = drawing.panels(len(several), width=5.5 if len(several) == 1 else 4, height=3.6)
    for one, study, label in zip(axes, several, labels):
        draw_error_against_time(one, study, norm, numbers)
        one.set_title(label)
    drawing.legend_beside(figure, axes)
    return figure


def error_against_h(study, norm="error"):
    """Errors over h with the fitted lines; None where no method has several grids."""
    fits = studies.orders(study, norm)
    if not fits:
        return None
    figure, (axes,) = drawing.panels(1, width=5.5, height=3.6)
    rows, _, errors = studies.comparable(study, norm)
    h = study.columns["h"].values[rows]
    for number, (method, members) in enumerate(studies.methods(study).items()):
        mine = np.flatnonzero(np.isin(rows, members))
        style = drawing.look(number)
        axes.plot(h[mine], errors[mine], **{**style, "linestyle": "none"})
        axes.plot([], [], label=f"{method}: order {fits[method][0]:.2f}" if method in fits else method, **style)
        if method in fits:
            order, factor = fits[method]
            ends = np.array([h[mine].min(), h[mine].max()])
            axes.plot(ends, factor * ends**order, **{**style, "marker": ""})
    axes.set_xscale("log")
    axes.set_yscale("log")
    percent(axes.yaxis)
    spread = np.unique(h)
    axes.set_xticks(spread, [f"{value:.3g}" for value in spread], rotation=30)
    axes.minorticks_off()
    axes.set_xlabel("edge h of the grid's cubes [m]")
    axes.set_ylabel(f"{norm.replace('_', ' ')} [%]")
    drawing.legend_beside(figure, [axes])
    return figure


def stage_times(study):
    """Stage -> seconds of each row (n_rows,): what the rows' own files hold, else set-up and stepping of the table."""
    seconds = {"set-up": study.columns["setup_time"].values.copy()}
    for i, name in enumerate(study.columns["name"].values):
        path = pathlib.Path(study.path).parent / "rows" / name.replace(", ", "+") / "run.h5"
        if not path.exists():
            return {**seconds, "stepping": study.columns["stepping_time"].values}
        with files.open_h5(path) as file, files.told(path):
            for stage, series in runs.read_series(file["timing"], file["time"]).items():
                seconds.setdefault(stage, np.zeros(study.n_rows))[i] = series.values.sum()
    return {stage: values for stage, values in seconds.items() if values.any()}


def time_per_stage(study):
    """Shares of the wall-clock time of each row; the total stands at the right."""
    seconds = stage_times(study)
    total = np.maximum(sum(seconds.values()), 1e-300)
    figure, axes = plt.subplots(figsize=(7, 0.7 + 0.2 * study.n_rows))
    left, y = np.zeros(study.n_rows), np.arange(study.n_rows)
    for stage, values in seconds.items():
        axes.barh(y, values / total, left=left, label=stage, **drawing.fill(stage))
        left += values / total
    for i in y:
        axes.text(1.01, i, f"{total[i]:.3g} s", va="center", fontsize=7)
    axes.set_yticks(y, study.columns["name"].values, fontsize=7)
    axes.set_ylim(study.n_rows - 0.4, -0.6)
    axes.set_xlim(0, 1)
    percent(axes.xaxis)
    axes.set_xlabel("share of wall-clock time [%]")
    axes.grid(False)
    drawing.legend_beside(figure, [axes])
    return figure

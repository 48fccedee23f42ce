"""Maps of a study of stability: a row of panels is a variant, a column a sweep; a cell is a run."""

import matplotlib.pyplot as plt

from . import drawing

# Colours of Okabe and Ito, told apart by the colour-blind; letters for print. Meanings: src/study/stability.h.
OUTCOMES = {
    "stable": ("s", "#009E73"),
    "damped out": ("d", "#56B4E9"),
    "drifted": ("D", "#F0E442"),
    "not back": ("n", "#CC79A7"),
    "refused": ("r", "#DDDDDD"),
    "stopped": ("x", "#E69F00"),
    "failed": ("F", "#D55E00"),
}


def unique(values):
    return list(dict.fromkeys(values))


def rows_of(study):
    """The rows that belong on a map: those that are sought by bisection have no place on it."""
    rows = [study.row(i) for i in range(study.n_rows)]
    return [row for row in rows if row["largest_step"] != row["largest_step"]]


def counts(study):
    """[(sweep, variant, {outcome: how many})], in the order of the table."""
    rows = [study.row(i) for i in range(study.n_rows)]
    groups = unique((row["sweep"], row["variant"]) for row in rows)
    of = {group: [r["outcome"] for r in rows if (r["sweep"], r["variant"]) == group] for group in groups}
    return [(*group, {name: of[group].count(name) for name in OUTCOMES}) for group in groups]


def draw_panel(axes, rows):
    """One variant in one sweep; its first change goes down, its last across."""
    cases = [row["cases"].split(", ") for row in rows]
    across, up = unique(c[-1] for c in cases), unique(c[0] for c in cases)
    for case, row in zip(cases, rows):
        letter, colour = OUTCOMES.get(row["outcome"], ("?", "white"))
        x, y = across.index(case[-1]), up.index(case[0])
        axes.add_patch(plt.Rectangle((x, y), 1, 1, facecolor=colour, edgecolor="white"))
        axes.text(x + 0.5, y + 0.5, letter, ha="center", va="center", fontsize=7)
    axes.set_xlim(0, len(across))
    axes.set_ylim(len(up), 0)
    axes.set_xticks([i + 0.5 for i in range(len(across))], across, fontsize=7)
    axes.set_yticks([i + 0.5 for i in range(len(up))], up, fontsize=7)
    axes.tick_params(length=0)
    axes.grid(False)


def stability_map(backend, rows):
    """The figure of one backend."""
    rows = [row for row in rows if row["backend"] == backend]
    variants, sweeps = unique(r["variant"] for r in rows), unique(r["sweep"] for r in rows)
    size = (max(6.5, 3.2 * len(sweeps)), 0.8 + 1.9 * len(variants))
    figure, grid = plt.subplots(len(variants), len(sweeps), figsize=size, squeeze=False)
    for i, variant in enumerate(variants):
        for j, sweep in enumerate(sweeps):
            panel = [r for r in rows if r["variant"] == variant and r["sweep"] == sweep]
            if panel:
                draw_panel(grid[i][j], panel)
            else:
                grid[i][j].axis("off")
            if i == 0:
                grid[i][j].set_title(sweep)
        grid[i][0].set_ylabel(variant, fontsize=8)
    patches = [
        plt.Rectangle((0, 0), 1, 1, facecolor=colour, label=f"{letter}: {name}")
        for name, (letter, colour) in OUTCOMES.items()
    ]
    figure.legend(handles=patches, ncol=len(patches), loc="lower center", handlelength=1, columnspacing=1)
    figure.tight_layout(rect=(0, 0.3 / size[1], 1, 1))
    return figure

#!/usr/bin/python3
"""Maps of a study of stability: one picture a backend.

    results/reference/studies/plot_stability.py results/stability/stability.h5 [FOLDER]

Needs Debian's python3-h5py and python3-matplotlib. A row of panels is a variant, a column a sweep; a cell is a run, its
letter and colour what became of it (src/study/stability.h).
"""

import pathlib
import sys

import h5py
import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt

# Colours of Okabe and Ito, told apart by the colour-blind; letters for print.
OUTCOMES = {
    "stable": ("s", "#009E73"),
    "damped out": ("d", "#56B4E9"),
    "drifted": ("D", "#F0E442"),
    "not back": ("n", "#CC79A7"),
    "refused": ("r", "#DDDDDD"),
    "stopped": ("x", "#E69F00"),
    "failed": ("F", "#D55E00"),
}


def read_rows(path):
    with h5py.File(path) as file:
        columns = {name: data[:] for name, data in file["stability/rows"].items()}
    rows = [dict(zip(columns, values)) for values in zip(*columns.values())]
    return [{k: v.decode() if isinstance(v, bytes) else v for k, v in row.items()} for row in rows]


def unique(values):
    return list(dict.fromkeys(values))


def draw_panel(axes, rows):
    cases = [row["cases"].split(", ") for row in rows]
    across, up = unique(c[-1] for c in cases), unique(c[0] for c in cases)
    for case, row in zip(cases, rows):
        letter, colour = OUTCOMES[row["outcome"]]
        x, y = across.index(case[-1]), up.index(case[0])
        axes.add_patch(plt.Rectangle((x, y), 1, 1, facecolor=colour, edgecolor="white"))
        axes.text(x + 0.5, y + 0.5, letter, ha="center", va="center", fontsize=7)
    axes.set_xlim(0, len(across))
    axes.set_ylim(len(up), 0)
    axes.set_xticks([i + 0.5 for i in range(len(across))], across, fontsize=7)
    axes.set_yticks([i + 0.5 for i in range(len(up))], up, fontsize=7)
    axes.tick_params(length=0)


def draw_backend(backend, rows, path):
    variants, sweeps = unique(r["variant"] for r in rows), unique(r["sweep"] for r in rows)
    figure, grid = plt.subplots(
        len(variants), len(sweeps), figsize=(3.2 * len(sweeps), 1.9 * len(variants)), squeeze=False
    )
    for i, variant in enumerate(variants):
        for j, sweep in enumerate(sweeps):
            panel = [r for r in rows if r["variant"] == variant and r["sweep"] == sweep]
            if panel:
                draw_panel(grid[i][j], panel)
            else:
                grid[i][j].axis("off")
            if i == 0:
                grid[i][j].set_title(sweep, fontsize=9)
        grid[i][0].set_ylabel(variant, fontsize=8)
    legend = [
        plt.Rectangle((0, 0), 1, 1, facecolor=colour, label=f"{letter}: {name}")
        for name, (letter, colour) in OUTCOMES.items()
    ]
    figure.legend(handles=legend, ncol=len(legend), loc="lower center", fontsize=8, frameon=False)
    figure.suptitle(backend)
    figure.tight_layout(rect=(0, 0.03, 1, 0.98))
    figure.savefig(path, dpi=100)
    plt.close(figure)


def main():
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    source = pathlib.Path(sys.argv[1])
    folder = pathlib.Path(sys.argv[2]) if len(sys.argv) > 2 else source.parent
    rows = [r for r in read_rows(source) if r["sweep"] != "largest-step"]
    for backend in unique(r["backend"] for r in rows):
        path = folder / f"stability_{backend}.png"
        draw_backend(backend, [r for r in rows if r["backend"] == backend and "beyond" not in r["variant"]], path)
        print(path)


if __name__ == "__main__":
    main()

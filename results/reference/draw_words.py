#!/usr/bin/python3
"""What the words of src/cut/README.md mean, drawn from a run of params/words.prm: a plane of the grid at rest, and the
copies as they stand at the end.

    results/reference/draw_words.py results/words results/reference/words.png

Needs Debian's python3-h5py and python3-matplotlib.
"""

import pathlib
import sys

import h5py
import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np

SKIN, CUT, RIM, FRONT, NODE = "#0072B2", "#D55E00", "#CC79A7", "#F0E442", "#222222"
TOGETHER, LEFT, RIGHT = "#DDDDDD", "#56B4E9", "#E69F00"
AXES = (0, 2)  # that are drawn: x, z
ACROSS = 1


def read(folder):
    with h5py.File(pathlib.Path(folder) / "run.h5") as file:
        body = file["bodies"][list(file["bodies"])[0]]
        complex_ = {k: v[:] for k, v in body["complex"][sorted(body["complex"])[-1]].items()}
        last = sorted(body["surface"])[-1]
        surface = {k: body["surface"][last][k][:] for k in ("rest_position", "triangles", "label")}
        frames = body["frames"]
        position = frames[sorted(frames)[-1]]["position"][:]
    return complex_, surface, position


def copies_of_cells(complex_):
    """Copies by cell."""
    found = {}
    for copy, cell in enumerate(complex_["cell"]):
        found.setdefault(tuple(cell), []).append(copy)
    return found


def in_plane(surface, level, eps):
    """Sides of triangles in the plane y = level: two vertices, and the labels of the triangles there."""
    sides = {}
    y = surface["rest_position"][:, ACROSS]
    for triangle, label in zip(surface["triangles"], surface["label"]):
        for a, b in zip(triangle, np.roll(triangle, -1)):
            if abs(y[a] - level) < eps and abs(y[b] - level) < eps:
                sides.setdefault((min(a, b), max(a, b)), set()).add(label)
    return sides


def box(axes, lower, h, **style):
    axes.add_patch(plt.Rectangle([lower[a] for a in AXES], h, h, **style))


def name(axes, text, at, offset, colour="black"):
    axes.annotate(text, at, xytext=offset, textcoords="offset points", fontsize=11, color=colour, ha="center", va="center",
                  arrowprops={"arrowstyle": "-", "color": colour, "lw": 0.8})


def draw_rest(axes, complex_, surface, layer, h):
    """The grid's plane above a layer of cells; behind it those cells, tinted where they are several copies."""
    rest, corners = complex_["rest_position"], complex_["corners"]
    cells = copies_of_cells(complex_)
    level, fronts, rims = None, [], []
    for cell, copies in cells.items():
        if cell[ACROSS] != layer:
            continue
        lower = rest[corners[copies[0]][0]]
        level = lower[ACROSS] + h
        n = len(copies)
        box(axes, lower, h, fc="#F3E2D3" if n > 1 else "white", ec="#BBBBBB", lw=0.8, zorder=0)
        below = (cell[0], cell[1], cell[2] - 1)
        if n > 1 and len(cells.get(below, [])) == 1:
            fronts.append(lower)
    for lower in fronts:
        box(axes, lower, h, fc=FRONT, alpha=0.5, ec="none", zorder=0)
    sides = in_plane(surface, level, 1e-9 * h)
    seen = surface["rest_position"]
    of_vertex = {}
    for (a, b), labels in sides.items():
        line = seen[[a, b]][:, AXES]
        colour = SKIN if labels == {0} else CUT
        axes.plot(line[:, 0], line[:, 1], color=colour, lw=2, zorder=2)
        for v in (a, b):
            of_vertex.setdefault(v, set()).add(colour)
    for v, colours in of_vertex.items():
        p = seen[v][list(AXES)]
        if len(colours) == 2:
            rims.append(p)
            axes.plot(*p, "o", color=RIM, ms=9, zorder=4)
        else:
            axes.plot(*p, "s", color=next(iter(colours)), ms=3.5, zorder=3)
    material, empty = set(), set()
    for copy, cell in enumerate(complex_["cell"]):
        if cell[ACROSS] != layer:
            continue
        for v in (2, 3, 6, 7):  # the cell's upper side along y
            place = tuple(np.round(rest[corners[copy][v]][list(AXES)], 9))
            (material if complex_["nodes"][copy] >> v & 1 else empty).add(place)
    for p in material:
        axes.plot(*p, "o", color=NODE, ms=6, zorder=3)
    for p in empty - material:
        axes.plot(*p, "o", mfc="white", color=NODE, ms=5, zorder=1)
    return sides, seen, fronts, rims, material


def draw_now(axes, complex_, position, layer):
    """Upper sides of the layer's copies as they stand, real corners filled; those of divided cells in two colours."""
    cells = copies_of_cells(complex_)
    corners = complex_["corners"]
    for cell, copies in cells.items():
        if cell[ACROSS] != layer:
            continue
        by_place = sorted(copies, key=lambda c: position[corners[c]][:, 0].mean())
        for i, copy in enumerate(by_place):
            quad = position[corners[copy][[2, 3, 7, 6]]][:, AXES]
            colour = TOGETHER if len(copies) == 1 else (LEFT, RIGHT)[min(i, 1)]
            axes.add_patch(plt.Polygon(quad, fc=colour, ec="#777777", alpha=0.45, lw=1, zorder=1 + len(copies)))
            for v in (2, 3, 6, 7):
                is_real = complex_["nodes"][copy] >> v & 1
                p = position[corners[copy][v]][list(AXES)]
                axes.plot(*p, "o", color=NODE, mfc=NODE if is_real else "white", ms=6 if is_real else 5, zorder=6 if is_real else 5)
    return cells


def arc(sides, seen, lower, h):
    """The two segments of the skin in a face: points on edges at both ends, one in the face between them."""
    around = {}
    for (a, b), labels in sides.items():
        if labels == {0}:
            around.setdefault(a, []).append(b)
            around.setdefault(b, []).append(a)

    def is_on_edge(v):
        cubes = (seen[v][list(AXES)] - lower) / h
        return np.min(np.abs(cubes - np.round(cubes))) < 1e-6

    arcs = [seen[[ends[0], v, ends[1]]][:, AXES] for v, ends in around.items()
            if len(ends) == 2 and not is_on_edge(v) and all(map(is_on_edge, ends))]
    return max(arcs, key=lambda a: a[1][0] - a[1][1])  # to the lower right


def main(folder, file):
    complex_, surface, position = read(folder)
    first = complex_["corners"][0]
    h = np.ptp(complex_["rest_position"][first][:, 0])
    layers = sorted(set(complex_["cell"][:, ACROSS]))
    layer = layers[len(layers) // 2 - 1]
    figure, (left, right) = plt.subplots(1, 2, figsize=(15, 7.6))
    sides, seen, fronts, rims, material = draw_rest(left, complex_, surface, layer, h)
    cells = draw_now(right, complex_, position, layer)

    skin = [seen[[a, b]][:, AXES] for (a, b), labels in sides.items() if labels == {0}]
    cut = [seen[[a, b]][:, AXES] for (a, b), labels in sides.items() if labels != {0}]
    rightmost = max(material, key=lambda p: (p[0], p[1]))
    lowest = min(material, key=lambda p: (p[1], p[0]))
    segment = min(skin, key=lambda s: s[:, 0].mean())
    name(left, "node", rightmost, (60, -6))
    left.plot([lowest[0]] * 2, [lowest[1], lowest[1] + h], color=NODE, lw=2.5, zorder=2)
    name(left, "edge", (lowest[0], lowest[1] + h / 2), (-75, -20))
    name(left, "segment of the skin", segment.mean(axis=0), (-65, 40), SKIN)
    curve = arc(sides, seen, complex_["rest_position"][first[0]][list(AXES)], h)
    left.plot(curve[:, 0], curve[:, 1], color=SKIN, lw=5, zorder=2)
    name(left, "arc", curve[1], (55, -30), SKIN)
    name(left, "cut", min(cut, key=lambda s: s[:, 1].mean()).mean(axis=0) if cut else (0, 0), (65, 10), CUT)
    for rim in sorted(rims, key=lambda p: p[0])[:1]:
        name(left, "rim", rim, (-45, 28), RIM)
    for front in fronts[:1]:
        name(left, "cell of the front", (front[0] + h / 2, front[2] + h / 3), (80, -55), "#8a7d00")
    divided = [c for cell, c in cells.items() if cell[ACROSS] == layer and len(c) > 1]
    if divided:
        top = max(divided, key=lambda c: position[complex_["corners"][c[0]]][:, 2].mean())
        a, b = sorted(top, key=lambda c: position[complex_["corners"][c]][:, 0].mean())[:2]
        for copy, text, offset, colour in ((a, "copy", (-75, 55), LEFT), (b, "copy of the same cell", (70, 60), RIGHT)):
            centre = position[complex_["corners"][copy]][:, AXES].mean(axis=0)
            name(right, text, centre, offset, colour)
    real = [position[complex_["corners"][c][v]][list(AXES)] for cell, cs in cells.items() if cell[ACROSS] == layer
            for c in cs for v in (2, 3, 6, 7) if complex_["nodes"][c] >> v & 1]
    unreal = [position[complex_["corners"][c][v]][list(AXES)] for c in sum(divided, []) for v in (2, 3, 6, 7)
              if not complex_["nodes"][c] >> v & 1]
    name(right, "real corner", min(real, key=lambda p: p[0]), (-40, -80))
    if unreal:
        name(right, "virtual corner", max(unreal, key=lambda p: p[0]), (75, 30))
    whole = np.array([position[complex_["corners"][c]][:, AXES].mean(axis=0) for cell, cs in cells.items()
                      if cell[ACROSS] == layer for c in cs])
    name(right, "piece: all of them", whole[np.argmin(whole[:, 1])], (-95, -10))
    for axes, title in ((left, "a plane of the grid, at rest"), (right, "copies below it, as they stand")):
        axes.set_title(title, fontsize=12)
        axes.set_aspect("equal")
        axes.axis("off")
        axes.margins(0.12)
    figure.tight_layout()
    figure.savefig(file, dpi=80)


if __name__ == "__main__":
    main(*sys.argv[1:3])

"""The surface of a run as viewer.js reads it: positions in 2^13 steps of their box, packed."""

import base64
import zlib

import numpy as np

from . import run_figures

STEPS = 2**13 - 1  # of the box: finer than a pixel


def packed(integers):
    """Integers (n, columns) as text: differences along each column, low bytes before high ones, deflated, base64."""
    differences = np.diff(integers.astype(np.int64), axis=0, prepend=0).T.ravel().astype("<i4")
    planes = differences.view(np.uint8).reshape(-1, 4).T
    return base64.b64encode(zlib.compress(planes.tobytes(), 9)).decode()


def encoded_topology(surface, inside):
    """Triangles, what revealed each (0: the skin), and its colour where the inside has one."""
    topology = {"triangles": packed(surface.triangles), "labels": packed(surface.labels[:, None])}
    if inside is not None:
        topology["colours"] = packed(np.where(np.isfinite(inside), inside, -1).round())
    return topology


def encoded_points(points):
    low = points.min(axis=0)
    step = max(np.ptp(points, axis=0).max(), 1e-300) / STEPS
    return {"low": low.tolist(), "step": step, "points": packed(((points - low) / step).round())}


def encoded_frames(run, frames):
    """Frames by number, with each topology once."""
    view = {"frames": [], "topologies": []}
    known = {}
    for frame in frames:
        parts = []
        for name, body in run.bodies.items():
            surface = body.surface(frame) if frame < len(body) else None
            if surface is None or not len(surface.points):
                continue
            if (name, surface.topology) not in known:
                known[name, surface.topology] = len(view["topologies"])
                view["topologies"].append(encoded_topology(surface, body.colours(frame)))
            parts.append({"topology": known[name, surface.topology], **encoded_points(surface.points)})
            time = float(surface.time)
        if parts:
            view["frames"].append({"time": time, "bodies": parts})
    return view


def size(view):
    """Bytes that the texts of a view take."""
    texts = [t for topology in view["topologies"] for t in topology.values()]
    return sum(map(len, texts)) + sum(len(b["points"]) for f in view["frames"] for b in f["bodies"])


def encoded(run, budget):
    """As many frames, evenly spread, as fit into so many bytes; None where not even the last one does."""
    n = max((len(body) for body in run.bodies.values()), default=0)
    wanted = n
    while wanted > 0:
        frames = sorted(set(np.linspace(n - 1, 0, wanted).round().astype(int).tolist()))
        view = encoded_frames(run, frames)
        if size(view) <= budget:
            palette = [run_figures.SKIN, *run_figures.CUTS]
            return {**view, "palette": palette, "n_all": n} if view["frames"] else None
        wanted = min(wanted - 1, int(0.95 * wanted * budget / size(view)))
    return None

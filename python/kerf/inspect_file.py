"""What is in a file, in people's words."""

import pathlib
import struct

import numpy as np

from . import files, runs, studies


def size(n_bytes):
    for unit in ("bytes", "kB", "MB"):
        if n_bytes < 1000:
            return f"{n_bytes:.3g} {unit}"
        n_bytes /= 1000
    return f"{n_bytes:.3g} GB"


def columns(rows, indent="  "):
    """Rows of texts in columns of equal width."""
    widths = [max(len(row[i]) for row in rows) for i in range(len(rows[0]))] if rows else []
    return [(indent + "  ".join(text.ljust(w) for text, w in zip(row, widths))).rstrip() for row in rows]


def of_run(path):
    run = runs.Run(path)
    lines = [f"outcome: {run.outcome}" + (f": {run.failure}" if run.failure else "")]
    lines.append(
        f"{len(run.time)} output steps" + (f", {run.time[0]:g} to {run.time[-1]:g} s" if len(run.time) else "")
    )
    lines.append("series, from first to last:" if run.series else "no series")
    rows = [
        (s.name, f"[{s.unit}]", f"{s.values[0]:.5g} to {s.values[-1]:.5g}")
        for s in run.series.values()
        if len(s.values)
    ]
    lines += columns(rows)
    for body in run.bodies.values():
        lines.append(f"body {body.name}: {len(body)} frames" + described_frame(body))
    total = sum(s.values.sum() for s in run.timing.values())
    stages = sorted(((s.values.sum(), n) for n, s in run.timing.items() if s.values.sum() > 0), reverse=True)
    lines.append(f"{total:.3g} s of wall-clock time: " + ", ".join(f"{n} {t:.3g} s" for t, n in stages))
    return lines + provenance(run.info)


def described_frame(body):
    if not len(body):
        return ""
    volume, surface = body.volume(-1), body.surface(-1)
    faces = f"{len(surface.points)} vertices, {len(surface.triangles)} triangles" if surface else "no surface"
    fields = ", ".join(f"{name} [{field.unit}]" for name, field in volume.fields.items())
    last = f"; the last, at {volume.time:g} s: {len(volume.cells)} copies, {len(volume.points)} corners, {faces}"
    return last + (f"; fields: {fields}" if fields else "")


def of_study(path):
    study = studies.Study(path)
    lines = [study.title, f"outcome: {study.outcome}", f"value: {study.answer} [{study.columns['value'].unit}]"]
    bad = studies.failed(study)
    lines.append(f"{study.n_rows} rows, {len(bad)} of them failed")
    lines += [f"  {study.columns['name'].values[i]}: {study.columns['outcome'].values[i]}" for i in bad]
    for norm in studies.norms(study):
        front = [study.row(i) for i in studies.fronts(study, norm)]
        lines.append(f"on the Pareto front of {norm} and CPU time:")
        lines += columns([(r["name"], f"{100 * r[norm]:+.2f} %", f"{r['setup_cpu_time'] + r['cpu_time']:.3g} s") for r in front])
    lines.append("columns: " + ", ".join(f"{name} [{c.unit}]" for name, c in study.columns.items()))
    return lines + provenance(study.info)


def of_stability(path):
    study = studies.Study(path, "stability")
    outcomes = study.columns["outcome"].values
    counts = ", ".join(f"{outcomes.count(o)} {o}" for o in dict.fromkeys(outcomes))
    return [study.title, f"outcome: {study.outcome}", f"{study.n_rows} rows: {counts}", *provenance(study.info)]


def of_bench(path):
    with files.open_h5(path) as file, files.told(path):
        bench, info = file["bench"], files.provenance(file)
        names = ("path", "cells", "n", "item", "seconds", "rate")
        rows = zip(*(files.column(bench["rows"][name]) for name in names), strict=True)
        lines = [
            f"on {bench.attrs['threads']} threads; the machine does {bench.attrs['peak_flops']:.3g} additions and "
            f"multiplications a second, and moves {bench.attrs['bandwidth']:.3g} bytes a second"
        ]
        lines += columns([(p, f"{c} cells", f"{n} {i}", f"{1e3 * s:.4g} ms", f"{r:.3g} /s") for p, c, n, i, s, r in rows])
        return lines + provenance(info)


def of_vtk(path):
    """A surface or cells for ParaView."""
    with files.open_h5(path) as file, files.told(path):
        vtk = file["VTKHDF"]
        steps = vtk["Steps"]
        times, n_points = steps["Values"][()], vtk["NumberOfPoints"][()]
        lines = [f"{steps.attrs['NSteps']} steps" + (f", {times[0]:g} to {times[-1]:g} s" if len(times) else "")]
        if len(n_points):
            lines.append(f"{n_points[-1]} vertices at the end; {len(n_points)} topologies")
        for kind in ("PointData", "CellData"):
            of = {n: files.text(d.attrs["unit"]) if "unit" in d.attrs else "" for n, d in vtk.get(kind, {}).items()}
            lines.append(f"{kind}: " + ", ".join(f"{n} [{unit}]" if unit else n for n, unit in of.items()))
        return lines


def of_arrays(path):
    """The table of Splitting Cubes, and other plain arrays."""
    with files.open_h5(path) as file, files.told(path):
        lines = (
            [files.text(file.attrs["title"]), "source: " + files.text(file.attrs["source"])]
            if "title" in file.attrs
            else []
        )
        found = []

        def take(name, item):
            if hasattr(item, "shape"):
                unit = files.text(item.attrs["unit"]) if "unit" in item.attrs else "1"
                text = files.text(item.attrs["description"]) if "description" in item.attrs else ""
                found.append((name, " x ".join(map(str, item.shape)), f"[{unit}]", text))

        file.visititems(take)
        return lines + columns(found)


def provenance(info):
    return ["where it comes from:", *columns([pair for pair in info.items() if pair[0] != "outcome"])]


def of_checkpoint(path):
    """A checkpoint (src/output/checkpoint_file.h): the format's name, the program, the inputs, the step, the state."""
    content = path.read_bytes()
    at, texts = 0, []
    try:
        for _ in range(3):
            (n,) = struct.unpack_from("<Q", content, at)
            texts.append(content[at + 8 : at + 8 + n].decode())
            at += 8 + n
        step, n_state = struct.unpack_from("<qQ", content, at)
    except (struct.error, UnicodeDecodeError) as error:
        raise files.complaint(path, "is damaged, or not whole", "Go on from an earlier one, or start again") from error
    if len(content) != at + 16 + n_state + 8:
        raise files.complaint(path, "is damaged, or not whole", "Go on from an earlier one, or start again")
    whole = files.checksum(padded_words(content[:-8])) == struct.unpack("<Q", content[-8:])[0]
    inputs = [f"  {line}" for line in texts[2].splitlines()] or ["  none"]
    return [
        f"of step {step}, {size(n_state)} of state",
        "its checksum is right" if whole else "its checksum is wrong: it is damaged, and a run refuses it",
        f"written by: {texts[1]}; only the same program goes on from it (kerf run --resume)",
        "files that the scene reads (SHA-256):",
        *inputs,
    ]


def padded_words(content):
    return np.frombuffer(content + bytes(-len(content) % 8), "<u8").tolist()


def is_checkpoint(path):
    with open(path, "rb") as raw:
        return b"kerf checkpoint" in raw.read(40)


READERS = {
    "run": of_run,
    "study": of_study,
    "stability": of_stability,
    "bench": of_bench,
    "surface": of_vtk,
    "volume": of_vtk,
    "table": of_arrays,
    "arrays": of_arrays,
}


def described(path):
    """The lines about a file or folder."""
    path = pathlib.Path(files.find(path))
    n_bytes = size(path.stat().st_size)
    if is_checkpoint(path):
        return [f"{path}: a checkpoint, from which a run goes on; {n_bytes}", *of_checkpoint(path)]
    with files.open_h5(path) as file, files.told(path):
        kind = files.kind_of(file)
    if kind is None:
        raise files.complaint(path, "is HDF5, but no file of Kerf's")
    with files.told(path):
        return [f"{path}: {files.KINDS[kind]}; {n_bytes}", *READERS[kind](path)]

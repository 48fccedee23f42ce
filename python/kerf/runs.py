"""Runs for people: series with time and unit, surfaces as points and triangles, volume cells with fields."""

from typing import NamedTuple

import numpy as np

from . import files


class Series(NamedTuple):
    """A quantity over time; `values` and `time` [s] have one entry an output step."""

    name: str
    time: np.ndarray
    values: np.ndarray
    unit: str
    source: str

    def to_xarray(self):
        """As an xarray.DataArray over the coordinate `time`; needs xarray."""
        try:
            import xarray
        except ImportError as error:
            raise files.Complaint("xarray is missing. Install python3-xarray, or use .time and .values") from error
        attributes = {"units": self.unit, "source": self.source}
        time = xarray.DataArray(self.time, dims="time", attrs={"units": "s"})
        return xarray.DataArray(self.values, {"time": time}, "time", self.name, attributes)


class Surface(NamedTuple):
    """A body's closed surface in a frame."""

    time: float  # [s]
    points: np.ndarray  # (n, 3) [m], current configuration
    rest: np.ndarray  # (n, 3) [m], rest configuration
    triangles: np.ndarray  # (m, 3), counter-clockwise seen from outside
    labels: np.ndarray  # (m,): which cut revealed the triangle; 0 is the skin
    topology: int  # the same number where triangles, labels and rest are the same


class Field(NamedTuple):
    """Values at the corners, (n,) or (n, components); tensors are xx, yy, zz, xy, yz, xz."""

    values: np.ndarray
    unit: str


class Volume(NamedTuple):
    """The copies of a body's cells in a frame: hexahedra, which may be filled in part and overlap."""

    time: float  # [s]
    points: np.ndarray  # (n, 3) [m]: corners, current configuration
    rest: np.ndarray  # (n, 3) [m], rest configuration
    cells: np.ndarray  # (m, 8): corners of each copy, in VTK's order of a hexahedron
    nodes: np.ndarray  # (m,): bits of the material nodes of each copy, in deal.II's order
    fields: dict  # name -> Field
    topology: int  # the same number where cells, nodes and rest are the same


class Body:
    """A body of a run: its frames, from 0 on."""

    def __init__(self, group, name):
        self.name = name
        self._group = group
        self._kept = {}  # of the last topology that was read

    @property
    def file_name(self):
        return self._group.file.filename

    def __len__(self):
        return len(self._group["frames"]) if "frames" in self._group else 0

    def times(self):
        """Of the frames [s]."""
        return np.array([self._frame(i).attrs["time"] for i in range(len(self))])

    def _frame(self, index):
        if not -len(self) <= index < len(self):
            raise files.complaint(self.name, f"has {len(self)} frames, none of number {index}", "Count from 0")
        return self._group[f"frames/{index % len(self):06d}"]

    def _topology(self, part, frame):
        """Number and datasets of a frame's surface or complex; read once for all frames that share them."""
        group = frame[part]
        path = frame.get(part, getlink=True).path
        if part not in self._kept or self._kept[part][0] != path:
            arrays = {}
            frame[part].visititems(
                lambda name, item: arrays.update({name: item[()]}) if hasattr(item, "shape") else None
            )
            self._kept[part] = (path, int(path.rsplit("/", 1)[-1]), arrays)
        return self._kept[part][1:]

    def surface(self, index):
        """The surface in a frame; None where the file has none."""
        frame = self._frame(index)
        if "surface" not in frame:
            return None
        number, s = self._topology("surface", frame)
        corners = frame["position"][()]
        points = interpolated(s["weights/row_start"], s["weights/column"], s["weights/value"], corners)
        return Surface(frame.attrs["time"], points, s["rest_position"], s["triangles"], s["label"], number)

    def volume(self, index):
        """The cells in a frame, with velocity and fields where the file has them."""
        frame = self._frame(index)
        number, c = self._topology("complex", frame)
        datasets = dict(frame["fields"]) if "fields" in frame else {}
        if "velocity" in frame:
            datasets["velocity"] = frame["velocity"]
        fields = {name: Field(d[()], files.text(d.attrs["unit"])) for name, d in datasets.items()}
        cells = c["corners"][:, [0, 1, 3, 2, 4, 5, 7, 6]]
        return Volume(frame.attrs["time"], frame["position"][()], c["rest_position"], cells, c["nodes"], fields, number)

    def colours(self, index):
        """(m, 3), sRGB 0 .. 255: of each triangle in a frame, NaN of the skin; None without an inside."""
        _, s = self._topology("surface", self._frame(index))
        if "first_sample" not in s or "colours" not in self._group:
            return None
        seen = s["parts"] > 0
        n = s["parts"][seen].astype(np.int64)
        first, count = s["first_sample"][seen].astype(np.int64), (n + 1) * (n + 2) // 2
        sums = np.concatenate([np.zeros((1, 3)), np.cumsum(self._group["colours"][()], axis=0, dtype=float)])
        colours = np.full((len(seen), 3), np.nan)
        colours[seen] = (sums[first + count] - sums[first]) / count[:, None]
        return colours


class Run:
    """A run's file, open for reading. `series` and `timing` are dicts of Series, `bodies` one of Body."""

    def __init__(self, path):
        self.path = files.find(path)
        self.file = files.open_h5(self.path)
        with files.told(self.path):
            require(self.file, self.path, "run")
            self.time, self.step = self.file["time"][()], self.file["step"][()]
            self.outcome = files.text(self.file.attrs["outcome"])
            self.info = files.provenance(self.file)
            self.series = read_series(self.file["observables"], self.time)
            self.timing = read_series(self.file["timing"], self.time)
            self.bodies = {name: Body(group, name) for name, group in self.file["bodies"].items()}
            self.scene = files.text(self.file["scene"][()]) if "scene" in self.file else ""
            self.composition = files.column(self.file["composition"]) if "composition" in self.file else []
            self.inputs = files.column(self.file["inputs"]) if "inputs" in self.file else []
            self.failure = read_failure(self.file)


def require(file, path, kind):
    """Complains about a file of another kind."""
    found = files.kind_of(file)
    if found != kind:
        what = "is HDF5, but no file of Kerf's" if found is None else f"is {files.KINDS[found]}"
        raise files.complaint(path, f"{what}; wanted is {files.KINDS[kind]}")


def read_series(group, time):
    """The datasets of a group in the order in which they were recorded, as a dict of Series."""
    datasets = sorted(group.items(), key=lambda item: int(item[1].attrs.get("index", 0)))
    return {
        name: Series(name, time, d[()], files.text(d.attrs["unit"]), files.text(d.attrs["source"]))
        for name, d in datasets
    }


def read_failure(file):
    """Why the run ended early, and when; "" where it did not."""
    if "failure" not in file:
        return ""
    dataset = file["failure"]
    return f"{files.text(dataset[()])} (step {dataset.attrs['step']}, {dataset.attrs['time']:g} s)"


def interpolated(row_start, column, value, corners):
    """W times corners: (n, 3) of the n rows of a sparse W."""
    n = len(row_start) - 1
    row = np.repeat(np.arange(n), np.diff(row_start.astype(np.int64)))
    axes = [np.bincount(row, value * corners[column, axis], n) for axis in range(3)]
    return np.stack(axes, axis=1)

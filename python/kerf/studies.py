"""Studies for people: the rows as columns, who is on the front, and orders of convergence."""

from typing import NamedTuple

import numpy as np

from . import files, runs


class Column(NamedTuple):
    """One entry a row: an array of numbers (NaN where it is not known), or a list of strings."""

    values: object
    unit: str
    description: str


class Study:
    """The table of a study, or of a study of stability: `columns` is a dict of Column, all of `n_rows` entries."""

    def __init__(self, path, kind="study"):
        self.path = files.find(path)
        with files.open_h5(self.path) as file, files.told(self.path):
            runs.require(file, self.path, kind)
            self.title = files.text(file.attrs["title"])
            self.outcome = files.text(file.attrs["outcome"])
            self.info = files.provenance(file)
            self.text = files.text(file[kind + "/text"][()])
            rows = file[kind + "/rows"]
            self.answer = files.text(rows.attrs.get("answer", ""))
            self.columns = {name: read_column(dataset) for name, dataset in rows.items()}
        lengths = {len(column.values) for column in self.columns.values()}
        if len(lengths) != 1:
            raise files.complaint(self.path, "its columns are not equally long", "Run the study again")
        self.n_rows = lengths.pop()

    def row(self, index):
        """One row: name of the column -> value."""
        return {name: column.values[index] for name, column in self.columns.items()}


def read_column(dataset):
    unit, description = (files.text(dataset.attrs[name]) for name in ("unit", "description"))
    return Column(files.column(dataset), unit, description)


def failed(study):
    """Numbers of the rows that did not complete."""
    return [i for i, outcome in enumerate(study.columns["outcome"].values) if outcome != "completed"]


def norms(study):
    """Names of the columns that are errors of at least one row."""
    numbers = {n: c for n, c in study.columns.items() if n.startswith("error") and isinstance(c.values, np.ndarray)}
    return [name for name, column in numbers.items() if np.isfinite(column.values).any()]


def has_families(study):
    """Whether some rows differ in nothing but what orders are told over."""
    families = study.columns["family"].values
    return len(set(families)) < len(families)


def without_grids(study):
    """Of each row its name without the axes along which the grid changes and nothing else does."""
    names = [tuple(name.split(", ")) for name in study.columns["name"].values]
    h = dict(zip(names, study.columns["h"].values))
    kept = []
    for axis in range(max(map(len, names))):
        parts = {}
        for name in names:
            parts.setdefault(name[:axis] + name[axis + 1 :], []).append(h[name])
        if axis == 0 or not all(len(set(values)) == len(values) > 1 for values in parts.values()):
            kept.append(axis)
    return [", ".join(name[axis] for axis in kept if axis < len(name)) for name in names]


def methods(study):
    """Method -> numbers of its rows, in the table's order: a method is a family; where there are none, what rows of one
    problem differ in beside their grid, or a variant where rows are of several."""
    families = study.columns["family"].values
    if not has_families(study):
        variants = [name.split(", ")[0] for name in study.columns["name"].values]
        families = without_grids(study) if len(problems(study)) == 1 else variants
    return {method: [i for i, f in enumerate(families) if f == method] for method in dict.fromkeys(families)}


def has_times(study):
    """Whether the times of any of its rows count."""
    return bool((study.columns["stepping_time"].values > 0).any())


def cpu_times(study):
    """Of set-up and steps of each row [s]."""
    return study.columns["setup_cpu_time"].values + study.columns["cpu_time"].values


def half_spreads(study):
    """Of the CPU time of each row's steps over its repetitions [s]; 0 where there were none."""
    return np.nan_to_num(study.columns["cpu_spread"].values) / 2


def comparable(study, norm):
    """(rows, CPU time of set-up and steps [s], error [1]): the rows that completed with an error; the error without its
    sign. Times that do not count are NaN."""
    times, errors = cpu_times(study), np.abs(study.columns[norm].values)
    good = [i for i in range(study.n_rows) if study.columns["outcome"].values[i] == "completed"]
    rows = np.array([i for i in good if np.isfinite(errors[i]) and errors[i] > 0 and not times[i] <= 0], int)
    return rows, times[rows], errors[rows]


def problems(study):
    """Groups of rows that may be compared with each other: those with one reference; where orders are told, all."""
    if has_families(study):
        return {"": list(range(study.n_rows))}
    references = [str(value) for value in study.columns["reference"].values]
    return {one: [i for i, r in enumerate(references) if r == one] for one in dict.fromkeys(references)}


def front(times, errors):
    """Indices of the Pareto front, by time: those that nobody beats in time and error at once."""
    best, found = np.inf, []
    for i in np.lexsort((errors, times)):
        if np.isfinite(times[i]) and errors[i] < best:
            best = errors[i]
            found.append(int(i))
    return found


def fitted_order(h, errors):
    """(order, factor) of errors = factor h^order, least squares of the logarithms; None with fewer than two grids."""
    good = np.isfinite(errors) & (errors > 0) & np.isfinite(h) & (h > 0)
    if len(set(h[good])) < 2:
        return None
    order, shift = np.polyfit(np.log(h[good]), np.log(errors[good]), 1)
    return float(order), float(np.exp(shift))


def fronts(study, norm):
    """Numbers of the rows on the front of their problem, in the order of the table."""
    rows, times, errors = comparable(study, norm)
    found = []
    for members in problems(study).values():
        mine = np.flatnonzero(np.isin(rows, members))
        found += [int(rows[mine[i]]) for i in front(times[mine], errors[mine])]
    return sorted(found)


def orders(study, norm="error"):
    """Method -> (order, factor) of error = factor h^order, for those with several grids."""
    h, errors = study.columns["h"].values, np.full(study.n_rows, np.nan)
    rows, _, good = comparable(study, norm)
    errors[rows] = good
    if not has_families(study):
        return {}
    fits = {m: fitted_order(h[members], errors[members]) for m, members in methods(study).items()}
    return {method: fit for method, fit in fits.items() if fit}

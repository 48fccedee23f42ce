"""The report's numbers against the HDF5, and that the page needs nothing but itself."""

import base64
import contextlib
import html.parser
import io
import pathlib
import re
import tempfile
import unittest
import zlib

from support import FILES, kerf
import h5py
import numpy as np

import kerf as package
from kerf import page, report, studies, study_figures, surface_view

FIVE = ["quick", "energy", "bar", "springs", "short"]  # two studies and three runs


class Reader(html.parser.HTMLParser):
    """Tables by id: rows of (text, exact value or None); every address and every element's name."""

    def __init__(self):
        super().__init__()
        self.tables, self.addresses, self.names, self.rows, self.cell = {}, [], [], None, None

    def handle_starttag(self, tag, attributes):
        attributes = dict(attributes)
        self.names.append(tag)
        self.addresses += [attributes[k] for k in ("src", "href", "action") if k in attributes]
        if tag == "table":
            self.rows = self.tables[attributes["id"]] = []
        elif tag == "tr" and self.rows is not None:
            self.rows.append([])
        elif tag in ("td", "th"):
            self.cell = ["", attributes.get("data-value")]

    def handle_data(self, data):
        if self.cell is not None:
            self.cell[0] += data

    def handle_endtag(self, tag):
        if tag in ("td", "th"):
            self.rows[-1].append(tuple(self.cell))
            self.cell = None


def column_of(table, title):
    """(texts, exact values) below the header that begins with the title."""
    number = next(i for i, cell in enumerate(table[0]) if cell[0].split(" [")[0] == title)
    cells = [row[number] for row in table[1:]]
    return [cell[0] for cell in cells], [float(cell[1]) if cell[1] else None for cell in cells]


class Report(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        done = kerf("report", *(FILES / name for name in FIVE), FILES / "block", "--output", cls.folder.name)
        assert done.returncode == 0, done.stderr
        cls.said = done.stdout
        cls.path = pathlib.Path(cls.folder.name) / "report.html"
        cls.text = cls.path.read_text()
        cls.page = Reader()
        cls.page.feed(cls.text)

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def test_the_rows_of_studies_are_those_of_the_hdf5_to_the_last_digit(self):
        titles = {
            "value": "value",
            "error": "error",
            "h": "h",
            "setup_cpu_time": "set-up CPU",
            "cpu_time": "steps CPU",
            "dof": "dof",
            "iterations": "iterations",
        }
        for name in ("quick", "energy"):
            with h5py.File(FILES / name / "study.h5") as file:
                for column, title in titles.items():
                    shown, exact = column_of(self.page.tables[f"{name}-rows"], title)
                    wanted = file["study/rows"][column][()]
                    np.testing.assert_array_equal(np.array(exact), wanted)
                    factor = 100 if column == "error" else 1
                    for text, value in zip(shown, wanted):
                        if text != "–":
                            self.assertAlmostEqual(
                                float(text), factor * value, delta=0.006 + 5e-4 * abs(factor * value)
                            )

    def test_the_series_of_runs_are_those_of_the_hdf5(self):
        for name in ("bar", "springs", "short"):
            table = self.page.tables[f"{name}-series"]
            names, _ = column_of(table, "series")
            with h5py.File(FILES / name / "run.h5") as file:
                self.assertEqual(set(names), set(file["observables"]))
                for title, take in {"first": lambda v: v[0], "last": lambda v: v[-1], "largest": max}.items():
                    _, exact = column_of(table, title)
                    self.assertEqual(exact, [take(file["observables"][n][()]) for n in names])

    def test_stages_add_up(self):
        with h5py.File(FILES / "bar/run.h5") as file:
            names, _ = column_of(self.page.tables["bar-stages"], "stage")
            _, seconds = column_of(self.page.tables["bar-stages"], "wall-clock time")
            np.testing.assert_allclose(seconds, [file["timing"][n][()].sum() for n in names], rtol=1e-14)

    def test_counts_of_stability(self):
        with h5py.File(FILES / "block/stability.h5") as file:
            outcomes = [o.decode() for o in file["stability/rows/outcome"]]
        for outcome in ("stable", "refused", "failed"):
            self.assertEqual(sum(column_of(self.page.tables["block-counts"], outcome)[1]), outcomes.count(outcome))

    def test_failed_rows_and_missing_references_are_told(self):
        self.assertIn("3 of 18 rows failed", self.text)
        self.assertIn("is stable here up to 0.00605", self.text)
        self.assertIn("the study has no reference", self.text)

    def test_the_page_asks_for_nothing_else_and_is_small(self):
        self.assertLess(self.path.stat().st_size, 10e6)
        self.assertEqual([a for a in self.page.addresses if not a.startswith(("data:", "#"))], [])
        self.assertFalse({"link", "iframe", "object", "embed"} & set(self.page.names))
        self.assertIn("default-src 'none'", self.text)
        self.assertNotIn("@import", self.text.split("</style>")[0])
        self.assertIn("@media print", self.text)

    def test_the_licence_of_what_it_carries_stands_in_it(self):
        if not page.three_is_there():
            self.skipTest("libjs-three is missing")
        self.assertIn("three.js authors", self.text)
        self.assertEqual(self.text.count('class="viewer"'), 3)

    def test_figures_are_there_as_png_and_svg(self):
        figures = pathlib.Path(self.folder.name) / "figures"
        for name in (
            "quick_error_time",
            "quick_error_h",
            "quick_stages",
            "bar_series",
            "bar_surface",
            "runs_series",
            "block_fem",
        ):
            self.assertEqual((figures / f"{name}.png").read_bytes()[:4], b"\x89PNG", name)
            self.assertIn(b"<svg", (figures / f"{name}.svg").read_bytes()[:1000], name)
        self.assertFalse((figures / "energy_error_time.png").exists())

    def test_what_it_draws_are_the_rows(self):
        study = package.open(FILES / "quick")
        figure = study_figures.error_against_time([study], ["quick"])
        lines = {line.get_label(): line.get_xydata() for line in figure.axes[0].lines}
        with h5py.File(FILES / "quick/study.h5") as file:
            rows = file["study/rows"]
            mine = [i for i, name in enumerate(rows["family"]) if name == b"pba"]
            times = rows["setup_cpu_time"][()] + rows["cpu_time"][()]
            wanted = np.column_stack([times[mine], np.abs(rows["error"][()][mine])])
        np.testing.assert_array_equal(lines["pba"], wanted[np.argsort(wanted[:, 0])])
        rings = [line for line in figure.axes[0].lines if line.get_label() == "on the Pareto front"]
        self.assertEqual(len(rings), len(studies.fronts(study, "error")))

    def test_times_of_repetitions_are_as_wide_as_they_are_apart(self):
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder) / "study.h5"
            path.write_bytes((FILES / "quick/study.h5").read_bytes())
            with h5py.File(path, "r+") as file:
                rows = file["study/rows"]
                mine = [i for i, name in enumerate(rows["family"]) if name == b"pba"]
                time = rows["setup_cpu_time"][mine[0]] + rows["cpu_time"][mine[0]]
                error = abs(rows["error"][mine[0]])
                rows["cpu_spread"][mine[0]] = 0.5 * time
            figure = study_figures.error_against_time([package.open(path)], ["quick"])
            (bars,) = figure.axes[0].collections
            np.testing.assert_allclose(
                [s for s in bars.get_segments() if s[0, 0] < s[1, 0]], [[[0.75 * time, error], [1.25 * time, error]]]
            )

    def test_rows_with_one_reference_share_a_front(self):
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder) / "study.h5"
            path.write_bytes((FILES / "quick/study.h5").read_bytes())
            with h5py.File(path, "r+") as file:
                rows = file["study/rows"]
                attributes = dict(rows["family"].attrs)
                del rows["family"]
                rows["family"] = rows["name"][()]  # as where no axis is named for orders
                rows["family"].attrs.update(attributes)
                rows["reference"][:] = 1
            study = package.open(path)
            self.assertEqual(len(studies.problems(study)), 1)
            self.assertEqual(studies.fronts(study, "error"), studies.fronts(package.open(FILES / "quick"), "error"))
            self.assertEqual(
                list(studies.methods(study).values()), list(studies.methods(package.open(FILES / "quick")).values())
            )

    def test_methods_differ_in_more_than_colour(self):
        figure = study_figures.error_against_time([package.open(FILES / "quick")], ["quick"])
        lines = [line for line in figure.axes[0].lines if line.get_label() != "on the Pareto front"]
        for looks in ([line.get_marker() for line in lines], [line.get_color() for line in lines]):
            self.assertEqual(len(set(looks)), len(looks))

    def test_a_study_whose_times_do_not_count_has_no_figure_over_time(self):
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder) / "timeless" / "study.h5"
            path.parent.mkdir()
            path.write_bytes((FILES / "quick/study.h5").read_bytes())
            with h5py.File(path, "r+") as file:
                for name in ("setup_time", "stepping_time", "setup_cpu_time", "cpu_time"):
                    file["study/rows"][name][:] = np.nan
            done = kerf("report", path.parent, FILES / "quick", "--output", f"{folder}/out")
            self.assertEqual(done.returncode, 0, done.stderr)
            figures = {figure.name for figure in pathlib.Path(folder, "out/figures").glob("*.png")}
            self.assertIn("timeless_error_h.png", figures)
            self.assertNotIn("timeless_error_time.png", figures)
            self.assertIn("quick_error_time.png", figures)

    def test_a_report_is_not_replaced_unasked(self):
        again = kerf("report", FILES / "short", "--output", self.folder.name)
        self.assertEqual(again.returncode, 1)
        self.assertIn("--force", again.stderr)
        self.assertEqual(self.path.read_text(), self.text)

    def test_the_same_twice(self):
        with tempfile.TemporaryDirectory() as folder, contextlib.redirect_stdout(io.StringIO()):
            pages = [report.make([FILES / "short"], f"{folder}/{i}", False)[0].read_bytes() for i in range(2)]
        self.assertEqual(*pages)

    def test_names_that_are_alike_are_told_apart(self):
        paths = [pathlib.Path(p) for p in ("a/run/run.h5", "b/run/run.h5", "c/x y.h5")]
        self.assertEqual(report.names_of(paths), ["run", "run-2", "x-y"])


def unpacked(text, n_columns):
    """What viewer.js makes of a packed text: (n, columns)."""
    planes = np.frombuffer(zlib.decompress(base64.b64decode(text)), np.uint8).reshape(4, -1)
    return planes.T.copy().view("<i4").reshape(n_columns, -1).cumsum(axis=1).T


class View(unittest.TestCase):
    def test_what_it_draws_is_the_surface_to_an_8191st_of_its_box(self):
        run = package.open(FILES / "bar")
        view = surface_view.encoded(run, 10**8)
        for frame, index in zip(view["frames"], range(21)):
            (body,), surface = frame["bodies"], run.bodies["bar"].surface(index)
            topology = view["topologies"][body["topology"]]
            np.testing.assert_array_equal(unpacked(topology["triangles"], 3), surface.triangles)
            np.testing.assert_array_equal(unpacked(topology["labels"], 1)[:, 0], surface.labels)
            points = body["low"] + body["step"] * unpacked(body["points"], 3)
            box = np.ptp(surface.points, axis=0).max()
            np.testing.assert_allclose(points, surface.points, atol=0.51 * box / 8191)
            self.assertEqual(frame["time"], surface.time)

    def test_a_large_surface_is_shown_in_fewer_frames(self):
        run = package.open(FILES / "bar")
        whole = surface_view.encoded(run, 10**8)
        self.assertEqual(len(whole["frames"]), 21)
        less = surface_view.encoded(run, surface_view.size(whole) // 3)
        self.assertLess(len(less["frames"]), 15)
        self.assertEqual(less["frames"][-1]["time"], whole["frames"][-1]["time"])
        self.assertIsNone(surface_view.encoded(run, 10))

    def test_what_is_written_into_a_page_cannot_end_it(self):
        self.assertNotIn("</script", page.data_element("a", '"</script><b>"')[:-9])
        self.assertEqual(re.findall("<b", page.table("a", [("<b>", "")], [["<b>"]])), [])


if __name__ == "__main__":
    unittest.main()

"""What kerf.open gives, against the HDF5 itself and against known answers."""

import io
import re
import shutil
import struct
import tempfile
import unittest

from support import FILES
import h5py
import numpy as np

import kerf
from kerf import files, inspect_file, runs, studies


class Runs(unittest.TestCase):
    def setUp(self):
        self.run_ = kerf.open(FILES / "bar")

    def test_series_are_those_of_the_file_with_time_and_unit(self):
        with h5py.File(FILES / "bar/run.h5") as file:
            self.assertEqual(set(self.run_.series), set(file["observables"]))
            for name, series in self.run_.series.items():
                np.testing.assert_array_equal(series.values, file["observables"][name][()])
                np.testing.assert_array_equal(series.time, file["time"][()])
                self.assertEqual(series.unit.encode(), file["observables"][name].attrs["unit"])
        self.assertEqual(self.run_.series["bar elastic energy"].unit, "J")

    def test_surfaces_are_closed_and_hold_the_bodys_volume(self):
        for index in (0, -1):
            surface = self.run_.bodies["bar"].surface(index)
            a, b, c = (surface.rest[surface.triangles[:, i]] for i in range(3))
            volume = np.einsum("ij,ij->", a, np.cross(b, c)) / 6
            self.assertAlmostEqual(volume, 0.04, delta=0.0001)  # of the mesh: 1 x 0.2 x 0.2 m
            edges = np.sort(surface.triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
            _, count = np.unique(edges, axis=0, return_counts=True)
            self.assertTrue((count % 2 == 0).all())

    def test_the_surface_moves_with_the_corners(self):
        body = self.run_.bodies["bar"]
        tip = body.surface(-1).points[:, 2].min()
        largest = self.run_.series["bar largest displacement"].values[-1]
        self.assertLess(tip, 0)
        self.assertGreater(tip, -1.1 * largest)
        start = body.surface(0)
        np.testing.assert_allclose(start.points, start.rest, atol=1e-12)

    def test_cells_are_cubes_at_rest_in_vtks_order(self):
        volume = self.run_.bodies["bar"].volume(-1)
        corners = volume.rest[volume.cells]
        edges = corners[:, [1, 2, 3, 0, 4]] - corners[:, [0, 1, 2, 3, 0]]
        wanted = 0.07 * np.array([[1, 0, 0], [0, 1, 0], [-1, 0, 0], [0, -1, 0], [0, 0, 1]])
        np.testing.assert_allclose(edges, np.broadcast_to(wanted, edges.shape), atol=1e-12)

    def test_fields_have_a_value_a_corner_and_a_unit(self):
        volume = self.run_.bodies["bar"].volume(-1)
        self.assertEqual(volume.fields["von_mises_stress"].unit, "Pa")
        moved = volume.fields["displacement"].values
        np.testing.assert_allclose(moved, volume.points - volume.rest, atol=1e-12)

    def test_a_frame_that_is_not_there_is_told(self):
        with self.assertRaisesRegex(kerf.Complaint, "has 21 frames, none of number 21"):
            self.run_.bodies["bar"].surface(21)

    def test_rows_of_w_may_be_empty(self):
        found = runs.interpolated(np.array([0, 2, 2, 3]), np.array([0, 1, 1]), np.array([0.5, 0.5, 2]), np.eye(3)[:2])
        np.testing.assert_array_equal(found, [[0.5, 0.5, 0], [0, 0, 0], [0, 2, 0]])


class Studies(unittest.TestCase):
    def test_columns_are_those_of_the_file(self):
        study = kerf.open(FILES / "quick")
        with h5py.File(FILES / "quick/study.h5") as file:
            self.assertEqual(study.n_rows, len(file["study/rows/error"]))
            np.testing.assert_array_equal(study.columns["error"].values, file["study/rows/error"][()])
            self.assertEqual([n.encode() for n in study.columns["name"].values], list(file["study/rows/name"][()]))
        self.assertEqual(study.columns["h"].unit, "m")

    def test_the_quick_study_ends_with_errors_as_known_and_its_refused_rows(self):
        study = kerf.open(FILES / "quick")
        error = dict(zip(study.columns["name"].values, study.columns["error"].values))
        for name, wanted in {
            "fem, 5": -0.0018,
            "pba, 5": -0.127,
            "lattice, 5": -0.118,
            "mass-spring, 5": -0.153,
        }.items():
            self.assertAlmostEqual(error[name], wanted, delta=0.03 if wanted < -0.01 else 0.001)
        self.assertEqual([study.columns["family"].values[i] for i in studies.failed(study)], ["fem-explicit"] * 3)

    def test_fitted_orders_agree_with_the_programs_own(self):
        study = kerf.open(FILES / "quick")
        fitted = studies.orders(study)["pba"][0]
        own = [study.row(i)["order"] for i in studies.methods(study)["pba"]][1:]
        self.assertTrue(min(own) <= fitted <= max(own), f"{fitted} of {own}")

    def test_the_order_of_a_power_is_its_exponent(self):
        h = np.array([0.1, 0.05, 0.02, 0.01])
        order, factor = studies.fitted_order(h, 3 * h**1.5)
        self.assertAlmostEqual(order, 1.5, places=10)
        self.assertAlmostEqual(factor, 3, places=10)
        self.assertIsNone(studies.fitted_order(h[:1], h[:1]))
        self.assertIsNone(studies.fitted_order(h, np.full(4, np.nan)))

    def test_the_front_is_what_nobody_beats(self):
        random = np.random.default_rng(7)
        for n in (1, 2, 30):
            times, errors = random.integers(1, 9, (2, n)) / 8.0
            dominates = lambda i, j: (
                times[i] <= times[j] and errors[i] <= errors[j] and (times[i] < times[j] or errors[i] < errors[j])
            )
            best = {j for j in range(n) if not any(dominates(i, j) for i in range(n))}
            values = {(times[j], errors[j]) for j in best}
            found = studies.front(times, errors)
            self.assertEqual({(times[j], errors[j]) for j in found}, values)
            self.assertLessEqual(set(found), best)

    def test_a_study_of_stability(self):
        study = kerf.open(FILES / "block")
        self.assertEqual(study.n_rows, 8)
        self.assertIn("refused", study.columns["outcome"].values)


class Benches(unittest.TestCase):
    def test_inspect_tells_paths_sizes_and_rates(self):
        lines = "\n".join(inspect_file.described(FILES / "bench"))
        self.assertIn("a benchmark", lines)
        with h5py.File(FILES / "bench/bench.h5") as file:
            rate = file["bench/rows/rate"][0]
        self.assertRegex(lines, "energy, elements +216 cells +216 elements .* " + re.escape(f"{rate:.3g} /s"))


def with_journal(content):
    """A file as a kill leaves it between the commit and the copy of its first page."""
    page, size = content[:4096].ljust(4096, b"\0"), len(content)
    head = struct.pack("<4Q", files.MAGIC, size, size, 1)
    journal = page + struct.pack("<Q", 0)
    words = np.frombuffer(head + journal, "<u8").tolist()
    return bytes(4096) + content[4096:] + journal + head + struct.pack("<Q", files.checksum(words))


class Kills(unittest.TestCase):
    def test_a_commit_that_was_cut_short_is_finished_in_memory(self):
        content = (FILES / "short/run.h5").read_bytes()
        with tempfile.TemporaryDirectory() as folder:
            path = folder + "/run.h5"
            with open(path, "wb") as out:
                out.write(with_journal(content))
            run, whole = kerf.open(path), kerf.open(FILES / "short")
            for name, series in whole.series.items():
                np.testing.assert_array_equal(run.series[name].values, series.values)
            with open(path, "rb") as raw:
                self.assertEqual(files.repaired(raw, *files.find_journal(raw)), content)

    def test_a_journal_that_is_not_whole_is_none(self):
        torn = bytearray(with_journal((FILES / "short/run.h5").read_bytes()))
        torn[-2000] ^= 1
        self.assertIsNone(files.find_journal(io.BytesIO(torn)))

    def test_a_run_that_is_under_way_can_be_read(self):
        with tempfile.TemporaryDirectory() as folder:
            shutil.copy(FILES / "short/run.h5", folder)
            with h5py.File(folder + "/run.h5", "r+") as file:
                file.attrs["outcome"] = np.bytes_("running")
            self.assertEqual(kerf.open(folder).outcome, "running")


if __name__ == "__main__":
    unittest.main()

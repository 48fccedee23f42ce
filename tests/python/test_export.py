"""kerf export --volume: the VTKHDF file against the run, by the rules of the format."""

import pathlib
import tempfile
import unittest

from support import FILES, kerf
import h5py
import numpy as np

import kerf as package


def step_of(vtk, index):
    """Points, connectivity, offsets, types and data of a step, found as a reader of the format finds them."""
    steps = vtk["Steps"]
    part = steps["PartOffsets"][index]
    n_points, n_cells, n_ids = (vtk[f"NumberOf{w}"][part] for w in ("Points", "Cells", "ConnectivityIds"))
    at_cell, at_id = steps["CellOffsets"][index, 0], steps["ConnectivityIdOffsets"][index, 0]
    at_offset = at_cell + part  # a part has one offset more than cells

    def rows(path, begin, n):
        return vtk[path][begin : begin + n]

    data = {
        name: rows(f"PointData/{name}", steps[f"PointDataOffsets/{name}"][index], n_points) for name in vtk["PointData"]
    }
    return {
        "points": rows("Points", steps["PointOffsets"][index], n_points),
        "cells": rows("Connectivity", at_id, n_ids).reshape(-1, 8),
        "offsets": rows("Offsets", at_offset, n_cells + 1),
        "types": rows("Types", at_cell, n_cells),
        "nodes": rows("CellData/material_nodes", steps["CellDataOffsets/material_nodes"][index], n_cells),
        **data,
    }


class Volume(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.target = pathlib.Path(self.folder.name) / "bar.vtkhdf"
        self.addCleanup(self.folder.cleanup)

    def export(self, name, *more):
        return kerf("export", "--volume", FILES / name, "--output", self.target, *more)

    def test_every_frame_is_in_the_file_as_the_format_says(self):
        self.assertEqual(self.export("bar").returncode, 0)
        body = package.open(FILES / "bar").bodies["bar"]
        with h5py.File(self.target) as file:
            vtk = file["VTKHDF"]
            self.assertEqual((vtk.attrs["Type"], list(vtk.attrs["Version"])), (b"UnstructuredGrid", [2, 0]))
            self.assertEqual(vtk["Steps"].attrs["NSteps"], len(body))
            np.testing.assert_array_equal(vtk["Steps/Values"], body.times())
            self.assertLess(len(vtk["NumberOfCells"]), len(body))  # a topology is written once
            for index in range(len(body)):
                found, wanted = step_of(vtk, index), body.volume(index)
                np.testing.assert_array_equal(found["cells"], wanted.cells)
                np.testing.assert_array_equal(found["offsets"], 8 * np.arange(len(wanted.cells) + 1))
                self.assertEqual(set(found["types"]), {12})
                np.testing.assert_array_equal(found["nodes"], wanted.nodes)
                np.testing.assert_array_equal(found["points"], wanted.points.astype(np.float32))
                stress = wanted.fields["von_mises_stress"].values.astype(np.float32)
                np.testing.assert_array_equal(found["von_mises_stress"], stress)

    def test_bodies_that_are_not_there_are_refused(self):
        done = self.export("bar", "--body", "liver")
        self.assertEqual((done.returncode, self.target.exists()), (1, False))
        self.assertIn("Name one with --body: bar", done.stderr)

    def test_a_file_is_not_replaced_unasked(self):
        self.target.write_text("mine")
        self.assertEqual(self.export("short").returncode, 1)
        self.assertEqual(self.target.read_text(), "mine")
        self.assertEqual(self.export("short", "--force").returncode, 0)


if __name__ == "__main__":
    unittest.main()

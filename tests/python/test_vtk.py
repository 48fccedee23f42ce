"""The file of kerf export --volume as VTK itself reads it (9.3 or later: earlier ones know no steps of cells)."""

import pathlib
import tempfile
import unittest

from support import FILES, kerf, skip
import numpy as np

try:
    from vtkmodules.util.numpy_support import vtk_to_numpy
    from vtkmodules.vtkCommonCore import vtkVersion
    from vtkmodules.vtkIOHDF import vtkHDFReader
except ImportError as error:
    skip(f"VTK is not installed ({error.name})")
if (vtkVersion.GetVTKMajorVersion(), vtkVersion.GetVTKMinorVersion()) < (9, 3):
    skip(f"VTK {vtkVersion.GetVTKVersion()} reads no steps of cells: 9.3 does")

import kerf as package


class Vtk(unittest.TestCase):
    def test_reads_every_step(self):
        body = package.open(FILES / "bar").bodies["bar"]
        with tempfile.TemporaryDirectory() as folder:
            target = pathlib.Path(folder) / "bar.vtkhdf"
            self.assertEqual(kerf("export", "--volume", FILES / "bar", "--output", target).returncode, 0)
            reader = vtkHDFReader()
            reader.SetFileName(str(target))
            reader.UpdateInformation()
            self.assertEqual(reader.GetNumberOfSteps(), len(body))
            for index in range(len(body)):
                reader.SetStep(index)
                reader.Update()
                grid, wanted = reader.GetOutputDataObject(0), body.volume(index)
                cells = vtk_to_numpy(grid.GetCells().GetConnectivityArray()).reshape(-1, 8)
                np.testing.assert_array_equal(cells, wanted.cells)
                points = vtk_to_numpy(grid.GetPoints().GetData())
                np.testing.assert_array_equal(points, wanted.points.astype(np.float32))
                stress = vtk_to_numpy(grid.GetPointData().GetArray("von_mises_stress"))
                np.testing.assert_array_equal(stress, wanted.fields["von_mises_stress"].values.astype(np.float32))


if __name__ == "__main__":
    unittest.main()

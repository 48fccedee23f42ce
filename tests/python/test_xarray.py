"""Series as xarray.DataArray, where xarray is."""

import unittest

from support import FILES, skip
import numpy as np

try:
    import xarray
except ImportError:
    skip("xarray is not installed (python3-xarray)")

import kerf


class Xarray(unittest.TestCase):
    def test_has_time_as_coordinate_and_units(self):
        series = kerf.open(FILES / "bar").series["bar elastic energy"]
        array = series.to_xarray()
        self.assertIsInstance(array, xarray.DataArray)
        self.assertEqual((array.dims, array.attrs["units"], array.time.attrs["units"]), (("time",), "J", "s"))
        at = float(array.sel(time=1.0, method="nearest"))
        self.assertEqual(at, series.values[np.argmin(np.abs(series.time - 1))])


if __name__ == "__main__":
    unittest.main()

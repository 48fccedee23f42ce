"""The report in a headless browser without a network: its scripts run, the surfaces are drawn, it prints."""

import pathlib
import re
import shutil
import subprocess
import tempfile
import unittest
import zlib

from support import FILES, kerf, skip

BROWSER = next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), None)
if BROWSER is None:
    skip("there is no chromium here")
if not pathlib.Path("/usr/share/javascript/three/three.min.js").exists():
    skip("three.js is not installed (libjs-three)")

import kerf as package
import numpy as np
from PIL import Image


class Browser(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.at = pathlib.Path(cls.folder.name)
        done = kerf("report", FILES / "bar", FILES / "quick", "--output", cls.at)
        assert done.returncode == 0, done.stderr

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    def browse(self, *options):
        """What the browser prints; without a network, with WebGL in software."""
        fixed = "--headless --no-sandbox --hide-scrollbars --use-angle=swiftshader --enable-unsafe-swiftshader".split()
        words = [BROWSER, *fixed, "--host-resolver-rules=MAP * ~NOTFOUND", f"--user-data-dir={self.at}/profile"]
        words += ["--virtual-time-budget=30000", *options, f"file://{self.at}/report.html"]
        return subprocess.run(words, capture_output=True, text=True, timeout=300, check=True).stdout

    def test_scripts_run_without_errors_and_draw_all_triangles(self):
        page = self.browse("--dump-dom")
        self.assertNotIn("data-errors", page)
        self.assertIn('data-viewers="1"', page)
        n = len(package.open(FILES / "bar").bodies["bar"].surface(-1).triangles)
        self.assertIn(f'data-triangles="{n}"', page)
        self.assertIn("<output>2.000 s</output>", page)

    def test_the_surface_is_seen(self):
        self.browse("--window-size=1200,4000", f"--screenshot={self.at}/page.png")
        with Image.open(self.at / "page.png") as image:
            pixels = np.asarray(image.convert("RGB")).astype(int)
        skin = (np.abs(pixels - pixels[:, :, :1]).max(axis=2) > 12) & (pixels.max(axis=2) > 90)
        in_a_row = skin.sum(axis=1)
        self.assertGreater((in_a_row > 250).sum(), 60)  # rows of the picture that a bar fills far across

    def test_it_prints(self):
        self.browse("--no-pdf-header-footer", f"--print-to-pdf={self.at}/page.pdf")
        content = (self.at / "page.pdf").read_bytes()
        self.assertEqual(content[:5], b"%PDF-")
        self.assertGreater(content.count(b"/Type /Page"), 4)
        # Points a pixel of the page: 3/4, and less where a table is too wide and the browser makes all smaller.
        self.assertAlmostEqual(scale_of_print(content), 0.75, delta=0.03)


def scale_of_print(pdf):
    """The product of the scales that a page of text begins with."""
    for stream in re.finditer(rb"stream\r?\n(.*?)endstream", pdf, re.S):
        try:
            text = zlib.decompress(stream.group(1).strip(b"\r\n"))
        except zlib.error:
            continue
        scales = re.findall(rb"([\d.]+) 0 0 -?[\d.]+ [\d.]+ [\d.]+ cm", text)
        if b" Tf" in text and len(scales) >= 2:
            return float(scales[0]) * float(scales[1])
    raise AssertionError("no page of text")


if __name__ == "__main__":
    unittest.main()

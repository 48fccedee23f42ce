"""The examples of results/README.md, as they stand there, on a run and a study of the tests."""

import os
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

from support import FILES, SOURCES

EXAMPLES = re.findall(r"^```python\n(.*?)^```$", (SOURCES / "results/README.md").read_text(), re.S | re.M)


class Examples(unittest.TestCase):
    def test_there_are_some_and_they_are_short(self):
        self.assertGreaterEqual(len(EXAMPLES), 3)
        for example in EXAMPLES:
            self.assertLessEqual(len(example.splitlines()), 10, example)

    def test_each_runs(self):
        for example in EXAMPLES:
            with self.subTest(example), tempfile.TemporaryDirectory() as folder:
                results = pathlib.Path(folder) / "results"
                results.mkdir()
                (results / "first").symlink_to(FILES / "bar")
                (results / "quick").symlink_to(FILES / "quick")
                environment = {**os.environ, "PYTHONPATH": str(SOURCES / "python"), "MPLBACKEND": "Agg"}
                words = [sys.executable, "-c", example]
                done = subprocess.run(words, capture_output=True, text=True, cwd=folder, env=environment, check=False)
                self.assertEqual(done.returncode, 0, done.stderr)
                made = [p for p in pathlib.Path(folder).iterdir() if p.is_file()]
                self.assertTrue(done.stdout or made, "an example that says and makes nothing")


if __name__ == "__main__":
    unittest.main()

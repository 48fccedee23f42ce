"""The commands from where `cmake --install` puts them, and from the launcher of the checkout."""

import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

from support import FILES, SOURCES

BUILD = pathlib.Path(os.environ["KERF_BUILD_FOLDER"])


def run(words, folder):
    environment = {"PATH": os.environ["PATH"], "HOME": folder, "KERF_PYTHON": sys.executable}
    return subprocess.run(
        list(map(str, words)), capture_output=True, text=True, cwd=folder, env=environment, check=False
    )


class Installed(unittest.TestCase):
    def test_reports_inspects_and_exports(self):
        with tempfile.TemporaryDirectory() as folder:
            done = run(["cmake", "--install", BUILD, "--prefix", f"{folder}/place"], folder)
            self.assertEqual(done.returncode, 0, done.stderr)
            program = pathlib.Path(folder) / "place/bin/kerf"
            package = pathlib.Path(folder) / "place/share/kerf/python"
            self.assertEqual(
                sorted(p.name for p in (SOURCES / "python/kerf").iterdir() if p.is_file()),
                sorted(p.name for p in (package / "kerf").iterdir()),
            )
            done = run([program, "report", FILES / "quick"], folder)
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertTrue((pathlib.Path(folder) / "results/report/report.html").is_file())
            self.assertIn("a study", run([program, "inspect", FILES / "quick"], folder).stdout)
            target = f"{folder}/bar.vtkhdf"
            self.assertEqual(
                run([program, "export", "--volume", FILES / "bar", "--output", target], folder).returncode, 0
            )
            self.assertEqual(list(package.glob("**/__pycache__")), [])
            environment = {"KERF_PYTHON": "/no/python"}
            done = subprocess.run(
                [program, "inspect", "a"], capture_output=True, text=True, env=environment, check=False
            )
            self.assertEqual(done.returncode, 2)
            self.assertIn("/no/python: cannot be run", done.stderr)

    def test_the_launcher_needs_no_build(self):
        with tempfile.TemporaryDirectory() as folder:
            done = run([SOURCES / "kerf", "inspect", FILES / "bar"], folder)
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertIn("a run: series over time and frames", done.stdout)
            self.assertEqual(done.stderr, "")

    def test_a_build_folder_that_was_moved_is_configured_anew(self):
        with tempfile.TemporaryDirectory() as folder:
            tools, build = pathlib.Path(folder) / "tools", pathlib.Path(folder) / "build"
            tools.mkdir()
            build.mkdir()
            # All packages are there, and cmake says what it is asked for.
            write_tool(tools / "dpkg-query", "shift 2; printf 'installed %s\\n' \"$@\"")
            write_tool(tools / "cmake", f"echo \"$@\" >>'{folder}/asked'")
            environment = {"PATH": f"{tools}:{os.environ['PATH']}", "HOME": folder, "KERF_BUILD": str(build)}
            for place, is_anew in ((build, False), (pathlib.Path(folder) / "old", True)):
                (pathlib.Path(folder) / "old").mkdir(exist_ok=True)
                (build / "CMakeCache.txt").write_text(
                    f"CMAKE_CACHEFILE_DIR:INTERNAL={place}\nCMAKE_HOME_DIRECTORY:INTERNAL={SOURCES.resolve()}\n"
                )
                (build / "build.ninja").touch()
                (build / ".configured").touch()
                done = subprocess.run(
                    [SOURCES / "kerf", "build"], capture_output=True, text=True, env=environment, check=False
                )
                self.assertEqual(done.returncode, 0, done.stderr)
                asked = (pathlib.Path(folder) / "asked").read_text()
                self.assertEqual("--fresh" in asked, is_anew, asked)
                self.assertEqual(f"as {place}: it is made anew" in done.stderr, is_anew, done.stderr)


def write_tool(path, line):
    path.write_text(f"#!/bin/sh\n{line}\n")
    path.chmod(0o755)


if __name__ == "__main__":
    unittest.main()

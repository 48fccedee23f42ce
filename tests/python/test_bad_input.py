"""What cannot be read is refused in one line that names the file and a remedy, with the program's exit codes."""

import contextlib
import io
import os
import pathlib
import shutil
import signal
import subprocess
import sys
import tempfile
import unittest
import unittest.mock
from typing import NamedTuple

from support import FILES, PROGRAM, SOURCES
import h5py
import numpy as np

from kerf import commands


class Done(NamedTuple):
    returncode: int
    stdout: str
    stderr: str


def kerf(*arguments, folder=".", run=commands.run):
    """Runs a command in this process, in a folder; test_installed runs them by the program."""
    before, out, err = os.getcwd(), io.StringIO(), io.StringIO()
    os.chdir(folder)
    try:
        with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
            code = run(list(map(str, arguments)))
    finally:
        os.chdir(before)
    return Done(code, out.getvalue(), err.getvalue())


class Refused(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def refused(self, code, text, *arguments):
        done = kerf(*arguments, folder=self.folder)
        self.assertEqual(done.returncode, code, done.stderr)
        first = done.stderr.splitlines()[0]
        self.assertTrue(first.startswith("kerf: "), done.stderr)
        self.assertIn(text, first)
        self.assertNotIn("Traceback", done.stderr)
        return first

    def all_readers(self, text, path):
        """Refused by each of the commands, with the file's name."""
        for words in (["report"], ["inspect"], ["export", "--volume"]):
            self.assertIn(path.name, self.refused(2, text, *words, path))
        self.assertEqual(list((self.folder / "results").glob("**/*.html")), [])

    def copy(self, name="short/run.h5"):
        return pathlib.Path(shutil.copy(FILES / name, self.folder))

    def test_no_file(self):
        self.all_readers("there is no such file", self.folder / "none.h5")

    def test_a_folder_without_results(self):
        self.all_readers("the folder holds none of run.h5, study.h5, stability.h5", self.folder)

    def test_an_empty_file(self):
        (self.folder / "a.h5").touch()
        self.all_readers("is empty", self.folder / "a.h5")

    def test_no_hdf5(self):
        (self.folder / "a.h5").write_text("a letter")
        self.all_readers("is not an HDF5 file", self.folder / "a.h5")

    def test_hdf5_of_somebody_else(self):
        with h5py.File(self.folder / "a.h5", "w") as file:
            file["data"] = [1, 2]
        self.all_readers("is HDF5, but no file of Kerf's", self.folder / "a.h5")

    def test_a_file_that_is_cut_off(self):
        path = self.copy()
        content = path.read_bytes()
        path.write_bytes(content[: len(content) // 2])
        self.all_readers("is cut off", path)

    def test_a_run_that_lacks_a_part(self):
        path = self.copy()
        with h5py.File(path, "r+") as file:
            del file["step"]
        self.all_readers("is damaged, or not whole", path)

    def test_a_study_whose_columns_do_not_fit(self):
        path = self.copy("quick/study.h5")
        with h5py.File(path, "r+") as file:
            attributes = dict(file["study/rows/h"].attrs)
            del file["study/rows/h"]
            file["study/rows/h"] = np.zeros(3)
            file["study/rows/h"].attrs.update(attributes)
        for words in (["report"], ["inspect"]):
            self.refused(2, "columns are not equally long", *words, path)

    def test_bytes_that_are_broken_end_in_one_line_or_are_not_noticed(self):
        whole = (FILES / "short/run.h5").read_bytes()
        random = np.random.default_rng(3)
        path = self.folder / "run.h5"
        for _ in range(6):
            content = bytearray(whole)
            for at in random.integers(0, len(whole), 200):
                content[at] ^= 1 << random.integers(8)
            path.write_bytes(content)
            done = kerf("inspect", path, run=commands.run_guarded)
            self.assertIn(done.returncode, (0, 2), done.stderr)

    def test_a_dataset_larger_than_any_memory(self):
        path = self.copy()
        with h5py.File(path, "r+") as file:
            attributes = dict(file["observables/bar pieces"].attrs)
            del file["observables/bar pieces"]
            file.create_dataset("observables/bar pieces", shape=(2**54,), dtype="f8", chunks=(2**20,))
            file["observables/bar pieces"].attrs.update(attributes)
        self.all_readers("is damaged, or not whole", path)

    def test_a_crash_of_the_library_is_told(self):
        def crash(path):
            os.kill(os.getpid(), signal.SIGSEGV)

        with unittest.mock.patch("kerf.inspect_file.described", crash):
            done = kerf("inspect", "run.h5", run=commands.run_guarded)
        self.assertEqual(done.returncode, 2)
        self.assertIn("run.h5: a file is damaged: reading it crashed (SIGSEGV)", done.stderr)

    def test_files_of_another_kind(self):
        self.refused(
            2, "is the Splitting Cubes table; reports are about runs and studies", "report", FILES / "table.h5"
        )
        self.refused(2, "is a study", "export", "--volume", FILES / "quick")

    def test_a_run_without_frames_is_reported_with_a_note(self):
        path = self.copy()
        with h5py.File(path, "r+") as file:
            del file["bodies/bar"]
        self.refused(2, "has no frames", "export", "--volume", path)
        done = kerf("report", path, "--output", self.folder / "report")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("The run has no frames", (self.folder / "report/report.html").read_text())

    def test_a_run_that_failed_is_reported_with_its_reason(self):
        path = self.copy()
        with h5py.File(path, "r+") as file:
            file.attrs["outcome"] = np.bytes_("failed")
            file["failure"] = np.bytes_("the body is gone")
            file["failure"].attrs.update(step=7, time=0.07)
        done = kerf("report", path, "--output", self.folder / "report")
        self.assertEqual(done.returncode, 0, done.stderr)
        text = (self.folder / "report/report.html").read_text()
        self.assertIn("ended early, &#x27;failed&#x27;: the body is gone (step 7, 0.07 s)", text)

    def test_a_study_without_rows(self):
        path = self.copy("quick/study.h5")
        with h5py.File(path, "r+") as file:
            for name in list(file["study/rows"]):
                attributes = dict(file[f"study/rows/{name}"].attrs)
                empty = file[f"study/rows/{name}"][:0]
                del file[f"study/rows/{name}"]
                file[f"study/rows/{name}"] = empty
                file[f"study/rows/{name}"].attrs.update(attributes)
        self.refused(2, "has no rows yet", "report", path)

    def test_commands_that_make_no_sense(self):
        self.refused(1, "are required: files", "report")
        self.refused(1, "say what to export", "export")
        self.refused(1, "unrecognized arguments: --colour", "inspect", "--colour", FILES / "bar")
        self.assertEqual(kerf("report", "--help").returncode, 0)

    def test_a_folder_that_cannot_be_written(self):
        (self.folder / "taken").touch()
        self.refused(2, "cannot be written", "report", FILES / "short", "--output", self.folder / "taken")
        self.refused(
            2, "cannot be written", "export", "--volume", FILES / "short", "--output", self.folder / "no/a.vtkhdf"
        )


class Checkpoints(unittest.TestCase):
    def test_what_is_in_them_and_that_they_are_whole(self):
        with tempfile.TemporaryDirectory() as folder:
            words = [
                "--set",
                "Output/Checkpoint every [1]=3",
                "--set",
                "Body bar/Cube edge [m]=0.1",
                "--output",
                folder,
            ]
            with subprocess.Popen(
                [PROGRAM, "run", SOURCES / "params/bar.prm", *words], stdout=subprocess.DEVNULL
            ) as run:
                path = pathlib.Path(folder) / "checkpoint.kerf"
                while not path.exists() and run.poll() is None:
                    pass
                run.kill()
            done = kerf("inspect", path)
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertRegex(done.stdout, "a checkpoint, from which a run goes on(.|\n)*of step [0-9]+")
            self.assertIn("its checksum is right", done.stdout)
            content = bytearray(path.read_bytes())
            content[-100] ^= 1
            path.write_bytes(content)
            self.assertIn("its checksum is wrong", kerf("inspect", path).stdout)
            path.write_bytes(content[:-9])
            self.assertEqual(kerf("inspect", path).returncode, 2)


class Missing(unittest.TestCase):
    def test_a_package_that_is_not_there_is_named(self):
        words = [
            sys.executable,
            "-S",
            SOURCES / "python/main.py",
            "inspect",
            FILES / "bar",
        ]  # -S: no installed packages
        done = subprocess.run(words, capture_output=True, text=True, env={}, check=False)
        self.assertEqual(done.returncode, 2)
        self.assertRegex(done.stderr, "kerf: (h5py|numpy) is missing for .*Install python3-(h5py|numpy)")


if __name__ == "__main__":
    unittest.main()

"""Finds, opens and recognises the HDF5 files that Kerf writes."""

import contextlib
import io
import pathlib
import struct

import h5py
import numpy as np

NAMES = ("run.h5", "study.h5", "stability.h5", "bench.h5")  # what a folder of results holds
KINDS = {
    "run": "a run: series over time and frames",
    "study": "a study: errors and times of many runs",
    "stability": "a study of stability: what became of many runs",
    "bench": "a benchmark: how fast hot paths are",
    "surface": "a moving surface, for ParaView",
    "volume": "cells with fields over time, for ParaView",
    "table": "the Splitting Cubes table",
    "arrays": "arrays, each with unit and description",
}
REMEDY = "Give a run's or study's folder, or an HDF5 file that Kerf wrote"


class Complaint(Exception):
    """Something is wrong with what the user gave; the exit code is 1 for a command, 2 for a file, as of the program."""

    def __init__(self, text, exit_code=2):
        super().__init__(text)
        self.exit_code = exit_code


def complaint(path, rule, remedy=REMEDY):
    """The complaint about a file: what is wrong, and what helps."""
    return Complaint(f"{path}: {rule}. {remedy}.")


def find(path):
    """The file that a path means: itself, or what the folder of a run or study holds."""
    path = pathlib.Path(path)
    if path.is_dir():
        found = [path / name for name in NAMES if (path / name).is_file()]
        if not found:
            raise complaint(path, "the folder holds none of " + ", ".join(NAMES))
        return found[0]
    if not path.exists():
        raise complaint(path, "there is no such file")
    return path


@contextlib.contextmanager
def told(path):
    """Turns what is thrown while the file is read into a complaint: broken bytes can make h5py and NumPy throw anything."""
    try:
        yield
    except (Complaint, ImportError, BrokenPipeError):
        raise
    except Exception as error:
        reason = " ".join(str(error).split())
        raise complaint(path, f"is damaged, or not whole ({reason})", "Make it again, or give another") from error


def write(path, content):
    """Writes bytes into a file, and makes its folder."""
    path = pathlib.Path(path)
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(content)
    except OSError as error:
        raise complaint(path, f"cannot be written ({error.strerror})", "Choose another folder with --output") from error


def open_h5(path):
    """Opens a file for reading, with the last step of a writer that was killed in the middle of it."""
    path = find(path)
    try:
        with open(path, "rb") as raw:
            start = raw.read(8)
            journal = find_journal(raw)
            if journal:
                return h5py.File(io.BytesIO(repaired(raw, *journal)), "r")
        if start != b"\x89HDF\r\n\x1a\n":
            raise complaint(path, "is empty" if not start else "is not an HDF5 file")
        return h5py.File(path, "r")
    except OSError as error:
        reason = " ".join(str(error).split())
        if "truncated" in reason:
            raise complaint(path, "is cut off: its end is missing", "Copy it again, or run again") from error
        raise complaint(path, f"cannot be read ({reason})", "Copy it again, or check that you may read it") from error


# What a writer that was killed leaves behind (src/output/journaled_file.cc): pages, their numbers, and at the end of
# the file five words: magic, size of the file after the commit, where the pages begin, their number, a checksum.
MAGIC, PAGE, WORD = 0x6B6572666A726E6C, 4096, 8


def checksum(words):
    """That of src/output/checksum.h, over 64-bit words."""
    total = 0xCBF29CE484222325
    for word in words:
        total = ((total ^ int(word)) * 0x100000001B3) & 0xFFFFFFFFFFFFFFFF
        total ^= total >> 29
    return total


def find_journal(raw):
    """(size, numbers, pages) of a whole commit that was not copied into place; None without one."""
    end = raw.seek(0, io.SEEK_END)
    if end < 5 * WORD:
        return None
    raw.seek(end - 5 * WORD)
    magic, size, begin, n_pages, stored = struct.unpack("<5Q", raw.read(5 * WORD))
    n_bytes = n_pages * (PAGE + WORD)
    if magic != MAGIC or n_pages == 0 or begin + n_bytes + 5 * WORD > end:
        return None
    raw.seek(begin)
    journal = raw.read(n_bytes)
    words = np.frombuffer(journal, "<u8")
    if checksum([magic, size, begin, n_pages, *words.tolist()]) != stored:
        return None
    return size, words[-n_pages:], journal[: n_pages * PAGE]


def repaired(raw, size, numbers, pages):
    """The bytes of the file as the writer would have left them."""
    raw.seek(0)
    content = bytearray(raw.read(size).ljust(size, b"\0"))
    for i, number in enumerate(numbers.tolist()):
        begin = number * PAGE
        n = max(0, min(PAGE, size - begin))
        content[begin : begin + n] = pages[i * PAGE : i * PAGE + n]
    return bytes(content)


def kind_of(file):
    """Which of KINDS an open file is; None for one that is not ours."""
    if "study/rows" in file:
        return "study"
    if "stability/rows" in file:
        return "stability"
    if "bench/rows" in file:
        return "bench"
    if "observables" in file and "time" in file:
        return "run"
    if "VTKHDF" in file:
        return "surface" if text(file["VTKHDF"].attrs.get("Type", b"")) == "PolyData" else "volume"
    if "cell_component" in file:
        return "table"
    return "arrays" if "title" in file.attrs and "source" in file.attrs else None


def text(value):
    """A text of HDF5 as a string."""
    return value.decode("utf-8", "replace") if isinstance(value, bytes) else str(value)


def column(dataset):
    """The values of a dataset: an array of numbers, or a list of strings."""
    values = dataset[()]
    return values if values.dtype.kind in "iuf" else [text(value) for value in values]


def provenance(file):
    """Where a file comes from: its root's attributes as strings, in a reader's order."""
    first = ["outcome", "version", "git_commit", "command_line", "started", "host", "compiler", "n_threads", "seed"]
    names = [name for name in first if name in file.attrs] + sorted(name for name in file.attrs if name not in first)
    return {name: text(file.attrs[name]) for name in names}

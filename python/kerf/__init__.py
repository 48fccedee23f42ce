"""Reads what Kerf writes: runs, studies, studies of stability.

    import kerf
    run = kerf.open("results/liver")
    energy = run.series["liver elastic energy"]  # .time [s], .values, .unit
    surface = run.bodies["liver"].surface(-1)  # .points (n, 3) [m], .triangles (m, 3)

Needs h5py and numpy (Debian: python3-h5py); reports need matplotlib (python3-matplotlib).
"""

from . import files, runs, studies
from .files import Complaint

__all__ = ["Complaint", "open"]


def open(path):
    """A Run (runs.py) or a Study (studies.py), by what the file or folder holds. Raises Complaint."""
    path = files.find(path)
    with files.open_h5(path) as file, files.told(path):
        kind = files.kind_of(file)
    if kind in ("study", "stability"):
        return studies.Study(path, kind)
    return runs.Run(path)

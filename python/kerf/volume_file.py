"""The cells of a body over time as one file that ParaView opens: VTKHDF 2.0, UnstructuredGrid with Steps.

Each step appends its points and fields; cells, rest positions and material nodes only where the topology changed.
Source: VTKHDF format specification, docs.vtk.org (vtk_file_formats/vtkhdf_file_format). As src/output/surface_file.h.
"""

import os
import pathlib

import h5py
import numpy as np

from . import files

HEXAHEDRON = 12  # VTK's number of the kind of cell


def append(group, path, rows):
    """Adds rows to a dataset that grows, and makes it where it is not there. Returns how many rows it had before."""
    rows = np.asarray(rows)
    if path not in group:
        group.create_dataset(path, data=rows, maxshape=(None, *rows.shape[1:]), chunks=True)
        return 0
    dataset = group[path]
    n = len(dataset)
    dataset.resize(n + len(rows), axis=0)
    dataset[n:] = rows
    return n


def append_topology(vtk, volume):
    """Cells and what belongs to them. Returns where the part and its rows begin."""
    n = len(volume.cells)
    part = append(vtk, "NumberOfPoints", np.array([len(volume.rest)], np.int64))
    append(vtk, "NumberOfCells", np.array([n], np.int64))
    append(vtk, "NumberOfConnectivityIds", np.array([8 * n], np.int64))
    append(vtk, "Offsets", 8 * np.arange(n + 1, dtype=np.int64))
    return {
        "PartOffsets": part,
        "ConnectivityIdOffsets": append(vtk, "Connectivity", volume.cells.astype(np.int64).ravel()),
        "CellOffsets": append(vtk, "Types", np.full(n, HEXAHEDRON, np.uint8)),
        "CellDataOffsets/material_nodes": append(vtk, "CellData/material_nodes", volume.nodes),
        "PointDataOffsets/rest_position": append(vtk, "PointData/rest_position", volume.rest.astype(np.float32)),
    }


def append_step(vtk, volume, topology):
    """Positions and fields of a frame, and where all its parts begin."""
    at = {"PointOffsets": append(vtk, "Points", volume.points.astype(np.float32)), "NumberOfParts": 1, **topology}
    for name, field in volume.fields.items():
        at[f"PointDataOffsets/{name}"] = append(vtk, f"PointData/{name}", field.values.astype(np.float32))
        vtk[f"PointData/{name}"].attrs["unit"] = field.unit
    append(vtk, "Steps/Values", np.array([volume.time], float))
    for path, value in at.items():
        shape = (1, 1) if path in ("CellOffsets", "ConnectivityIdOffsets") else (1,)
        append(vtk, f"Steps/{path}", np.full(shape, value, np.int64))


def frame(body, index):
    """A frame of the run. Raises Complaint about the run's file where that is damaged."""
    try:
        return body.volume(index)
    except (OSError, RuntimeError, KeyError, ValueError) as error:
        raise files.complaint(body.file_name, f"frame {index} of body {body.name} cannot be read ({error})") from error


def write(path, body):
    """All frames of a body, beside the name, which the file then takes. Raises Complaint where that cannot be."""
    if len(body) == 0:
        raise files.complaint(body.name, "has no frames", "Run the scene with 'Output/Frames every [1]' of fewer steps")
    beside = f"{path}.new"
    try:
        with h5py.File(beside, "w") as file:
            vtk = file.create_group("VTKHDF")
            vtk.attrs["Version"] = np.array([2, 0], np.int64)
            vtk.attrs.create("Type", np.bytes_("UnstructuredGrid"))
            last = None
            for index in range(len(body)):
                volume = frame(body, index)
                if volume.topology != last:
                    topology, last = append_topology(vtk, volume), volume.topology
                append_step(vtk, volume, topology)
            vtk["Steps"].attrs["NSteps"] = np.int64(len(body))
        os.replace(beside, path)
    except OSError as error:
        raise files.complaint(path, f"cannot be written ({error})", "Choose another place with --output") from error
    finally:
        pathlib.Path(beside).unlink(missing_ok=True)

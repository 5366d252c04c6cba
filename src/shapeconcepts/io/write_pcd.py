"""Writes scans as PCD files."""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np

from shapeconcepts.io.atomic_write import write_atomically
from shapeconcepts.scan import Scan, ScanError


def write_pcd(path: str | os.PathLike[str], scan: Scan) -> None:
    """Write a scan as a binary PCD 0.7 file with the fields x, y, z and, where it has point labels, label.

    The file appears complete or not at all. Coordinates are stored as float32, labels as uint32. The
    viewpoint goes into the header; the format cannot say that it is unknown, and the origin is written then.

    Parameters
    ----------
    path : path-like
        The file; its folder must exist.
    scan : Scan

    Raises
    ------
    ScanError
        If a point label does not fit into uint32.
    OSError
        If the file cannot be written.
    """
    path = Path(path)
    try:
        content = pcd_content(scan)
    except ScanError as error:
        raise ScanError(f"{path}: {error}") from None
    write_atomically(path, content)


def pcd_content(scan: Scan) -> bytes:
    """What `write_pcd` writes.

    Raises
    ------
    ScanError
        If a point label does not fit into uint32.
    """
    fields = [("x", "<f4"), ("y", "<f4"), ("z", "<f4")]
    if scan.point_labels is not None:
        if len(scan) and not 0 <= scan.point_labels.min() <= scan.point_labels.max() < 2**32:
            raise ScanError(
                "point labels must be 0 to 2**32 - 1 in a PCD file, "
                f"got {scan.point_labels.min()} to {scan.point_labels.max()}"
            )
        fields.append(("label", "<u4"))
    rows = np.empty(len(scan), dtype=fields)
    for column, field in enumerate("xyz"):
        rows[field] = scan.points[:, column]
    if scan.point_labels is not None:
        rows["label"] = scan.point_labels
    x, y, z = (0.0, 0.0, 0.0) if scan.viewpoint is None else scan.viewpoint
    header = (
        "# .PCD v0.7 - Point Cloud Data file format\n"
        "VERSION 0.7\n"
        f"FIELDS {' '.join(name for name, _ in fields)}\n"
        f"SIZE {' '.join('4' for _ in fields)}\n"
        f"TYPE {' '.join(kind[1].upper() for _, kind in fields)}\n"
        f"COUNT {' '.join('1' for _ in fields)}\n"
        f"WIDTH {len(scan)}\n"
        "HEIGHT 1\n"
        f"VIEWPOINT {x:.9g} {y:.9g} {z:.9g} 1 0 0 0\n"
        f"POINTS {len(scan)}\n"
        "DATA binary\n"
    )
    return header.encode("ascii") + rows.tobytes()

"""From many scans to described objects; those that cannot be described are told apart."""

from __future__ import annotations

import warnings
from functools import partial

import numpy as np

from shapeconcepts.descriptors.described_object import DescribedObject, describe
from shapeconcepts.descriptors.protocol import Descriptor
from shapeconcepts.parallel import map_in_order
from shapeconcepts.parameters import as_list
from shapeconcepts.scan import Scan, ScanError, ScanWarning, scan_errors
from shapeconcepts.segmentation import SegmentedObject, Segmenter


def list_of_scans(X: object) -> list[object]:
    """Scans of an iterable.

    Raises
    ------
    ValueError
        If X is a single scan.
    """
    if isinstance(X, np.ndarray) and X.ndim == 2:
        raise ValueError(f"X must be a list of scans, got a single {X.shape} array: wrap it in a list, [X]")
    return as_list(X, (Scan, SegmentedObject, DescribedObject))


def describe_scans(
    scans: list[object],
    segmenter: Segmenter,
    descriptor: str | Descriptor,
    n_jobs: int | None,
    n_occlusions: int = 0,
) -> tuple[list[DescribedObject | None], dict[int, str]]:
    """Segment and describe scans; None, with the reason by its position, where that is not possible.

    Parameters are those of `describe_scan` and joblib's `n_jobs`.

    Raises
    ------
    ScanError
        If no scan can be described.

    Warns
    -----
    ScanWarning
        If a scan cannot be described.
    """
    describe_one = partial(describe_scan, segmenter, descriptor, n_occlusions=n_occlusions)
    results = list(map_in_order(describe_one, scans, n_jobs))
    skipped = {i: str(result) for i, result in enumerate(results) if isinstance(result, ScanError)}
    if scans and len(skipped) == len(scans):
        raise ScanError(skipped[0])
    if skipped:
        reasons = "; ".join([f"number {i}: {reason}" for i, reason in skipped.items()][:3])
        more = "; ..." if len(skipped) > 3 else ""
        warnings.warn(
            f"{len(skipped)} of {len(scans)} scans are skipped: {reasons}{more}", ScanWarning, stacklevel=3
        )
    return [None if isinstance(result, ScanError) else result for result in results], skipped


def describe_scan(
    segmenter: Segmenter, descriptor: str | Descriptor, scan: object, n_occlusions: int = 0
) -> DescribedObject | ScanError:
    """Segment and describe a scan, or say why that is not possible.

    Parameters
    ----------
    segmenter : Segmenter
    descriptor : str or Descriptor
    scan : Scan, (n, 3) array, point cloud, SegmentedObject or DescribedObject
        What is segmented or described already stays as it is.
    n_occlusions : int
        As in `describe`.
    """
    if isinstance(scan, DescribedObject):
        return scan
    try:
        with scan_errors(getattr(scan, "name", "") or "scan", "described"):
            segmented = scan if isinstance(scan, SegmentedObject) else segmenter.segment(scan)
            return describe(segmented, descriptor, n_occlusions)
    except ScanError as error:
        return error

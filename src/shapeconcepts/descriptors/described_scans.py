"""From many scans to described objects; those that cannot be described are told apart."""

from __future__ import annotations

import warnings
from collections import deque
from collections.abc import Callable, Iterable, Iterator
from functools import partial
from typing import NamedTuple

import numpy as np

from shapeconcepts.descriptors.described_object import DescribedObject, describe
from shapeconcepts.descriptors.protocol import Descriptor
from shapeconcepts.parallel import map_in_order
from shapeconcepts.parameters import check_iterable
from shapeconcepts.scan import Scan, ScanError, ScanWarning, scan_errors
from shapeconcepts.segmentation import SegmentedObject, Segmenter
from shapeconcepts.sources.notices import in_few_words


class DescribedScan(NamedTuple):
    """What became of a scan: its description, or the reason why there is none."""

    name: str
    label: str | None
    described: DescribedObject | None
    reason: str = ""
    notices: tuple[str, ...] = ()


def scans_in(X: object) -> Iterable[object]:
    """Scans of an iterable.

    Raises
    ------
    ValueError
        If X is a single scan.
    """
    if isinstance(X, np.ndarray) and X.ndim == 2:
        raise ValueError(f"X must be a list of scans, got a single {X.shape} array: wrap it in a list, [X]")
    return check_iterable(X, (Scan, SegmentedObject, DescribedObject))


def describe_scans(
    scans: Iterable[object],
    segmenter: Segmenter,
    descriptor: str | Descriptor,
    n_jobs: int | None,
    n_occlusions: int = 0,
) -> list[DescribedScan]:
    """Segment and describe scans, one after the other: they need not be in memory at the same time.

    Parameters are those of `describe_scan` and joblib's `n_jobs`.

    Raises
    ------
    ScanError
        If no scan can be described.

    Warns
    -----
    ScanWarning
        If a scan cannot be described, or what should be looked at in scans, see `Scan.notices`.
    """
    describe_one = partial(_described_scan, segmenter, descriptor, n_occlusions=n_occlusions)
    results = list(_in_order(scans, partial(map_in_order, describe_one, n_jobs=n_jobs)))
    skipped = {i: result.reason for i, result in enumerate(results) if result.described is None}
    if results and len(skipped) == len(results):
        raise ScanError(skipped[0])
    if skipped:
        reasons = "; ".join([f"number {i}: {reason}" for i, reason in skipped.items()][:3])
        more = "; ..." if len(skipped) > 3 else ""
        warnings.warn(
            f"{len(skipped)} of {len(results)} scans are skipped: {reasons}{more}", ScanWarning, stacklevel=3
        )
    notices = [
        (result.name or f"number {i}", notice)
        for i, result in enumerate(results)
        for notice in result.notices
    ]
    for sentence in in_few_words(notices, len(results)):
        warnings.warn(sentence, ScanWarning, stacklevel=3)
    return results


def _in_order(
    scans: Iterable[object], work: Callable[[Iterable[object]], Iterator[DescribedScan]]
) -> Iterator[DescribedScan]:
    """Results of work on scans; what is described already goes nowhere."""
    # What is taken ahead of the results: those of described scans, None for each that is worked on.
    ahead: deque[DescribedScan | None] = deque()

    def not_described() -> Iterator[object]:
        for scan in scans:
            if isinstance(scan, DescribedObject):
                ahead.append(DescribedScan(scan.name, scan.label, scan))
            else:
                ahead.append(None)
                yield scan

    for result in work(not_described()):
        while (ready := ahead.popleft()) is not None:
            yield ready
        yield result
    yield from (one for one in ahead if one is not None)


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
    result = _described_scan(segmenter, descriptor, scan, n_occlusions)
    return ScanError(result.reason) if result.described is None else result.described


def _described_scan(
    segmenter: Segmenter, descriptor: str | Descriptor, scan: object, n_occlusions: int = 0
) -> DescribedScan:
    name, label = str(getattr(scan, "name", "") or ""), getattr(scan, "label", None)
    if isinstance(scan, DescribedObject):
        return DescribedScan(name, label, scan)
    try:
        with scan_errors(name or "scan", "described"):
            segmented = scan if isinstance(scan, SegmentedObject) else segmenter.segment(scan)
            described = describe(segmented, descriptor, n_occlusions)
            return DescribedScan(name, label, described, notices=segmented.notices)
    except ScanError as error:
        return DescribedScan(name, label, None, str(error))

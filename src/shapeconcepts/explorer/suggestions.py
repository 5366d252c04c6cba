"""What a concept may be called before anybody named it: its shape in words."""

from __future__ import annotations

from collections.abc import Callable

from shapeconcepts.report.geometric_name import geometric_name
from shapeconcepts.scan import ScanError, scan_errors
from shapeconcepts.segmentation import SegmentedObject


def suggested_name(segmented: Callable[[int], SegmentedObject], row: int) -> str:
    """Of a scan; empty where it cannot be had."""
    try:
        with scan_errors(f"scan {row}", "named"):
            return geometric_name(segmented(row))
    except ScanError:
        return ""

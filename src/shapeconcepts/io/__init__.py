"""Readers: from files of many formats to scans."""

from shapeconcepts.io.collection import (
    ScanFile,
    ScanList,
    ScanWarning,
    find_scan_files,
    iter_scans,
    read_scans,
)
from shapeconcepts.io.conversion import as_scan
from shapeconcepts.io.reader import SCAN_SUFFIXES, read_scan

__all__ = [
    "SCAN_SUFFIXES",
    "ScanFile",
    "ScanList",
    "ScanWarning",
    "as_scan",
    "find_scan_files",
    "iter_scans",
    "read_scan",
    "read_scans",
]

"""Where scans come from: files, folders, and public data sets."""

from shapeconcepts.sources.collection import ScanFile, ScanList, find_scan_files, iter_scans, read_scans
from shapeconcepts.sources.conversion import as_scan
from shapeconcepts.sources.labelled_folder import load_labelled
from shapeconcepts.sources.mesh_views import load_views
from shapeconcepts.sources.oscd import load_oscd, split_of
from shapeconcepts.sources.osd import load_osd
from shapeconcepts.sources.reader import SCAN_SUFFIXES, read_scan
from shapeconcepts.sources.scene_files import read_scene
from shapeconcepts.sources.washington import PAPER_CATEGORIES, load_washington

__all__ = [
    "PAPER_CATEGORIES",
    "SCAN_SUFFIXES",
    "ScanFile",
    "ScanList",
    "as_scan",
    "find_scan_files",
    "iter_scans",
    "load_labelled",
    "load_oscd",
    "load_osd",
    "load_views",
    "load_washington",
    "read_scan",
    "read_scans",
    "read_scene",
    "split_of",
]

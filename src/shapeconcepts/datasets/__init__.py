"""Data sets: the simulator and readers of public ones."""

from shapeconcepts.datasets.labelled_folder import load_labelled
from shapeconcepts.datasets.oscd import load_oscd, split_of
from shapeconcepts.datasets.osd import load_osd
from shapeconcepts.datasets.sensor import scan_mesh
from shapeconcepts.datasets.sensor_model import SensorModel
from shapeconcepts.datasets.shapes import PART_NAMES
from shapeconcepts.datasets.simulation import CATEGORIES, simulate, simulate_scan
from shapeconcepts.datasets.washington import PAPER_CATEGORIES, load_washington

__all__ = [
    "CATEGORIES",
    "PAPER_CATEGORIES",
    "PART_NAMES",
    "SensorModel",
    "load_labelled",
    "load_oscd",
    "load_osd",
    "load_washington",
    "scan_mesh",
    "simulate",
    "simulate_scan",
    "split_of",
]

"""Data sets: the simulator and readers of public ones."""

from shapeconcepts.datasets.osd import load_osd
from shapeconcepts.datasets.sensor import scan_mesh
from shapeconcepts.datasets.sensor_model import SensorModel
from shapeconcepts.datasets.shapes import PART_NAMES
from shapeconcepts.datasets.simulation import CATEGORIES, simulate, simulate_scan

__all__ = ["CATEGORIES", "PART_NAMES", "SensorModel", "load_osd", "scan_mesh", "simulate", "simulate_scan"]

"""The simulator: random objects of seven categories, and a Kinect-like sensor that scans any mesh."""

from shapeconcepts.simulation.categories import CATEGORIES, simulate, simulate_scan
from shapeconcepts.simulation.sensor import scan_mesh
from shapeconcepts.simulation.sensor_model import SensorModel
from shapeconcepts.simulation.shapes import PART_NAMES
from shapeconcepts.simulation.views import views

__all__ = ["CATEGORIES", "PART_NAMES", "SensorModel", "scan_mesh", "simulate", "simulate_scan", "views"]

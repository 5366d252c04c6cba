"""The simulator: random objects of seven categories, tables full of them, and a Kinect-like sensor."""

from shapeconcepts.simulation.categories import CATEGORIES, simulate, simulate_scan
from shapeconcepts.simulation.sensor import scan_mesh
from shapeconcepts.simulation.sensor_model import SensorModel
from shapeconcepts.simulation.shapes import PART_NAMES
from shapeconcepts.simulation.table_top import SceneObject, SimulatedScene, simulate_scene, simulate_scenes
from shapeconcepts.simulation.views import views

__all__ = [
    "CATEGORIES",
    "PART_NAMES",
    "SceneObject",
    "SensorModel",
    "SimulatedScene",
    "scan_mesh",
    "simulate",
    "simulate_scan",
    "simulate_scene",
    "simulate_scenes",
    "views",
]

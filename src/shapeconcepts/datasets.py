"""Data sets: the simulator, and public data sets as they are published."""

from shapeconcepts.simulation import (
    CATEGORIES,
    PART_NAMES,
    SceneObject,
    SensorModel,
    SimulatedScene,
    scan_mesh,
    simulate,
    simulate_scan,
    simulate_scene,
    simulate_scenes,
    views,
)
from shapeconcepts.sources import (
    PAPER_CATEGORIES,
    load_labelled,
    load_oscd,
    load_osd,
    load_views,
    load_washington,
    split_of,
)

__all__ = [
    "CATEGORIES",
    "PAPER_CATEGORIES",
    "PART_NAMES",
    "SceneObject",
    "SensorModel",
    "SimulatedScene",
    "load_labelled",
    "load_oscd",
    "load_osd",
    "load_views",
    "load_washington",
    "scan_mesh",
    "simulate",
    "simulate_scan",
    "simulate_scene",
    "simulate_scenes",
    "split_of",
    "views",
]

"""Data sets: the simulator, and public data sets as they are published."""

from shapeconcepts.simulation import (
    CATEGORIES,
    PART_NAMES,
    SensorModel,
    scan_mesh,
    simulate,
    simulate_scan,
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
    "SensorModel",
    "load_labelled",
    "load_oscd",
    "load_osd",
    "load_views",
    "load_washington",
    "scan_mesh",
    "simulate",
    "simulate_scan",
    "split_of",
    "views",
]

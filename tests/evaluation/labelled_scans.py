"""Small labelled data sets for the tests of the experiments."""

from functools import cache

import shapeconcepts
from shapeconcepts.evaluation.labelled_objects import LabelledObjects, labelled_objects
from shapeconcepts.segmentation import SegmentedObject

CATEGORIES = ("ball", "box", "can")


@cache
def segmented_scans(n_per_category: int = 12, random_state: int = 0) -> tuple[SegmentedObject, ...]:
    """Segmented simulated scans of three categories."""
    scans = shapeconcepts.datasets.simulate(n_per_category, categories=CATEGORIES, random_state=random_state)
    return tuple(shapeconcepts.segment(scan) for scan in scans)


@cache
def simulated_objects() -> LabelledObjects:
    """The same, described for both presets."""
    return labelled_objects(segmented_scans(), "simulated", ["default", "paper"])

"""Draws the pictures of dictionary, hierarchy and explanation in docs/images, from simulated scans.

python docs/motif_pictures.py
"""

from pathlib import Path

from PIL import Image

from pictures import draw_dictionary, draw_hierarchy
from shapeconcepts import MotifHierarchyEnsemble, SegmentDictionary, describe, segment
from shapeconcepts.datasets import simulate, simulate_scan
from shapeconcepts.report import draw_explanation

IMAGES = Path(__file__).parent / "images"


def save(picture: Image.Image, name: str) -> None:
    """A palette of 256 colours takes less than half of the space; for few hues it looks the same."""
    picture.quantize(256, method=Image.Quantize.MEDIANCUT).save(IMAGES / name, optimize=True)


if __name__ == "__main__":
    training_objects = [segment(scan) for scan in simulate(n_per_category=30, random_state=1)]
    ensemble = MotifHierarchyEnsemble(SegmentDictionary(n_levels=4)).fit(map(describe, training_objects))
    draw_dictionary(ensemble.dictionary_, training_objects, IMAGES / "dictionary.png")

    not_in_training = segment(simulate_scan("teddy", 43, random_state=1))
    save(draw_hierarchy(ensemble, not_in_training, 3), "hierarchy.png")
    explanation = ensemble.explain(describe(not_in_training))
    save(draw_explanation(explanation, not_in_training, training_objects), "explanation.png")

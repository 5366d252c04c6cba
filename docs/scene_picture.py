"""Draws docs/images/extracted_scene.jpg: a simulated table with the objects that are found on it.

python docs/scene_picture.py
"""

from pathlib import Path

from shapeconcepts import datasets, extract_objects
from shapeconcepts.report.scene_picture import draw_scene

PICTURE = Path(__file__).parent / "images" / "extracted_scene.jpg"
SEED, INDEX = 1, 8


def main() -> None:
    scene = datasets.simulate_scene(INDEX, random_state=SEED)
    draw_scene(scene, extract_objects(scene)).save(PICTURE, quality=88)


if __name__ == "__main__":
    main()

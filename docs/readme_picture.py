"""Draws docs/images/segments.png, the picture at the top of the README.

python docs/readme_picture.py
"""

from pathlib import Path

from shapeconcepts import segment
from shapeconcepts.datasets import simulate_scan
from shapeconcepts.report import draw_segments

SHOWN = {"box": 7, "can": 8, "ball": 8, "amphora": 4, "teddy": 8, "sack": 7, "plate": 1}

if __name__ == "__main__":
    objects = [segment(simulate_scan(category, index, random_state=1)) for category, index in SHOWN.items()]
    draw_segments(objects, Path(__file__).parent / "images" / "segments.png", columns=len(objects), size=240)

"""Writes files as the Washington RGB-D Object Dataset has them."""

import numpy as np
from PIL import Image

PCD_HEADER = """# .PCD v.7 - Point Cloud Data file format
VERSION .7
FIELDS x y z rgb imX imY
SIZE 4 4 4 4 4 4
TYPE F F F F F F
COUNT 1 1 1 1 1 1
WIDTH {n}
HEIGHT 1
VIEWPOINT 0 0 0 1 0 0 0
POINTS {n}
DATA ascii
"""


def write_cloud(folder, category, instance, video, frame, depth=0.8):
    """A cloud whose points all have the given depth; its path."""
    path = folder / category / f"{category}_{instance}" / f"{category}_{instance}_{video}_{frame}.pcd"
    path.parent.mkdir(parents=True, exist_ok=True)
    rows = [(0.01 * i, 0.02 * i, depth, 2.3e-38, 300 + i, 200 + i) for i in range(5)]
    lines = [" ".join(f"{value:g}" for value in row) for row in rows]
    path.write_text(PCD_HEADER.format(n=len(rows)) + "\n".join(lines) + "\n")
    return path


def write_crop(folder, category, instance, video, frame, depth, mask, corner):
    """Depth image, mask, colour image and corner of a crop; the path without its ending."""
    path = folder / category / f"{category}_{instance}" / f"{category}_{instance}_{video}_{frame}"
    path.parent.mkdir(parents=True, exist_ok=True)
    Image.fromarray(depth.astype(np.uint16)).save(f"{path}_depthcrop.png")
    Image.fromarray(mask).save(f"{path}_maskcrop.png")
    Image.fromarray(np.zeros((*depth.shape, 3), np.uint8)).save(f"{path}_crop.png")
    (path.parent / f"{path.name}_loc.txt").write_text(f"{corner[0]},{corner[1]}\n")
    return path

"""Whether concepts that were learned from meshes alone hold for real scans.

    python benchmarks/mesh_views.py [--meshes N] [--views N]

Learned from simulated views of the simulator's seven shapes and of further meshes made here (tableware.py),
N of each, seen from all around. Real scans respond: osd_learn, and restaurant_views. Shown is the share of
scans whose concept is one in which most views are of their shape, for each shape, and of scans that remind
most of views of their shape, which uses labels. A carton counts as the box that it is. The bars: 0.90 for
boxes and cans of osd_learn, 0.85 over the shapes of restaurant_views.
"""

import os

os.environ["OMP_NUM_THREADS"] = "1"

import warnings
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from common import command, described, labelled_scans, print_table
from concept_scores import majority_labels
from shapeconcepts import DescribedObject, Scan, ShapeConceptModel, datasets
from shapeconcepts.concepts.recognition import concept_shares
from shapeconcepts.simulation.shapes import SHAPES
from tableware import TABLEWARE

SETS = ("osd_learn", "restaurant_views")


def views_of(shapes: dict, kinds: list[str], n_meshes: int, n_views: int) -> list[Scan]:
    scans = []
    for kind in kinds:
        for number in range(n_meshes):
            mesh = shapes[kind](np.random.default_rng((number, len(kind))))
            name = f"{kind}_{number}"
            scans += datasets.views(mesh.vertices, mesh.faces, n_views, name=name, label=kind)
    return scans


def shapes_of(objects: Sequence[Scan | DescribedObject]) -> NDArray[np.str_]:
    return np.array(["box" if one.label == "carton" else one.label for one in objects])


def main() -> None:
    parser = command(__doc__)
    parser.add_argument("--meshes", type=int, default=8, metavar="N", help="of each shape")
    parser.add_argument("--views", type=int, default=24, metavar="N", help="of each mesh")
    options = parser.parse_args()
    warnings.simplefilter("ignore")
    scans = views_of(SHAPES, list(SHAPES), options.meshes, options.views)
    scans += views_of(
        TABLEWARE, [kind for kind in TABLEWARE if kind not in SHAPES], options.meshes, options.views
    )
    model = ShapeConceptModel(n_jobs=-1).fit(scans)
    labels = shapes_of(scans)
    of_concept = majority_labels(model.labels_, labels)
    names, label_of = np.unique(labels, return_inverse=True)
    print(f"{len(scans)} views, {len(model.concepts_)} concepts")
    lines = []
    for name in SETS:
        objects = described(labelled_scans(parser, name))
        truth = shapes_of(objects)
        concepts = of_concept[model.predict(objects)]
        shares = concept_shares(model.ensemble_.reminders(objects), label_of, len(names))
        told = names[shares.argmax(axis=1)]
        for label in [*np.unique(truth), "all"]:
            some = (truth == label) | (label == "all")
            wrong, counts = np.unique(concepts[some & (concepts != truth)], return_counts=True)
            taken = ", ".join(f"{wrong[i] or 'unknown'} {counts[i]}" for i in np.argsort(-counts)[:3])
            right = [f"{(found == truth)[some].mean():.3f}" for found in (concepts, told)]
            lines.append((name, label, some.sum(), *right, taken))
    print_table(("set", "shape", "scans", "right concept", "by label", "else taken for"), lines)


if __name__ == "__main__":
    main()

"""How the time of heat, filtration and concepts grows with the number of objects.

    python benchmarks/filtration_growth.py [--vertices N ...] [--heat {divergence,geodesic}]

Kinds of tree: "attached" joins each vertex to a random earlier one, which gives hubs and short ways; "long"
joins it to one of the ten before it; "star" joins all to one, with equal lengths. The other lengths are
random. Every vertex is an object, whose row has 3 of 30 columns. "heat" is the geodesic one; "filtration" is
what `Filtration.fit` does after it: mean divergences, annexations, the time of concepts, and the concepts at
that time, with births, deaths, medoids and labels. "concepts" are groups of at least three objects at half of
the time, "all groups" those of at least one. Shown is the mean of two runs in one thread, with warm kernels.
The bar is 5 s for the sum of heat and filtration at a million.
"""

import os

os.environ["OMP_NUM_THREADS"] = "1"

import time
import warnings

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_matrix

from common import command, print_table
from shapeconcepts import Filtration, TopologicalSpace

SIZES = (1_000, 10_000, 100_000, 1_000_000)
RUNS = 2


def random_tree(kind: str, n: int) -> NDArray[np.int32]:
    """Edges (n - 1, 2) of a tree, the smaller vertex first, sorted; vertices in random order."""
    generator = np.random.default_rng(0)
    later = np.arange(1, n)
    reach = np.minimum(later, 10) if kind == "long" else later
    earlier = later - 1 - (reach * generator.random(n - 1)).astype(np.int64)
    if kind == "star":
        earlier[:] = 0
    names = generator.permutation(n).astype(np.int32)
    edges = np.sort(names[np.stack([earlier, later], axis=1)], axis=1)
    return edges[np.lexsort(edges.T[::-1])]


def space_of(edges: NDArray[np.int32], lengths: str) -> TopologicalSpace:
    """Space with a given tree, random or equal lengths of its edges, without heat yet."""
    space, n = TopologicalSpace(), len(edges) + 1
    space.n_features_in_ = 1
    space.vertices_ = np.arange(n, dtype=np.int32)
    space.multiplicities_ = np.ones(n, np.int64)
    columns = np.argsort(np.random.default_rng(1).random((n, 30)), axis=1)[:, :3]
    space.rows_ = csr_matrix((np.full(3 * n, 1 / 3), columns.ravel(), np.arange(0, 3 * n + 1, 3)), (n, 30))
    space.edges_ = edges
    space.divergences_ = np.random.default_rng(2).random(n - 1) if lengths == "random" else np.ones(n - 1)
    return space


def measure(edges: NDArray[np.int32], lengths: str, heat: str) -> tuple[list[float], int, int]:
    """Seconds of heat, filtration, concepts, all groups; number of the filtration's concepts, the largest."""
    space = space_of(edges, lengths)
    moments = [time.perf_counter()]
    space._set_heat()
    moments.append(time.perf_counter())
    filtration = Filtration(heat=heat, stop="annexations")
    filtration._filter(space)
    moments.append(time.perf_counter())
    filtration.groups_at(0.5)
    moments.append(time.perf_counter())
    filtration.groups_at(0.5, min_size=1)
    moments.append(time.perf_counter())
    largest = filtration.concepts_[0].size if filtration.concepts_ else 0
    return np.diff(moments).tolist(), len(filtration.concepts_), largest


def main() -> None:
    parser = command(__doc__)
    parser.add_argument(
        "--vertices", type=int, nargs="+", default=SIZES, metavar="N", help="sizes of the trees"
    )
    parser.add_argument("--heat", choices=("divergence", "geodesic"), default="divergence")
    options = parser.parse_args()
    warnings.simplefilter("ignore")
    rows = []
    for kind in ("attached", "long", "star"):
        lengths = "equal" if kind == "star" else "random"
        measure(random_tree(kind, 100), lengths, options.heat)
        for n in options.vertices:
            edges = random_tree(kind, n)
            runs = [measure(edges, lengths, options.heat) for _ in range(RUNS)]
            seconds = np.mean([run[0] for run in runs], axis=0)
            times = (seconds[0], seconds[1], seconds[:2].sum(), *seconds[2:])
            rows.append([kind, n, *runs[0][1:], *(f"{value:.3f}" for value in times)])
    print_table(
        (
            "",
            "vertices",
            "concepts",
            "largest",
            "heat, s",
            "filtration, s",
            "sum, s",
            "concepts, s",
            "all groups, s",
        ),
        rows,
    )


if __name__ == "__main__":
    main()

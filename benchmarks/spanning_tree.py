"""Time and memory of the spanning tree and the filtration of rows like stimuli, and how they grow.

    python benchmarks/spanning_tree.py [--large] [--scipy]

A row has 30 entries of 3,000 columns, drawn without replacement with chances of 1 / rank, so that the first
few columns are in nearly every row. Measured is `TopologicalSpace.fit`: canonical order, tree and heat, with
warm kernels, at 2,000 and 20,000 rows; with --large also at 100,000, which takes minutes. "memory" is how far
the largest resident memory rises during the call (Linux). "classes": the same of `mean_divergences`, the
rest of the default filtration's work, which is run once. --scipy has SciPy compute all Jensen-Shannon
distances of 2,000 rows and their tree. The bars: 0.15 s; 10 s and 500 MB; 5 minutes and 2,000 MB.
"""

import os

os.environ["OMP_NUM_THREADS"] = "1"

import re
import time
from pathlib import Path

import numpy as np
from scipy.sparse import csr_matrix
from scipy.sparse.csgraph import minimum_spanning_tree
from scipy.spatial.distance import pdist, squareform

from common import command, print_table
from shapeconcepts import Filtration, TopologicalSpace
from shapeconcepts.topology.mean_divergence import mean_divergences

N_COLUMNS = 3_000
N_ENTRIES = 30
MAX_VERTICES = Filtration().max_vertices
REPEATS = 5


def make_rows(n: int) -> csr_matrix:
    generator = np.random.default_rng(0)
    chances = np.log(1 / np.arange(1, N_COLUMNS + 1))
    blocks = []
    for start in range(0, n, 2_000):
        # The largest of Gumbel-perturbed logarithms are a draw without replacement.
        keys = chances + generator.gumbel(size=(min(2_000, n - start), N_COLUMNS))
        blocks.append(np.sort(np.argpartition(-keys, N_ENTRIES, axis=1)[:, :N_ENTRIES], axis=1))
    columns = np.concatenate(blocks).ravel()
    values = 1e-3 + generator.random(len(columns))
    return csr_matrix((values, columns, np.arange(0, len(columns) + 1, N_ENTRIES)), (n, N_COLUMNS))


def resident(field: str) -> float:
    """Resident memory now ("VmRSS") or the largest since the last reset ("VmHWM"), MB."""
    status = Path("/proc/self/status").read_text()
    return 1024 * int(re.search(rf"{field}:\s+(\d+)", status).group(1)) / 1e6


def measure(n: int) -> tuple[float, float, float, float, float]:
    """Of the tree seconds (median), memory in MB and weight; of the classes seconds and memory."""
    rows = make_rows(n)
    Path("/proc/self/clear_refs").write_text("5")
    before = resident("VmRSS")
    seconds = []
    while len(seconds) < REPEATS and sum(seconds) < 10:
        start = time.perf_counter()
        space = TopologicalSpace().fit(rows)
        seconds.append(time.perf_counter() - start)
    memory = resident("VmHWM") - before
    Path("/proc/self/clear_refs").write_text("5")
    before = resident("VmRSS")
    start = time.perf_counter()
    classes = mean_divergences(space, MAX_VERTICES)
    of_classes = time.perf_counter() - start, resident("VmHWM") - before
    assert len(classes.order) == n - 1
    return float(np.median(seconds)), memory, space.divergences_.sum(), *of_classes


def scipy_tree(n: int) -> tuple[float, float]:
    """Seconds and weight."""
    rows = make_rows(n).toarray()
    start = time.perf_counter()
    tree = minimum_spanning_tree(squareform(pdist(rows, "jensenshannon") ** 2 / np.log(2)))
    return time.perf_counter() - start, tree.sum()


def main() -> None:
    parser = command(__doc__)
    parser.add_argument("--large", action="store_true", help="also 100,000 rows")
    parser.add_argument("--scipy", action="store_true", help="also SciPy, at 2,000 rows")
    options = parser.parse_args()
    sizes = [2_000, 5_000, 20_000, *([100_000] if options.large else [])]
    mean_divergences(TopologicalSpace().fit(make_rows(100)), MAX_VERTICES)
    table, times = [], []
    for n in sizes:
        seconds, memory, weight, *of_classes = measure(n)
        times.append(seconds)
        cells = (f"{seconds:.3f}", f"{memory:.0f}", f"{weight:.6f}")
        table.append([n, *cells, f"{of_classes[0]:.3f}", f"{of_classes[1]:.0f}"])
    if options.scipy:
        seconds, weight = scipy_tree(2_000)
        table.append(["2000, SciPy", f"{seconds:.3f}", "", f"{weight:.6f}", "", ""])
    titles = ("time, s", "memory, MB", "weight of the tree", "classes, s", "classes, MB")
    print_table(("rows", *titles), table)
    print(
        f"exponent of the time over the number of rows: {np.polyfit(np.log(sizes), np.log(times), 1)[0]:.2f}"
    )


if __name__ == "__main__":
    main()

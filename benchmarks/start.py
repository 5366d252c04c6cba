"""How long the package takes to import, and to compile its kernels on a new machine.

    python benchmarks/start.py [--repeats N]

Every start is a process of its own. `import` is `import shapeconcepts`, within the process. "first use"
simulates scans, segments them with and without a viewpoint, describes them with both descriptors, learns
concepts from them, and asks the model about one, from the start of the process to its end, in an empty cache
of compiled kernels; "second use" does the same again,
with the kernels cached.
"""

import os

os.environ["OMP_NUM_THREADS"] = "1"

import statistics
import subprocess
import sys
import tempfile
import time

from common import command, print_table

IMPORT = "import time; start = time.perf_counter(); import shapeconcepts; print(time.perf_counter() - start)"
USE = """
from dataclasses import replace
import shapeconcepts as sc
from shapeconcepts.descriptors import compute_fpfh
scan, = sc.datasets.simulate(1, categories=["can"])
segmented = sc.segment(scan)
sc.segment(replace(scan, viewpoint=None))
sc.FPFH().describe(segmented)
sc.Surflet().describe(segmented)
compute_fpfh(segmented.points, segmented.normals, 0.03)
scans = sc.datasets.simulate(3, categories=["can", "ball"])
model = sc.ShapeConceptModel().fit(scans)
model.transform(scans[:1]), model.predict(scans[:1]), model.explain(scans[0])
"""


def run(program: str, cache: str | None = None) -> tuple[float, str]:
    """Seconds from start to end of a process, and what it prints."""
    environment = dict(os.environ, **({} if cache is None else {"NUMBA_CACHE_DIR": cache}))
    start = time.perf_counter()
    done = subprocess.run(
        [sys.executable, "-c", program], env=environment, stdout=subprocess.PIPE, text=True, check=True
    )
    return time.perf_counter() - start, done.stdout


def main() -> None:
    parser = command(__doc__)
    parser.add_argument("--repeats", type=int, default=5, metavar="N", help="imports (default: 5)")
    options = parser.parse_args()
    imports = [float(run(IMPORT)[1]) for _ in range(options.repeats)]
    with tempfile.TemporaryDirectory() as cache:
        first, _ = run(USE, cache)
        second, _ = run(USE, cache)
    print_table(
        ("", "seconds"),
        [
            [f"import, median of {options.repeats}", f"{statistics.median(imports):.2f}"],
            ["first use of all kernels", f"{first:.1f}"],
            ["second use", f"{second:.1f}"],
        ],
    )


if __name__ == "__main__":
    main()

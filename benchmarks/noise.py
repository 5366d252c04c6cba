"""How often noise is split, at several error rates.

    python benchmarks/noise.py [--draws N] [--sizes N ...]

Rows are uniform, Gaussian (around 4, in absolute terms) and Dirichlet with all weights 1, with 2, 3, 5, 10
and 50 columns. Shown is the share of draws with more than one concept: of the tree of concepts at granularity
1, where nothing but the error rate decides, at each error rate; and at the default granularity and error
rate. The bars: at most 5 % at the default, and shares that follow the error rate.
"""

import os

os.environ["OMP_NUM_THREADS"] = "1"

import warnings

import numpy as np
from numpy.typing import NDArray

from common import command, print_table
from shapeconcepts import Filtration
from shapeconcepts.concepts.significance import significant

KINDS = ("uniform", "Gaussian", "Dirichlet")
COLUMNS = (2, 3, 5, 10, 50)
SIZES = (60, 200, 1000, 4000)
ERROR_RATES = (0.01, 0.05, 0.2)


def draw(generator: np.random.Generator, kind: str, n: int, n_columns: int) -> NDArray[np.float64]:
    if kind == "uniform":
        return generator.random((n, n_columns))
    if kind == "Gaussian":
        return np.abs(generator.normal(4, 1, (n, n_columns)))
    return generator.dirichlet(np.ones(n_columns), n)


def main() -> None:
    parser = command(__doc__)
    parser.add_argument("--draws", type=int, default=100, metavar="N")
    parser.add_argument("--sizes", nargs="+", type=int, default=SIZES, metavar="N", help="numbers of rows")
    options = parser.parse_args()
    warnings.simplefilter("ignore")
    table = []
    for n in options.sizes:
        for kind in KINDS:
            for n_columns in COLUMNS:
                generator = np.random.default_rng([n, KINDS.index(kind), n_columns])
                split = np.zeros((options.draws, len(ERROR_RATES)), bool)
                several = np.zeros(options.draws, bool)
                for k in range(options.draws):
                    filtration = Filtration().fit(draw(generator, kind, n, n_columns))
                    split[k] = [significant(filtration.p_values_, rate).any() for rate in ERROR_RATES]
                    several[k] = len(filtration.concepts_) > 1
                shares = [f"{share:.0%}" for share in (*split.mean(axis=0), several.mean())]
                table.append((n, kind, n_columns, *shares))
                print(*table[-1], flush=True)
    titles = [f"split at {rate:.0%}" for rate in ERROR_RATES]
    print()
    print_table(("rows", "kind", "columns", *titles, "default"), table)


if __name__ == "__main__":
    main()

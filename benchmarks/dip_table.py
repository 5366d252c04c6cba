"""Makes the table of the dip test in src/shapeconcepts/concepts/dip.py.

    python benchmarks/dip_table.py [--draws N] [--seed N]

Draws uniform values, as many at a time as each of the table's sizes, and prints which dips are exceeded with
each of the table's probabilities: a row for each size, in the form in which they stand there. Of large sizes
fewer are drawn, so that no size draws more than 1000 N values.
"""

import os

os.environ["OMP_NUM_THREADS"] = "1"

import numpy as np

from common import command
from shapeconcepts.concepts.dip import PROBABILITIES, SIZES
from shapeconcepts.concepts.dip_kernels import dip

VALUES_AT_ONCE = 1_000_000


def simulated_dips(n: int, n_draws: int, generator: np.random.Generator) -> np.ndarray:
    """Dips of uniform values, of n at a time."""
    dips: list[float] = []
    while len(dips) < n_draws:
        n_rows = min(n_draws - len(dips), VALUES_AT_ONCE // n)
        # Uniform values in order are as far apart as exponential ones, but for a shift and a scale.
        dips += map(dip, generator.standard_exponential((n_rows, n)).cumsum(axis=1))
    return np.array(dips)


def main() -> None:
    parser = command(__doc__)
    parser.add_argument("--draws", type=int, default=1_000_000, metavar="N", help="default: 1000000")
    parser.add_argument("--seed", type=int, default=0, metavar="N", help="default: 0")
    options = parser.parse_args()
    for n in SIZES:
        generator = np.random.default_rng([options.seed, n])
        dips = simulated_dips(n, min(options.draws, 1000 * options.draws // n), generator)
        quantiles = 10_000 * np.sqrt(n) * np.quantile(dips, 1 - np.array(PROBABILITIES))
        print(*quantiles.round().astype(int), flush=True)


if __name__ == "__main__":
    main()

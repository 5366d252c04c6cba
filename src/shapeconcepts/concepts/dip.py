"""The dip test: do values have a single mode?

After J. A. Hartigan and P. M. Hartigan, The dip test of unimodality, Annals of Statistics 13, 1985.
"""

from __future__ import annotations

import math
import sys

import numpy as np
from numpy.typing import ArrayLike, NDArray

from shapeconcepts.concepts import dip_kernels

SIZES = (4, 5, 6, 7, 8, 9, 10, 12, 14, 17, 20, 25, 32, 40, 55, 75, 100, 150, 250, 500, 1000, 2500, 6000)
PROBABILITIES = (
    *(0.99, 0.95, 0.9, 0.8, 0.7, 0.6, 0.5, 0.4, 0.3, 0.2),
    *(0.15, 0.1, 0.05, 0.02, 0.01, 0.005, 0.002, 0.001, 0.0003, 0.0001),
)
# A row for each size: the dip of that many uniform values times 10,000 times the root of the size, which is
# exceeded with each of the probabilities. Printed by benchmarks/dip_table.py.
QUANTILES_TEXT = """
2500 2500 2500 2500 2500 2500 2500 2500 2655 3150 3431 3752 4145 4478 4637 4749 4841 4891 4939 4965
2236 2236 2236 2236 2236 2431 2719 3003 3294 3602 3770 3953 4167 4329 4395 4432 4456 4464 4469 4471
2041 2041 2041 2265 2544 2789 3014 3229 3440 3659 3774 3897 4035 4394 4707 4959 5221 5374 5577 5714
1890 1925 2166 2490 2733 2935 3117 3286 3450 3615 3701 3823 4238 4642 4869 5055 5236 5337 5471 5550
1768 2089 2319 2610 2818 2988 3139 3277 3409 3547 3756 4009 4353 4691 4894 5058 5266 5493 5799 6017
1839 2201 2413 2673 2853 2999 3126 3242 3379 3690 3874 4095 4401 4718 4933 5187 5473 5661 5925 6109
1929 2273 2467 2698 2857 2983 3092 3231 3478 3759 3925 4127 4415 4768 5045 5280 5542 5717 5978 6176
2044 2346 2508 2695 2820 2957 3155 3354 3566 3812 3964 4159 4504 4892 5142 5368 5651 5854 6171 6399
2099 2364 2500 2656 2853 3040 3218 3399 3594 3833 4000 4233 4572 4952 5216 5471 5760 5956 6263 6561
2127 2346 2482 2735 2925 3093 3256 3428 3635 3909 4081 4299 4640 5048 5324 5580 5888 6116 6443 6753
2119 2359 2540 2775 2953 3114 3280 3472 3687 3950 4120 4348 4701 5111 5392 5656 5976 6191 6539 6804
2129 2414 2581 2800 2980 3160 3336 3523 3737 4011 4187 4417 4776 5206 5497 5764 6100 6330 6704 6973
2178 2440 2604 2841 3029 3201 3378 3571 3790 4066 4246 4483 4852 5289 5589 5869 6223 6449 6857 7147
2196 2470 2642 2874 3062 3241 3420 3614 3834 4115 4297 4536 4909 5354 5661 5948 6299 6551 6951 7309
2230 2506 2678 2914 3106 3286 3469 3664 3891 4176 4361 4605 4988 5441 5757 6045 6419 6662 7060 7420
2256 2538 2713 2953 3147 3329 3514 3712 3941 4229 4417 4666 5057 5526 5846 6150 6527 6797 7201 7588
2284 2567 2742 2983 3178 3360 3547 3747 3978 4271 4463 4713 5106 5575 5905 6206 6586 6856 7292 7645
2314 2598 2776 3020 3217 3402 3590 3792 4025 4323 4515 4768 5169 5649 5981 6288 6678 6940 7381 7750
2349 2633 2813 3058 3257 3444 3635 3841 4078 4378 4573 4833 5240 5726 6070 6384 6776 7051 7522 7915
2379 2671 2850 3098 3299 3489 3680 3888 4127 4430 4628 4889 5300 5792 6135 6464 6870 7160 7621 7988
2407 2695 2877 3128 3331 3520 3713 3922 4163 4469 4668 4934 5349 5849 6201 6532 6944 7242 7725 8074
2425 2718 2901 3152 3356 3548 3743 3953 4196 4505 4710 4975 5396 5894 6248 6582 6985 7265 7711 8127
2440 2733 2918 3171 3376 3566 3762 3972 4217 4525 4727 4996 5425 5937 6271 6592 7006 7270 7731 8213
"""
QUANTILES = np.array([row.split() for row in QUANTILES_TEXT.split("\n")[1:-1]], np.float64) / 10_000
# Beyond the table the tail goes on as between here and the table's end: shorter stretches are noisier.
TAIL_START = PROBABILITIES.index(0.001)


def dip_statistic(values: ArrayLike) -> float:
    """Hartigan's dip: smallest distance of the empirical distribution function to a unimodal one.

    Parameters
    ----------
    values : (n,) array_like
        At least one, all finite, in any order.

    Returns
    -------
    float
        From 1 / (2 n), which also stands for fewer than two different values, to 1 / 4; 1 / 2 if n is 1.
        The more it is, the less the values have a single mode.
    """
    numbers = np.asarray(values, np.float64)
    if numbers.ndim != 1 or not len(numbers) or not np.isfinite(numbers).all():
        raise ValueError(f"values must be a sequence of finite numbers, at least one, got {values!r}")
    # A power of two rounds nothing, and no difference overflows then.
    _, exponent = np.frexp(np.abs(numbers).max())
    return float(dip_kernels.dip(np.sort(np.ldexp(numbers, -exponent))))


def dip_p_value(dip: float, n: int) -> float:
    """Probability that uniform values, the worst case of a single mode, have at least this dip.

    Interpolated from simulated quantiles of dip * sqrt(n), linearly in 1 / sqrt(n). The logarithm of the
    probability is nearly linear in the square of the dip, as in the tail of a normal distribution, and goes
    on so beyond the table. From its last size on, dip * sqrt(n) is taken to have its limiting distribution.

    Parameters
    ----------
    dip : float
    n : int
        Number of values that have this dip.

    Returns
    -------
    float
        In (0, 1], falling with the dip; 1 for fewer than four values, whose dip is always the smallest.
    """
    smallest = 1 / (2 * n)
    if n < SIZES[0] or dip <= smallest * (1 + 1e-9):
        return 1.0
    squares = np.maximum(quantiles(n), smallest * math.sqrt(n)) ** 2
    logarithms = np.log(PROBABILITIES)
    square = n * dip**2
    if square > squares[-1]:
        slope = (logarithms[-1] - logarithms[TAIL_START]) / (squares[-1] - squares[TAIL_START])
        logarithm = logarithms[-1] + slope * (square - squares[-1])
    else:
        logarithm = np.interp(square, [n * smallest**2, *squares], [0, *logarithms])
    return max(math.exp(logarithm), sys.float_info.min)


def quantiles(n: int) -> NDArray[np.float64]:
    """Values of dip * sqrt(n) that are exceeded with each of the probabilities, rising.

    Parameters
    ----------
    n : int
        At least 4.

    Returns
    -------
    (p,) float64
    """
    places = -1 / np.sqrt(SIZES)
    place = min(-1 / math.sqrt(n), places[-1])
    k = int(np.clip(np.searchsorted(places, place), 1, len(places) - 1))
    share = (place - places[k - 1]) / (places[k] - places[k - 1])
    return (1 - share) * QUANTILES[k - 1] + share * QUANTILES[k]

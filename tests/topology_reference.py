"""What the topological half computes, slowly: dictionaries, sets and fractions. And matrices to try it on."""

from fractions import Fraction
from itertools import combinations
from math import ceil
from typing import NamedTuple

import numpy as np
from scipy.sparse import csr_matrix
from scipy.spatial.distance import jensenshannon


def random_rows(rng: np.random.Generator, n: int, n_columns: int, density: float = 0.3) -> np.ndarray:
    """Non-negative rows, some of them empty where the density is low."""
    return rng.gamma(0.7, 1, (n, n_columns)) * (rng.random((n, n_columns)) < density)


def uniform_rows(rng: np.random.Generator, n: int, n_columns: int, n_entries: int) -> np.ndarray:
    """Rows of equally many ones: only how many they share counts, so there are many exact ties."""
    rows = np.zeros((n, n_columns))
    for row in rows:
        row[rng.choice(n_columns, n_entries, replace=False)] = 1
    return rows


def random_tree(rng: np.random.Generator, n: int, reach: int = 10**9) -> list[tuple[int, int]]:
    """Each vertex is joined to one of the `reach` before it."""
    names = rng.permutation(n).tolist()
    return [(names[max(0, a - 1 - int(rng.integers(min(a, reach))))], names[a]) for a in range(1, n)]


def rows_of_tree(edges: list[tuple[int, int]], counts: list[int]) -> csr_matrix:
    """Rows whose spanning tree is the given one, as only neighbours share a column; each `counts` times."""
    n = len(counts)
    vertices = np.repeat(np.arange(n), counts)
    columns = np.concatenate([np.arange(n), np.repeat(n + np.arange(len(edges)), 2)])
    rows = np.concatenate([np.arange(n), np.array(edges, int).ravel()])
    return csr_matrix((np.ones(len(rows)), (rows, columns)), (n, n + len(edges)))[vertices]


def slow_divergence(p: np.ndarray, q: np.ndarray) -> float:
    """Bits; 1 for an empty row."""
    if not p.any() or not q.any():
        return 1.0
    # SciPy halves the smallest numbers to 0, and takes the root of what rounding makes negative.
    p, q = (np.where(row < 1e-300, 0.0, row) for row in (p, q))
    with np.errstate(invalid="ignore"):
        return float(np.nan_to_num(jensenshannon(p, q, base=2)) ** 2)


def slow_divergences(rows: np.ndarray, others: np.ndarray) -> np.ndarray:
    return np.array([[slow_divergence(p, q) for q in others] for p in rows]).reshape(len(rows), len(others))


def kruskal(divergences: np.ndarray) -> list[tuple[int, int]]:
    """Edges of the spanning tree, by divergence but for rounding, then the smaller, then the larger end."""
    group = {vertex: {vertex} for vertex in range(len(divergences))}
    tree = []
    for _, a, b in sorted(
        (round(divergences[a, b], 12), a, b) for a, b in combinations(range(len(group)), 2)
    ):
        if group[a] is not group[b]:
            tree.append((a, b))
            joined = group[a] | group[b]
            group.update(dict.fromkeys(joined, joined))
    return sorted(tree)


def distances_from(vertex: int, neighbours: dict[int, list[int]]) -> dict[int, int]:
    distances, front = {vertex: 0}, [vertex]
    for a in front:
        for b in neighbours[a]:
            if b not in distances:
                distances[b] = distances[a] + 1
                front.append(b)
    return distances


def slow_heat(edges: list[tuple[int, int]], counts: list[int]) -> tuple[list[Fraction], list[Fraction]]:
    """Mean distance and heat of each vertex, exactly."""
    neighbours = {vertex: [] for vertex in range(len(counts))}
    for a, b in edges:
        neighbours[a].append(b)
        neighbours[b].append(a)
    means = [
        Fraction(sum(counts[b] * d for b, d in distances_from(a, neighbours).items()), sum(counts))
        for a in neighbours
    ]
    span = max(means) - min(means)
    return means, [(max(means) - mean) / span if span else Fraction(0) for mean in means]


class SlowFiltration(NamedTuple):
    edges: list[tuple[int, int]]
    times: list[Fraction]
    annexations: list[tuple[int, int]]
    counts: list[int]
    epsilon_max: Fraction | None


def components(edges: list[tuple[int, int]], n: int) -> list[set[int]]:
    """By their smallest vertex."""
    group = {vertex: {vertex} for vertex in range(n)}
    for a, b in edges:
        joined = group[a] | group[b]
        group.update(dict.fromkeys(joined, joined))
    return sorted({id(one): one for one in group.values()}.values(), key=min)


def slow_mean_divergences(
    edges: list[tuple[int, int]], divergences: np.ndarray, counts: list[int]
) -> tuple[list[int], list[Fraction]]:
    """Edges as they enter and mean divergences of their classes, all of them anew before each annexation.

    A class joins no earlier than its parts did.
    """
    exact = [[Fraction(float(d)) for d in row] for row in divergences.astype(np.float32)]
    group = {vertex: {vertex} for vertex in range(len(counts))}
    height = dict.fromkeys(range(len(counts)), Fraction(0))
    left, order, heights = set(range(len(edges))), [], []

    def mean(e: int) -> Fraction:
        pairs = [(a, b, counts[a] * counts[b]) for a in group[edges[e][0]] for b in group[edges[e][1]]]
        return sum(w * exact[a][b] for a, b, w in pairs) / sum(w for *_, w in pairs)

    while left:
        least, e = min((mean(e), e) for e in left)
        left.remove(e)
        order.append(e)
        heights.append(max(least, *(height[min(group[end])] for end in edges[e])))
        joined = group[edges[e][0]] | group[edges[e][1]]
        group.update(dict.fromkeys(joined, joined))
        height[min(joined)] = heights[-1]
    by_height = sorted(range(len(edges)), key=lambda k: heights[k])
    return [order[k] for k in by_height], [heights[k] for k in by_height]


def slow_filtration(
    edges: list[tuple[int, int]],
    counts: list[int],
    min_size: int,
    max_steps: int,
    divergences: np.ndarray | None = None,
) -> SlowFiltration:
    """By mean divergence where there are divergences, else by geodesic heat; edges must be sorted pairs."""
    if divergences is None:
        _, heat = slow_heat(edges, counts)
        weights = [(heat[a] + heat[b]) / 2 for a, b in edges]
        order = sorted(range(len(edges)), key=lambda e: (weights[e], e))
    else:
        order, heights = slow_mean_divergences(edges, divergences, counts)
        weights = [heights[order.index(e)] for e in range(len(edges))]
    if divergences is not None:
        time_of = dict(zip(edges, weights, strict=True))
    elif len(set(weights)) <= 1:
        time_of = dict.fromkeys(edges, Fraction(1))
    else:
        low, high, step = min(weights), max(weights), min(w for w in weights if w > 0)
        time_of = {e: (w - low + step) / (high - low + step) for e, w in zip(edges, weights, strict=True)}
    edges = [edges[e] for e in order]
    times = [time_of[edge] for edge in edges]

    classes = {vertex: {vertex} for vertex in range(len(counts))}  # by representative
    annexations = []
    for edge in edges:
        one, other = (next(r for r, members in classes.items() if end in members) for end in edge)
        sizes = {r: sum(counts[v] for v in classes[r]) for r in (one, other)}
        dies = min(one, other, key=lambda r: (sizes[r], -r))
        survives = one + other - dies
        classes[survives] |= classes.pop(dies)
        annexations.append((dies, survives))

    n_steps = min(max_steps, ceil(1 / times[0])) if times else 1
    per_step = [
        sum(Fraction(k, n_steps) < t <= Fraction(k + 1, n_steps) for t in times) for k in range(n_steps)
    ]
    open_steps = []
    for k, count in enumerate(per_step):
        end = Fraction(k + 1, n_steps)
        groups = components([edge for edge in edges if time_of[edge] <= end], len(counts))
        sizes = [sum(counts[v] for v in group) for group in groups]
        if count and sum(s >= min_size for s in sizes) >= 2 and 2 * max(sizes) <= sum(counts):
            open_steps.append((-count, end))
    return SlowFiltration(edges, times, annexations, per_step, min(open_steps)[1] if open_steps else None)

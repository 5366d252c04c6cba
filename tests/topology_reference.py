"""What the topological half computes, slowly: dictionaries, sets and fractions. And matrices to try it on."""

from fractions import Fraction
from itertools import combinations
from math import ceil, sqrt
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


def slow_separations(
    edges: list[tuple[int, int]], lengths: list[float], counts: list[int]
) -> tuple[list[int], list[float]]:
    """Edges as they enter and the separations of their classes, all of them anew before each annexation."""
    group = {vertex: {vertex} for vertex in range(len(counts))}
    left, order, separations = set(range(len(edges))), [], []

    def separation(e: int) -> float:
        a, b = (sum(counts[v] for v in group[end]) for end in edges[e])
        return lengths[e] * sqrt(a * b / (a + b))

    while left:
        least, e = min((separation(e), e) for e in left)
        left.remove(e)
        order.append(e)
        separations.append(least)
        joined = group[edges[e][0]] | group[edges[e][1]]
        group.update(dict.fromkeys(joined, joined))
    return order, separations


def slow_filtration(
    edges: list[tuple[int, int]],
    counts: list[int],
    min_size: int,
    max_steps: int,
    lengths: list[float] | None = None,
) -> SlowFiltration:
    """By separation where there are lengths, else by geodesic heat; edges must be sorted pairs."""
    if lengths is None:
        _, heat = slow_heat(edges, counts)
        weights = [(heat[a] + heat[b]) / 2 for a, b in edges]
        order = sorted(range(len(edges)), key=lambda e: (weights[e], e))
    else:
        order, separations = slow_separations(edges, lengths, counts)
        weights = [Fraction(separations[order.index(e)]) for e in range(len(edges))]
    if len(set(weights)) <= 1:
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


def slow_neighbours(divergences: np.ndarray, counts: list[int], n_neighbours: int) -> list[set[int]]:
    """Vertices nearest to each vertex, as many as it takes for so many objects beside one of its own."""
    neighbours = []
    for vertex, to_others in enumerate(divergences):
        found, n_objects = set(), counts[vertex] - 1
        for divergence, other in sorted((round(d, 12), k) for k, d in enumerate(to_others) if k != vertex):
            if n_objects < n_neighbours and divergence < 1:
                found.add(other)
                n_objects += counts[other]
        neighbours.append(found)
    return neighbours


def slow_settled(
    concepts: list[int],
    divergences: np.ndarray,
    counts: list[int],
    n_neighbours: int,
    min_size: int,
    n_nearest: int,
) -> list[int]:
    """Concept of each vertex after all objects have settled, object by object; -1 for none."""
    near = slow_neighbours(divergences, counts, n_neighbours)
    for _ in range(50):
        members = {c: sum(n for n, own in zip(counts, concepts, strict=True) if own == c) for c in concepts}
        concepts = [c if c >= 0 and members[c] >= min_size else -1 for c in concepts]
        moved = []
        for vertex, own in enumerate(concepts):
            to_near = sorted((divergences[vertex, other], other) for other in near[vertex])
            copies = [(0.0, own)] * (counts[vertex] - 1)
            seen = copies + [(d, concepts[other]) for d, other in to_near for _ in range(counts[other])]
            farthest = to_near[-1][0] if to_near else 0.0
            means = []
            for concept in sorted(set(concepts) - {-1}):
                distances = [d for d, c in seen if c == concept][:n_nearest]
                wanted = min(members[concept] - (concept == own), n_nearest)
                if distances:
                    distances += [farthest] * (wanted - len(distances))
                    means.append((round(sum(distances) / wanted, 10), concept != own, concept))
            moved.append(min(means)[2] if means else own)
        if moved == concepts:
            break
        concepts = moved
    members = {c: sum(n for n, own in zip(counts, concepts, strict=True) if own == c) for c in concepts}
    return [c if c >= 0 and members[c] >= min_size else -1 for c in concepts]


def slow_mixing(
    one: set[int], other: set[int], neighbours: list[set[int]], counts: list[int], n_neighbours: int
) -> Fraction:
    """Over all pairs of objects, each way."""
    pairs = [(a, b, counts[a] * counts[b]) for a in one for b in other]
    links = sum(weight * ((b in neighbours[a]) + (a in neighbours[b])) for a, b, weight in pairs)
    share = Fraction(links, 2 * sum(weight for _, _, weight in pairs))
    size = sum(counts[vertex] for vertex in one | other)
    return share / min(Fraction(1), Fraction(n_neighbours, size - 1))


def slow_neighbourhood_size(n_objects: int, per_root: float = 3) -> int:
    return max(min(max(round(per_root * sqrt(n_objects)), 36), n_objects // 2), 1)


def slow_refusals(
    edges: list[tuple[int, int]],
    divergences: np.ndarray,
    counts: list[int],
    min_size: int,
    least_mixing: Fraction,
) -> list[bool]:
    """Edges in the order in which they enter."""
    n_neighbours = slow_neighbourhood_size(sum(counts))
    neighbours = slow_neighbours(divergences, counts, n_neighbours)
    group = {vertex: {vertex} for vertex in range(len(counts))}
    refused = []
    for a, b in edges:
        smaller = min(sum(counts[v] for v in group[end]) for end in (a, b))
        is_small = smaller < min_size or smaller < n_neighbours / 16
        mixing = slow_mixing(group[a], group[b], neighbours, counts, n_neighbours)
        refused.append(divergences[a, b] > 1 - 1e-12 or (not is_small and mixing < least_mixing))
        if not refused[-1]:
            joined = group[a] | group[b]
            group.update(dict.fromkeys(joined, joined))
    return refused

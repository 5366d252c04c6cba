"""Minimum spanning tree: its weight against SciPy and scikit-learn, its edges against a slow Kruskal."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy import sparse
from scipy.sparse import csr_matrix
from scipy.sparse.csgraph import connected_components, minimum_spanning_tree
from sklearn.cluster import AgglomerativeClustering

from shapeconcepts import TopologicalSpace
from shapeconcepts.topology import jensen_shannon_divergences
from shapeconcepts.topology.sample import draws, sampled
from topology_reference import (
    components,
    kruskal,
    random_rows,
    random_tree,
    rows_of_tree,
    slow_divergences,
    uniform_rows,
)


def tree_edges(space: TopologicalSpace) -> list[tuple[int, int]]:
    return [tuple(edge) for edge in space.edges_.tolist()]


def check_structure(space: TopologicalSpace, rows: np.ndarray) -> None:
    """Vertices are the different rows, in an order of content; the rest of the space fits to them."""
    placed = rows.any(axis=1)
    n = len(space.multiplicities_)
    np.testing.assert_array_equal(space.vertices_ >= 0, placed)
    np.testing.assert_array_equal(space.multiplicities_, np.bincount(space.vertices_[placed], minlength=n))
    assert (space.multiplicities_ > 0).all()
    normal = rows[placed] / rows[placed].sum(axis=1, keepdims=True)
    np.testing.assert_allclose(space.rows_.toarray()[space.vertices_[placed]], normal, rtol=1e-12)
    assert len({row.tobytes() for row in space.rows_.toarray()}) == n
    assert space.edges_.shape == (max(n - 1, 0), 2) and space.divergences_.shape == (max(n - 1, 0),)
    assert (space.edges_[:, 0] < space.edges_[:, 1]).all()
    assert tree_edges(space) == sorted(tree_edges(space))
    if n:
        graph = sparse.coo_matrix((np.ones(n - 1), space.edges_.T), (n, n))
        assert connected_components(graph, directed=False)[0] == 1


@pytest.mark.parametrize("seed", range(6))
def test_weight_against_scipy_and_scikit_learn(seed):
    rng = np.random.default_rng(seed)
    rows = random_rows(rng, int(rng.integers(4, 90)), int(rng.integers(3, 60)), rng.uniform(0.05, 0.6))
    rows = np.concatenate([rows, rows[::3], 2 * rows[:2]])
    space = TopologicalSpace().fit(rows)
    check_structure(space, rows)
    # SciPy takes 0 for no edge, so 1 is added to each.
    between = slow_divergences(rows[rows.any(axis=1)], rows[rows.any(axis=1)])
    upper = np.triu(1 + between, 1)
    expected = minimum_spanning_tree(upper).sum() - (len(upper) - 1)
    np.testing.assert_allclose(space.divergences_.sum(), expected, atol=1e-10)
    linkage = AgglomerativeClustering(metric="precomputed", linkage="single", compute_distances=True)
    merges = np.sort(linkage.fit(between).distances_)
    np.testing.assert_allclose(
        np.sort(space.divergences_), merges[len(merges) - len(space.edges_) :], atol=1e-10
    )
    np.testing.assert_allclose(merges[: len(merges) - len(space.edges_)], 0, atol=1e-10)
    ends = space.rows_.toarray()[space.edges_]
    along = [slow_divergences(a[None], b[None])[0, 0] for a, b in ends]
    np.testing.assert_allclose(space.divergences_, along, atol=1e-12)


@pytest.mark.parametrize("n_entries", [1, 2, 3, 4, 6])
@pytest.mark.parametrize("seed", range(3))
def test_edges_among_ties(n_entries, seed):
    rng = np.random.default_rng(seed)
    n_columns = int(rng.integers(n_entries, 3 * n_entries + 3))
    rows = uniform_rows(rng, int(rng.integers(20, 90)), n_columns, n_entries)
    space = TopologicalSpace().fit(rows)
    check_structure(space, rows)
    between = slow_divergences(space.rows_.toarray(), space.rows_.toarray())
    assert len(np.unique(between.round(12))) <= n_entries + 1
    assert tree_edges(space) == kruskal(between)


@pytest.mark.parametrize("seed", range(4))
def test_edges_without_ties(seed):
    rows = random_rows(np.random.default_rng(seed), 60, 25, 0.5)
    space = TopologicalSpace().fit(rows)
    assert tree_edges(space) == kruskal(slow_divergences(space.rows_.toarray(), space.rows_.toarray()))


def test_more_rows_than_fit_in_a_block():
    """Many rows share a column, so that its list is worked off in pieces and shrinks as the tree grows."""
    rng = np.random.default_rng(3)
    rows = random_rows(rng, 700, 12, 0.5)
    rows[:, 0] = 0.5
    space = TopologicalSpace().fit(rows)
    p = space.rows_.toarray()
    m = (p[:, None] + p[None]) / 2
    entropy = [-np.where(x > 0, x * np.log2(np.where(x > 0, x, 1)), 0).sum(-1) for x in (m, p)]
    between = entropy[0] - (entropy[1][:, None] + entropy[1][None]) / 2
    expected = minimum_spanning_tree(np.triu(1 + between, 1)).sum() - (len(p) - 1)
    np.testing.assert_allclose(space.divergences_.sum(), expected, atol=1e-9)


@settings(deadline=None, max_examples=80)
@given(
    st.lists(st.lists(st.sampled_from([0, 0, 1, 2, 3]), min_size=3, max_size=3), min_size=1, max_size=14),
    st.data(),
)
def test_order_of_the_rows_does_not_matter(rows, data):
    rows = np.array(rows, float)
    order = data.draw(st.permutations(range(len(rows))))
    one, other = TopologicalSpace().fit(rows), TopologicalSpace().fit(rows[order])
    check_structure(one, rows)
    np.testing.assert_array_equal(one.vertices_[order], other.vertices_)
    for name in (
        "multiplicities_",
        "edges_",
        "divergences_",
        "mean_distances_",
        "vertex_heat_",
        "edge_heat_",
    ):
        np.testing.assert_array_equal(getattr(one, name), getattr(other, name), err_msg=name)
    np.testing.assert_array_equal(one.rows_.toarray(), other.rows_.toarray())


def test_equal_rows_are_one_vertex():
    rows = np.array([[0, 1, 1], [0, 0, 0], [2, 0, 2], [0, 2, 2], [0, 0.5, 0.5], [0, 0, 0], [1, 1, 0]])
    space = TopologicalSpace().fit(rows)
    check_structure(space, rows)
    assert sorted(space.multiplicities_.tolist()) == [1, 1, 3]
    assert space.vertices_[0] == space.vertices_[3] == space.vertices_[4]
    assert space.vertices_[1] == space.vertices_[5] == -1


@pytest.mark.parametrize("n_rows", [1, 2, 3, 40])
def test_all_rows_equal(n_rows):
    space = TopologicalSpace().fit(np.tile([0.2, 0, 0.8], (n_rows, 1)))
    assert space.vertices_.tolist() == [0] * n_rows and space.multiplicities_.tolist() == [n_rows]
    assert space.edges_.shape == (0, 2) and space.divergences_.shape == space.edge_heat_.shape == (0,)
    assert space.mean_distances_.tolist() == space.vertex_heat_.tolist() == [0]


@pytest.mark.parametrize("n_rows", [2, 3, 30])
def test_all_rows_disjoint(n_rows):
    """All pairs are at 1: the tree is the star around the first vertex, whose edges have the smallest end."""
    space = TopologicalSpace().fit(np.random.default_rng(0).permutation(np.eye(n_rows)))
    assert tree_edges(space) == [(0, k) for k in range(1, n_rows)]
    assert (space.divergences_ == 1).all()
    assert space.vertex_heat_.tolist() == ([0, 0] if n_rows == 2 else [1] + [0] * (n_rows - 1))


@pytest.mark.filterwarnings("error")
def test_entries_too_small_to_matter():
    """They become 0 beside the rest of their row, and then are none."""
    space = TopologicalSpace().fit([[1e-300, 1e300, 0], [0, 1, 0], [1, 2, 0], [1e-300, 0, 1e300]])
    assert space.vertices_[0] == space.vertices_[1] and space.rows_.nnz == 4
    between = slow_divergences(np.array([[0.0, 1.0]]), np.array([[1.0, 2.0]]))
    assert sorted(space.divergences_.tolist()) == [pytest.approx(between[0, 0]), 1]


def test_a_hub():
    """One row shares something with each other, which share nothing."""
    rows = np.concatenate([np.eye(20), np.ones((1, 20))])
    space = TopologicalSpace().fit(rows)
    hub = space.vertices_[-1]
    assert all(hub in edge for edge in tree_edges(space))
    assert space.vertex_heat_[hub] == 1 and space.vertex_heat_.sum() == 1


@pytest.mark.parametrize(("n_rows", "n_columns"), [(1, 0), (4, 0), (1, 3), (4, 3)])
def test_nothing_but_empty_rows(n_rows, n_columns):
    space = TopologicalSpace().fit(np.zeros((n_rows, n_columns)))
    assert space.vertices_.tolist() == [-1] * n_rows
    assert space.multiplicities_.shape == space.mean_distances_.shape == space.vertex_heat_.shape == (0,)
    assert space.edges_.shape == (0, 2) and space.rows_.shape == (0, n_columns)


def test_sparse_input_is_dense_input():
    rng = np.random.default_rng(1)
    rows = random_rows(rng, 40, 20)
    dense = TopologicalSpace().fit(rows)
    shuffled = sparse.csr_matrix(rows)
    for start, end in zip(shuffled.indptr[:-1], shuffled.indptr[1:], strict=True):
        order = start + rng.permutation(end - start)
        shuffled.indices[start:end], shuffled.data[start:end] = shuffled.indices[order], shuffled.data[order]
    shuffled.has_sorted_indices = False
    for form in (sparse.csr_matrix(rows), sparse.csc_array(rows), sparse.coo_matrix(rows), shuffled):
        space = TopologicalSpace().fit(form)
        np.testing.assert_array_equal(space.edges_, dense.edges_)
        np.testing.assert_array_equal(space.divergences_, dense.divergences_)


def test_a_tree_can_be_had():
    """The matrices with which the other tests build trees of their choice do so."""
    rng = np.random.default_rng(5)
    edges = random_tree(rng, 50)
    rows = rows_of_tree(edges, rng.integers(1, 3, 50).tolist())
    space = TopologicalSpace().fit(rows)
    vertex_of = [space.vertices_[np.flatnonzero(rows[:, [k]].toarray().ravel())[0]] for k in range(50)]
    expected = sorted(tuple(sorted((vertex_of[a], vertex_of[b]))) for a, b in edges)
    assert tree_edges(space) == expected


@pytest.mark.parametrize("bad", [-1.0, np.nan, np.inf])
def test_bad_input(bad):
    with pytest.raises(ValueError, match=r"Negative values|contains NaN|contains infinity"):
        TopologicalSpace().fit([[1.0, 2.0], [bad, 1.0]])
    with pytest.raises(ValueError, match="minimum of 1 is required"):
        TopologicalSpace().fit(np.empty((0, 3)))
    with pytest.raises(ValueError, match="Expected 2D array"):
        TopologicalSpace().fit([1.0, 2.0])


@given(st.integers(0, 10**6), st.integers(2, 30))
@settings(deadline=None, max_examples=40)
def test_beyond_a_size_the_tree_is_that_of_a_sample(seed, max_vertices):
    rng = np.random.default_rng(seed)
    rows = rng.dirichlet(np.full(6, 0.3), int(rng.integers(1, 60)))
    rows[rows < 0.02] = 0
    exact, space = TopologicalSpace().fit(rows), TopologicalSpace(max_vertices).fit(rows)
    n = len(exact.multiplicities_)
    np.testing.assert_array_equal(space.vertices_, exact.vertices_)
    if n <= max_vertices:
        np.testing.assert_array_equal(space.edges_, exact.edges_)
        return
    # A tree of all, in which each vertex beyond the sample hangs on its nearest in the sample.
    assert len(space.edges_) == n - 1 and len(components(space.edges_.tolist(), n)) == 1
    sample = set(sampled(draws(space.rows_), max_vertices).tolist())
    divergences = jensen_shannon_divergences(space.rows_)
    of_edges = divergences[tuple(space.edges_.T)]
    np.testing.assert_allclose(space.divergences_, of_edges, atol=1e-9)
    for vertex in set(range(n)) - sample:
        [hangs_on] = [set(edge) - {vertex} for edge in space.edges_.tolist() if vertex in edge]
        assert hangs_on <= sample
        nearest = divergences[vertex, sorted(sample)].min()
        assert divergences[vertex, hangs_on.pop()] <= nearest + 1e-9
    inner = TopologicalSpace().fit(space.rows_[sorted(sample)])
    within = [i for i, edge in enumerate(space.edges_.tolist()) if set(edge) <= sample]
    np.testing.assert_allclose(np.sort(space.divergences_[within]), np.sort(inner.divergences_), atol=1e-9)
    # Whatever the order of the rows.
    order = rng.permutation(len(rows))
    other = TopologicalSpace(max_vertices).fit(rows[order])
    np.testing.assert_array_equal(other.edges_, space.edges_)
    np.testing.assert_array_equal(other.vertices_, space.vertices_[order])


def test_a_sample_follows_how_frequent_rows_are():
    rng = np.random.default_rng(0)
    rows = csr_matrix(rng.dirichlet(np.ones(20), 4000))
    drawn = draws(rows)
    assert len(np.unique(drawn)) > 3990 and (drawn >= 0).all() and (drawn < 2**32).all()
    order = rng.permutation(4000)
    np.testing.assert_array_equal(draws(csr_matrix(rows[order])), drawn[order])
    chosen = sampled(drawn, 1000)
    assert len(chosen) == 1000 and (np.diff(chosen) > 0).all()
    # Of what lies on either side of a plane, a quarter each, but for chance.
    side = np.asarray(rows[:, 0].todense()).ravel() > 0.05
    assert abs(side[chosen].mean() - side.mean()) < 0.05
    # What last bits differ in is the same.
    shaken = rows.copy()
    shaken.data *= 1 + 1e-12 * rng.normal(size=rows.nnz)
    assert (draws(shaken) == drawn).mean() > 0.999

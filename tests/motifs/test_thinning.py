"""Prototypes of many constellations: a sample, what is new beside it, and what they stand for."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from shapeconcepts import MotifHierarchyEnsemble
from shapeconcepts.motifs.propagation import decompose_object, propagate
from shapeconcepts.motifs.thinning import Thinning, draws

RESOLUTION = 0.05
NEW = 2 * RESOLUTION


def squared_hellinger(p: np.ndarray, q: np.ndarray) -> float:
    if not p.any() or not q.any():
        return 0.0 if not p.any() and not q.any() else 1.0
    return 1 - float(np.sqrt(p.astype(float) * q.astype(float)).sum())


def thinned_slowly(histograms: np.ndarray, n_known: int, n_most: int) -> tuple[list[int], list[float]]:
    """What is kept, and for each the divergence to the nearest that is kept."""
    by_draw = sorted(range(len(histograms)), key=lambda i: (draws(histograms[i : i + 1])[0], i))
    known = list(range(n_known)) or by_draw[:n_most]
    new: list[int] = []
    for one in by_draw:
        is_far = all(squared_hellinger(histograms[one], histograms[k]) > NEW for k in known + new)
        room = max(2 * n_most - len(known), n_most // 4)
        if one not in known and is_far and len(new) < room:
            new.append(one)
    kept = sorted(known + new)
    return kept, [min(squared_hellinger(h, histograms[k]) for k in kept) for h in histograms]


@st.composite
def many_histograms(draw) -> np.ndarray:
    n, seed = draw(st.integers(1, 60)), draw(st.integers(0, 2**32 - 1))
    rng = np.random.default_rng(seed)
    histograms = rng.dirichlet(np.full(6, draw(st.sampled_from([0.05, 1.0, 50.0]))), n)
    histograms[rng.random(n) < draw(st.sampled_from([0.0, 0.2]))] = 0
    copies = rng.integers(0, n, draw(st.integers(0, 20)))
    return np.concatenate([histograms, histograms[copies]]).astype(np.float32)


@settings(deadline=None, max_examples=80)
@given(many_histograms(), st.integers(1, 30), st.booleans())
def test_thinning_agrees_with_a_slow_one(histograms, n_most, has_known):
    n_known = min(n_most, len(histograms)) if has_known else 0
    found = Thinning.of(histograms, n_known, n_most, RESOLUTION)
    kept, nearest = thinned_slowly(histograms, n_known, n_most)
    assert found.kept.tolist() == kept
    behind = found.kept[found.stands_for]
    assert (behind[found.kept] == found.kept).all()
    apart = [squared_hellinger(a, histograms[b]) for a, b in zip(histograms, behind, strict=True)]
    is_kept = np.isin(np.arange(len(histograms)), kept)
    for one, nearest_one, itself in zip(apart, nearest, is_kept, strict=True):
        # Near enough, or as near as any is where no more can be kept.
        assert itself or one <= max(NEW, nearest_one) + 1e-5


def test_the_order_of_prototypes_does_not_matter():
    rng = np.random.default_rng(0)
    histograms = rng.dirichlet(np.full(8, 0.3), 500).astype(np.float32)
    found, order = Thinning.of(histograms, 0, 60, RESOLUTION), rng.permutation(500)
    again = Thinning.of(histograms[order], 0, 60, RESOLUTION, n_jobs=2)
    np.testing.assert_array_equal(np.sort(order[again.kept]), found.kept)
    stands_for = np.empty(500, np.int64)
    stands_for[order] = order[again.kept[again.stands_for]]
    np.testing.assert_array_equal(stands_for, found.kept[found.stands_for])
    # Neither the last bits nor anything but the prototypes themselves.
    wiggled = Thinning.of(histograms * np.float32(1 + 1e-7), 0, 60, RESOLUTION)
    assert len(np.setxor1d(wiggled.kept, found.kept)) <= 2


def test_a_sample_follows_how_frequent_prototypes_are():
    rng = np.random.default_rng(0)
    flat, steep = np.linspace(1, 2, 16), np.linspace(0, 3, 16)
    histograms = np.concatenate([rng.dirichlet(50 * flat, 3000), rng.dirichlet(50 * steep + 1, 1000)])
    kept = Thinning.of(histograms.astype(np.float32), 0, 1000, 0.9).kept
    assert len(kept) == 1000
    assert 690 < (kept < 3000).sum() < 810


def test_what_is_rare_is_kept():
    rng = np.random.default_rng(0)
    often = rng.dirichlet(500 * np.array([1, 1, 1, 1, 0.01, 0.01, 0.01, 0.01]), 2000)
    rare = rng.dirichlet(500 * np.array([0.01, 0.01, 0.01, 0.01, 1, 1, 1, 1]), 6)
    histograms = np.concatenate([often, rare]).astype(np.float32)
    found = Thinning.of(histograms, 0, 50, RESOLUTION)
    behind = found.kept[found.stands_for]
    assert (behind[2000:] >= 2000).all()
    assert (behind[:2000] < 2000).all()


def test_a_thinned_ensemble_knows_what_its_prototypes_stand_for(train, dictionary):
    whole = MotifHierarchyEnsemble(dictionary).fit(train)
    model = MotifHierarchyEnsemble(dictionary, max_columns=20).fit(train)
    known, everything = model.hierarchies_, whole.hierarchies_
    assert not everything.is_thinned
    assert known.is_thinned
    assert 20 <= len(known.prototypes) <= 40
    assert known.prototype_counts.sum() == len(everything.prototypes)
    np.testing.assert_array_equal(known.support, everything.support)
    np.testing.assert_array_equal(known.object_histograms, everything.object_histograms)
    assert model.stimuli_.shape == (len(train), len(known.prototypes))
    names = whole.get_feature_names_out().tolist()
    assert set(model.get_feature_names_out()) <= set(names)

    thinning = Thinning.of(everything.prototypes, 0, 20, model.resolution)
    for position, behind in enumerate(thinning.kept):
        own = int(everything.prototype_objects[behind])
        objects = set(everything.prototype_objects[thinning.stands_for == position].tolist()) - {own}
        others = [one for one in known.prototype_others[position].tolist() if one >= 0]
        assert len(set(others)) == len(others) == min(len(objects), 3)
        assert set(others) <= objects


def test_rows_of_a_thinned_ensemble_are_those_of_its_prototypes(train, dictionary):
    model = MotifHierarchyEnsemble(dictionary, max_columns=20).fit(train)
    from_field = [
        dict(
            zip(
                *model.field_.rows.row((p.histograms, model.hierarchies_.activated(p.words), left_out)),
                strict=True,
            )
        )
        for left_out, p in enumerate(_propagations(model, train))
    ]
    for number, row in enumerate(from_field):
        found = dict(zip(*_entries(model.stimuli_, number), strict=True))
        assert set(found) == {column for column, stimulus in row.items() if stimulus >= 1e-4}
        assert found == pytest.approx({c: row[c] for c in found}, rel=1e-3)
    np.testing.assert_array_equal(model.stimuli_.data, model.stimuli_.data.astype(np.float16))


def test_learning_on_keeps_columns_and_adds_what_is_new(train, dictionary):
    model = MotifHierarchyEnsemble(dictionary, max_columns=20).fit(train[:16])
    names, before = model.get_feature_names_out().tolist(), model.stimuli_.copy()
    model.partial_fit(train[16:])
    assert model.get_feature_names_out()[: len(names)].tolist() == names
    whole = MotifHierarchyEnsemble(dictionary).fit(train)
    assert model.hierarchies_.prototype_counts.sum() == len(whole.hierarchies_.prototypes)
    np.testing.assert_array_equal(model.hierarchies_.support, whole.hierarchies_.support)
    assert model.stimuli_.shape == (len(train), len(model.columns_))
    assert (abs(model.stimuli_[:16, : len(names)] - before)).max() == 0
    # Of parts that are known already, nothing is new.
    n = len(model.columns_)
    assert len(model.partial_fit(train[:5]).columns_) == n


def test_learning_in_parts_that_are_not_thinned_before_is_learning_at_once(train, dictionary):
    at_once = MotifHierarchyEnsemble(dictionary, max_columns=60).fit(train)
    assert at_once.hierarchies_.is_thinned
    in_parts = MotifHierarchyEnsemble(dictionary, max_columns=60).fit(train[:5])
    assert not in_parts.hierarchies_.is_thinned
    in_parts.partial_fit(train[5:])
    np.testing.assert_array_equal(in_parts.hierarchies_.prototypes, at_once.hierarchies_.prototypes)
    assert abs(in_parts.stimuli_ - at_once.stimuli_).max() == 0


def _propagations(model, objects):
    return propagate([decompose_object(one) for one in objects], model.dictionary_)


def _entries(rows, number):
    part = slice(rows.indptr[number], rows.indptr[number + 1])
    return rows.indices[part].tolist(), rows.data[part].tolist()


def test_an_explanation_says_what_a_prototype_stands_for(train, dictionary, new):
    model = MotifHierarchyEnsemble(dictionary, max_columns=10).fit(train)
    known = model.hierarchies_
    found = [p for one in new for motif in model.explain(one).motifs for p in motif.closest]
    assert any(prototype.count > 1 for prototype in found)
    names = list(known.object_names)
    for prototype in found:
        assert len(prototype.others) < prototype.count
        assert prototype.object_name not in prototype.others
        assert set(prototype.others) <= set(names)

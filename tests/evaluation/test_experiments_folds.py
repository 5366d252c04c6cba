"""Folds of the cross-validation."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from shapeconcepts.evaluation.experiments.folds import stratified_folds


@given(counts=st.lists(st.integers(2, 12), min_size=2, max_size=4), seed=st.integers(0, 100))
def test_every_object_is_left_out_once_and_labels_keep_their_share(counts: list[int], seed: int) -> None:
    labels = np.repeat([f"label {i}" for i in range(len(counts))], counts)
    folds = stratified_folds(labels, 5, seed)
    assert len(folds) == min(5, *counts)
    assert sorted(np.concatenate([left_out for _, left_out in folds])) == list(range(len(labels)))
    for fitted, left_out in folds:
        assert sorted([*fitted, *left_out]) == list(range(len(labels)))
        assert set(labels[fitted]) == set(labels)
        for label, count in zip(np.unique(labels), counts, strict=True):
            assert abs((labels[left_out] == label).sum() - count / len(folds)) < 1 + 1e-9


def test_instances_stay_together() -> None:
    labels = np.repeat(["can", "box"], 12)
    instances = np.array([f"{label}/{i // 3 % 4}" for i, label in enumerate(labels)])
    folds = stratified_folds(labels, 5, 0, instances)
    assert len(folds) == 4
    for fitted, left_out in folds:
        assert not set(instances[fitted]) & set(instances[left_out])
        assert set(labels[left_out]) == {"can", "box"}


def test_a_label_with_one_instance_is_allowed() -> None:
    labels = np.repeat(["can", "box"], 6)
    instances = np.array([*(["can/0"] * 6), *(f"box/{i}" for i in range(6))])
    folds = stratified_folds(labels, 5, 0, instances)
    assert len(folds) == 2
    assert all(len(set(instances[fitted]) & set(instances[left_out])) == 0 for fitted, left_out in folds)

"""Numbers of concepts over time, against the filtration graph."""

import networkx as nx
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from shapeconcepts.concepts import Filtration
from shapeconcepts.evaluation.experiments import concept_numbers
from shapeconcepts.evaluation.experiments.concept_numbers import ConceptNumbers

pytestmark = pytest.mark.filterwarnings("ignore:the filtration of")


def filtration(seed: int, n_objects: int) -> Filtration:
    """Of sparse rows, some of which are equal or empty."""
    rng = np.random.default_rng(seed)
    rows = rng.random((n_objects, 8)) * (rng.random((n_objects, 8)) < 0.4)
    return Filtration(2).fit(rows[rng.integers(0, n_objects, n_objects)])


def numbers_of_graph(filtration: Filtration, times: np.ndarray, min_size: int) -> list[int]:
    """Components of the filtration graph at each time, by networkx."""
    graph = filtration.graph()
    numbers = []
    for time in times:
        present = nx.Graph(edge[:2] for edge in graph.edges(data="time") if edge[2] <= time)
        present.add_nodes_from(graph)
        sizes = [
            sum(len(graph.nodes[vertex]["objects"]) for vertex in component)
            for component in nx.connected_components(present)
        ]
        numbers.append(sum(size >= min_size for size in sizes))
    return numbers


@settings(max_examples=40, deadline=None)
@given(seed=st.integers(0, 10_000), n_objects=st.integers(2, 25), min_size=st.integers(2, 5))
def test_numbers_are_those_of_the_filtration_graph(seed: int, n_objects: int, min_size: int) -> None:
    filtered = filtration(seed, n_objects)
    numbers = ConceptNumbers.of(filtered)
    assert numbers.times.tolist() == sorted(set(filtered.times_.tolist()))
    assert numbers.at_least(min_size).tolist() == numbers_of_graph(filtered, numbers.times, min_size)


@settings(max_examples=60, deadline=None)
@given(
    seed=st.integers(0, 10_000),
    n_objects=st.integers(2, 25),
    min_size=st.integers(2, 4),
    number=st.integers(1, 8),
)
def test_time_of_a_number_is_the_latest(seed: int, n_objects: int, min_size: int, number: int) -> None:
    filtered = filtration(seed, n_objects)
    time = ConceptNumbers.of(filtered).time_of(number, min_size)
    times = np.unique(filtered.times_)
    of_graph = dict(zip(times.tolist(), numbers_of_graph(filtered, times, min_size), strict=True))
    if max(of_graph.values(), default=0) < number or of_graph[times[-1]] > number:
        assert time is None
    elif number in of_graph.values():
        # The end of the filtration passes every number from its peak to what is left.
        assert time is not None
        assert of_graph[time] <= number
        assert all(other < number for later, other in of_graph.items() if later > time)
        assert len(filtered.groups_at(time, min_size)) == of_graph[time]


def test_a_number_that_is_skipped_gives_the_time_after_it() -> None:
    numbers = ConceptNumbers(
        np.array([0.2, 0.5, 1.0]), [np.array([2, 2, 2, 3]), np.array([5, 4]), np.array([9])]
    )
    assert numbers.time_of(4, 2) == 0.2
    assert numbers.time_of(3, 2) == 0.5
    assert numbers.time_of(2, 2) == 0.5
    assert numbers.time_of(1, 2) == 1.0
    assert numbers.time_of(5, 2) is None
    assert numbers.time_of(1, 3) == 1.0
    assert numbers.time_of(2, 3) == 0.5


def test_very_many_times_are_thinned(monkeypatch: pytest.MonkeyPatch) -> None:
    filtered = filtration(3, 25)
    everything = ConceptNumbers.of(filtered)
    monkeypatch.setattr(concept_numbers, "_MOST_TIMES", 5)
    some = ConceptNumbers.of(filtered)
    assert len(everything.times) > len(some.times) == 5
    assert some.times[[0, -1]].tolist() == everything.times[[0, -1]].tolist()

"""Evaluations made up for tests of figures and pages: plausible, and at the edges of what there can be."""

from collections.abc import Sequence

import numpy as np

from shapeconcepts.evaluation.metrics import GroupingScores
from shapeconcepts.evaluation.results import (
    BaselineRow,
    ClassificationRow,
    ConceptBar,
    Evaluation,
    FiltrationResult,
    HiddenPartsResult,
    HiddenPartsRow,
    LevelsResult,
    MapResult,
    SelectionResult,
    SupervisedResult,
)

SEVEN = ["amphora", "ball", "box", "can", "plate", "sack", "teddy"]
TWENTY = [f"category {chr(ord('a') + i)}" for i in range(20)]
LONG = ["a box of breakfast cereals, 500 g, opened, lying on its side " * 2, "can", "x" * 300]
HOSTILE = [
    "<script>alert(1)</script>",
    "$x^2$ & $\\frac{",
    "_hidden",
    "\"><img src=x onerror='alert(1)'>",
    "--><!-- ]]>",
    "new\nline\ttab",
    "",
    "\x1b[31m \x01\x9b \udcff \u202e \ufffe",
]


def scores(level: float, n_groups: int = 30) -> GroupingScores:
    level = min(max(level, 0.0), 1.0)
    return GroupingScores(n_groups, level, level**3, level**0.5, level**1.5, 0.8 * level, 0.9 * level)


NO_GROUPS = GroupingScores(0, np.nan, np.nan, 0.0, 0.0, 0.0, 0.1)


def filtration(n: int = 348, random_state: int = 0) -> FiltrationResult:
    random = np.random.default_rng(random_state)
    deaths = np.sort(np.round(random.beta(4, 4, n - 1), 3))
    ends = np.arange(1, 51) / 50
    counts = np.histogram(deaths, bins=np.concatenate([[0], ends]))[0]
    times = np.unique(deaths)
    shape = np.round(60 * np.exp(-(((times - 0.45) / 0.2) ** 2))).astype(np.int64)
    diagram = np.stack([np.zeros(n), np.append(deaths, np.inf)], axis=1)
    return FiltrationResult(diagram, ends, counts, 0.48, 0.61, times, np.maximum(shape, 1))


def one_object() -> FiltrationResult:
    """No annexation, no time to stop."""
    none = np.zeros(0)
    counts = np.zeros(0, dtype=np.int64)
    return FiltrationResult(np.array([[0.0, np.inf]]), none, counts, None, None, none, counts)


def bars(labels: Sequence[str], n: int, random: np.random.Generator) -> list[ConceptBar]:
    made = []
    for _ in range(n):
        size = int(2 + random.geometric(0.15))
        votes = random.choice(len(labels), size, p=random.dirichlet(np.full(len(labels), 0.08)))
        shares = np.bincount(votes, minlength=len(labels)) / size
        order = [int(i) for i in np.argsort(-shares, kind="stable") if shares[i] > 0]
        proportions = {labels[i]: float(shares[i]) for i in order}
        top = max(proportions.values())
        made.append(ConceptBar(size, top, size / (1 - top + 1e-3), proportions))
    return sorted(made, key=lambda bar: bar.rank_score)


def errors(labels: Sequence[str], repetitions: int, random: np.random.Generator) -> dict[str, list[float]]:
    return {
        label: np.round(random.beta(1, 12, repetitions), 3).tolist() if i % 3 else [0.0] * repetitions
        for i, label in enumerate(labels)
    }


def supervised(labels: Sequence[str], repetitions: int, random: np.random.Generator) -> SupervisedResult:
    numbers, sizes = np.arange(2, 81, 3), np.arange(2, 11)
    grid = numbers[:, None] / 80
    purity = np.clip(0.35 + 0.6 * grid**0.4 - 0.01 * sizes + random.normal(0, 0.015, (27, 9)), 0, 1)
    unreachable = numbers[:, None] * sizes > 300
    purity[unreachable] = np.nan
    error = np.clip(0.9 - 0.85 * purity + random.normal(0, 0.02, purity.shape), 0, 1)
    coverage = np.where(unreachable, np.nan, 0.9 - 0.03 * sizes)
    return SupervisedResult(
        numbers,
        sizes,
        purity,
        error,
        coverage,
        (68, 2),
        float(purity[22, 0]),
        float(error[22, 0]),
        float(coverage[22, 0]),
        0.52,
        errors(labels, repetitions, random),
        [(68, 2)] * repetitions,
        [scores(0.9, 68)] * repetitions,
    )


def concept_map(labels: Sequence[str], random: np.random.Generator, n: int = 600) -> MapResult:
    centres = random.normal(0, 10, (len(labels), 2))
    label = random.integers(len(labels), size=n)
    positions = centres[label] + random.normal(0, 3, (n, 2))
    grid_x = np.linspace(positions[:, 0].min(), positions[:, 0].max(), 60)
    grid_y = np.linspace(positions[:, 1].min(), positions[:, 1].max(), 60)
    cells = np.stack(np.meshgrid(grid_x, grid_y), axis=-1)
    distance = np.linalg.norm(cells[:, :, None] - centres, axis=-1)
    nearest = distance.argmin(axis=-1)
    share = np.clip(1.3 - distance.min(axis=-1) / 15, 0.2, 1)
    votes = random.dirichlet(np.full(len(labels), 0.2), len(labels)) + 2 * np.eye(len(labels))
    table = votes / votes.sum(axis=1, keepdims=True)
    right = {label: float(random.uniform(0.5, 1)) for label in labels}
    sets = np.array(["simulated", "restaurant", "OSD"])
    return MapResult(
        positions,
        sets[random.integers(3, size=n)],
        np.array(labels)[label],
        grid_x,
        grid_y,
        np.array(labels)[nearest],
        share,
        30,
        list(labels),
        table,
        table.T / table.sum(axis=0)[:, None],
        {str(name): dict(right) for name in sets},
        {"OSD": dict(list(right.items())[:2])},
        {"OSD": 2},
    )


def evaluation(labels: Sequence[str] = SEVEN, repetitions: int = 5, random_state: int = 0) -> Evaluation:
    """As it comes out of a run with everything asked for."""
    random = np.random.default_rng(random_state)

    def repeated(level: float, n_groups: int = 30) -> list[GroupingScores]:
        return [scores(level + step, n_groups) for step in random.normal(0, 0.015, repetitions)]

    selections = [
        SelectionResult(
            preset,
            repeated(level, n),
            errors(labels, repetitions, random),
            bars(labels, n, random),
            filtration(),
            3,
        )
        for preset, level, n in (("default", 0.93, 34), ("paper", 0.81, 22))
    ]
    baselines = [
        BaselineRow(
            representation,
            grouping,
            [{"n_clusters": int(random.integers(7, 40))} for _ in range(repetitions)],
            repeated(random.uniform(0.6, 0.97)),
        )
        for representation in ("mean FPFH", "surflet histogram", "ESF", "stimuli")
        for grouping in ("average linkage", "HDBSCAN", "k-means")
    ]
    return Evaluation(
        data_name="seven shapes",
        n_objects=462,
        labels={label: 66 for label in labels},
        skipped=[("scans/broken.pcd", "has no points")],
        repetitions=repetitions,
        selections=selections,
        levels=LevelsResult(
            [1, 2, 3, 4, 5, 6],
            [repeated(0.5 + 0.4 * (1 - 2.0**-n)) for n in range(1, 7)],
            [(0.4 * 2.0**-n + random.uniform(0, 0.05, repetitions)).tolist() for n in range(1, 7)],
        ),
        supervised=supervised(labels, repetitions, random),
        map=concept_map(labels, random),
        baselines=baselines,
        classifications=[
            ClassificationRow(name, errors(labels, repetitions, random))
            for name in ("motif stimuli, default", "motif stimuli, paper", "mean FPFH", "surflet histogram")
        ],
        seconds={"unsupervised": 12.3, "supervised": 75.0, "map": 4.2},
        versions={"shapeconcepts": "0.1.0", "numpy": "2.1.0"},
        command="shapeconcepts evaluate --report evaluation.html",
        hidden=HiddenPartsResult(
            [
                HiddenPartsRow(
                    "our concepts", [0.01] * repetitions, [0.12] * repetitions, [0.23] * repetitions
                ),
                HiddenPartsRow(
                    "histograms", [0.02] * repetitions, [0.34] * repetitions, [0.45] * repetitions
                ),
            ]
        ),
    )


def nothing_found() -> Evaluation:
    """No concepts in any repetition, and nothing but the selection asked for."""
    selection = SelectionResult("default", [NO_GROUPS], {"box": [1.0]}, [], one_object(), 0)
    return Evaluation(
        "one box",
        1,
        {"box": 1},
        [],
        1,
        [selection],
        None,
        None,
        None,
        [],
        [],
        {},
        {},
        "shapeconcepts evaluate",
    )

"""How good concepts of simulated scans must stay: what they were when the rule was made, less 0.03."""

from shapeconcepts import ShapeConceptModel, datasets
from shapeconcepts.evaluation import grouping_scores

EXPLAINED, INFORMATION = 0.914, 0.856


def test_concepts_are_as_good_as_they_were():
    scans = datasets.simulate(n_per_category=30, random_state=2)
    model = ShapeConceptModel().fit(scans)
    scores = grouping_scores(model.labels_, [scan.label for scan in scans])
    assert scores.explained > EXPLAINED - 0.03
    assert scores.adjusted_mutual_information > INFORMATION - 0.03

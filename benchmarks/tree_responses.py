"""How well a classifier tells labels apart by responses of concepts, of the whole tree, and by histograms.

    python benchmarks/tree_responses.py [--only SET ...] [--seeds SEED ...] [--splits N] [--scale metric]

Error of a support vector machine on the 25 % that were not learned from, in percent, averaged over labels:
on the responses of concepts, on those of groups within groups (`transform_tree`), and on whole-object
histograms of the same descriptor. Means over splits; all views of a mesh are on one side.
"""

import os

os.environ["OMP_NUM_THREADS"] = "1"

import warnings

import numpy as np

from common import command, described, print_table
from concept_scores import SETS, scans_by_set
from hidden_parts import instances_of
from shapeconcepts import ShapeConceptModel
from shapeconcepts.descriptors.registry import DEFAULT
from shapeconcepts.evaluation import mean_error_over_labels, svm_predictions
from shapeconcepts.evaluation.experiments.concept_responses import ResponseDistances
from shapeconcepts.evaluation.splits import stratified_splits

ALL_SETS = (*SETS, "household_meshes", "atwork_parts")
SEEDS = (400, 401, 402)
DESCRIPTOR_OF_SCALE = {"relative": DEFAULT, "metric": f"{DEFAULT}+distance"}


def main() -> None:
    parser = command(__doc__)
    parser.add_argument("--only", nargs="+", choices=ALL_SETS, default=ALL_SETS, metavar="SET")
    parser.add_argument("--seeds", nargs="+", type=int, default=SEEDS, metavar="SEED")
    parser.add_argument("--splits", type=int, default=5, metavar="N")
    parser.add_argument("--scale", choices=DESCRIPTOR_OF_SCALE, default="relative")
    options = parser.parse_args()
    warnings.simplefilter("ignore")
    descriptor = DESCRIPTOR_OF_SCALE[options.scale]
    table = []
    for name, scans in scans_by_set(parser, options.only, options.seeds).items():
        objects = described(scans, descriptor)
        labels = np.array([one.label for one in objects])
        whole = np.array([one.description.whole() for one in objects])
        errors = []
        splits = stratified_splits(
            labels, options.splits, random_state=0, instances=instances_of(name, objects)
        )
        for training, new in splits:
            model = ShapeConceptModel().fit([objects[i] for i in training])
            some = [objects[i] for i in new]
            of_concepts = ResponseDistances.of(model, model.stimuli(some)).responses(model.labels_)
            of_tree = model.transform_tree(), model.transform_tree(some)
            told = [
                svm_predictions(of_concepts[0], labels[training], of_concepts[1], "response"),
                svm_predictions(of_tree[0], labels[training], of_tree[1], "response"),
                svm_predictions(whole[training], labels[training], whole[new], "histogram"),
            ]
            groups = [of_concepts[0].shape[1], of_tree[0].shape[1] // 2]
            errors.append([*groups, *(100 * mean_error_over_labels(labels[new], one)[1] for one in told)])
        n_concepts, n_groups, *means = np.mean(errors, axis=0)
        table.append([name, f"{n_concepts:.0f}", f"{n_groups:.0f}", *(f"{mean:.1f}" for mean in means)])
        print(*table[-1], flush=True)
    print()
    print_table(("set", "concepts", "groups", "SVM on concepts", "on the tree", "on histograms"), table)


if __name__ == "__main__":
    main()

"""The motif hierarchy ensemble keeps scikit-learn's contract, as far as it holds for objects."""

import pickle
from collections.abc import Callable

import joblib
import numpy as np
import pytest
import sklearn
from motif_objects import MotifColumns, assert_same_rows, assert_unchanged, snapshot
from scipy.sparse import csr_matrix
from sklearn.base import clone
from sklearn.exceptions import NotFittedError
from sklearn.utils.validation import check_is_fitted

from shapeconcepts import DescribedObject, MotifHierarchyEnsemble, SegmentDictionary, ShapeConceptModel
from shapeconcepts.motifs.ensemble import COLUMNS
from shapeconcepts.motifs.prototype_stimuli import PrototypeField
from shapeconcepts.motifs.stimuli import MotifField

pytestmark = pytest.mark.filterwarnings("ignore:.*different segment descriptions give")

every_kind_of_columns = pytest.mark.parametrize("columns", COLUMNS)

# For each parameter, a value that is not its default and changes what is learned, or the rows.
OTHER = {
    "columns": "motifs",
    "n_neighbours": 2,
    "resolution": 0.3,
    "max_columns": 20,
    "width": 0.7,
    "bandwidth": 0.5,
    "leave_own_out": False,
    "min_support": 1,
    "dictionary__n_levels": 4,
    "dictionary__metric": "euclidean",
}


def given() -> dict[str, object]:
    """A value of each parameter that nothing else is equal to."""
    return {
        "dictionary": SegmentDictionary(np.int64(3)),
        "columns": "".join(["mot", "ifs"]),
        "n_neighbours": np.int16(7),
        "resolution": np.float32(0.02),
        "max_columns": np.int32(30),
        "width": np.float32(0.3),
        "bandwidth": 1,
        "leave_own_out": np.bool_(False),
        "min_support": np.int64(1),
        "n_occlusions": np.int64(1),
        "n_jobs": np.int64(1),
    }


class Answers:
    """All that a fitted ensemble says: about what it was fitted to, and about new objects."""

    def __init__(self, ensemble: MotifHierarchyEnsemble, new: list[DescribedObject]) -> None:
        self.stimuli = ensemble.stimuli_.copy()
        self.rows = ensemble.transform(new)
        self.explanations = [ensemble.explain(one) for one in new[:3]]
        self.names = ensemble.get_feature_names_out().tolist()
        self.columns = ensemble.columns_.tolist()

    def assert_same(self, other: "Answers") -> None:
        assert_same_rows(self.stimuli, other.stimuli)
        assert_same_rows(self.rows, other.rows)
        assert self.explanations == other.explanations
        assert (self.names, self.columns) == (other.names, other.columns)


def test_parameters_are_stored_as_given(train):
    parameters = given()
    ensemble = MotifHierarchyEnsemble(**parameters)
    for state in (ensemble, ensemble.fit(train), ensemble.partial_fit(train)):
        stored = state.get_params(deep=False)
        assert stored.keys() == parameters.keys()
        for name, value in parameters.items():
            assert stored[name] is value and getattr(state, name) is value, name
    assert not hasattr(parameters["dictionary"], "words_")


def test_making_one_checks_nothing():
    """Parameters are checked when something is learned: a grid can be written down before."""
    wrong = MotifHierarchyEnsemble(3, "words", 0, -1, "a", None, 0, "all")
    assert wrong.get_params(deep=False)["columns"] == "words"
    assert clone(MotifHierarchyEnsemble(columns="words")).columns == "words"


def test_parameters_of_the_default_dictionary_can_be_read_and_set(train):
    ensemble = MotifHierarchyEnsemble()
    assert ensemble.dictionary is None
    defaults = {f"dictionary__{name}": value for name, value in SegmentDictionary().get_params().items()}
    assert ensemble.get_params().items() >= {"dictionary": None, **defaults}.items()
    assert not any("__" in name for name in ensemble.get_params(deep=False))
    assert ensemble.set_params(dictionary__n_levels=4) is ensemble
    assert (ensemble.dictionary.n_levels, ensemble.dictionary.metric) == (4, "hellinger")
    assert ensemble.get_params()["dictionary__n_levels"] == 4
    assert ensemble.set_params(dictionary__metric="euclidean").dictionary.n_levels == 4
    assert ensemble.fit(train).hierarchies_.n_levels == len(ensemble.dictionary_.words_) == 4
    # Two ensembles share no dictionary that is only a default.
    assert MotifHierarchyEnsemble().set_params(dictionary__n_levels=3).dictionary is not ensemble.dictionary
    assert MotifHierarchyEnsemble().get_params()["dictionary__n_levels"] == 2


def test_parameters_and_their_dictionary_are_set_in_any_order():
    new = SegmentDictionary(1, "euclidean")
    for ensemble in (MotifHierarchyEnsemble(), MotifHierarchyEnsemble(SegmentDictionary(5))):
        ensemble.set_params(dictionary__n_levels=4, dictionary=new)
        assert ensemble.dictionary is new and new.n_levels == 4
        # None is the default, whose parameters are set in the same call.
        ensemble.set_params(dictionary__n_levels=3, dictionary=None)
        assert ensemble.dictionary is not new and new.n_levels == 4
        assert (ensemble.dictionary.n_levels, ensemble.dictionary.metric) == (3, "hellinger")
        assert ensemble.set_params(dictionary=None).dictionary is None


@pytest.mark.parametrize("name", ["descriptor", "levels", "dictionary__levels", "columns__n"])
def test_unknown_parameters_are_refused(name):
    ensemble = MotifHierarchyEnsemble()
    before = ensemble.get_params(deep=False)
    with pytest.raises((ValueError, AttributeError)):
        ensemble.set_params(**{name: 1})
    assert {**ensemble.get_params(deep=False), "dictionary": None} == before
    with pytest.raises(TypeError):
        MotifHierarchyEnsemble(**{name: 1})


@every_kind_of_columns
def test_clone_has_the_parameters_and_nothing_learned(train, new, columns):
    ensemble = MotifHierarchyEnsemble(SegmentDictionary(3), columns, width=0.5, bandwidth=0.2, n_jobs=2)
    for state in (ensemble, ensemble.fit(train)):
        copied = clone(state)
        assert copied.dictionary is not state.dictionary
        parameters, expected = copied.get_params(), state.get_params()
        del parameters["dictionary"], expected["dictionary"]
        assert parameters == expected
        assert not [name for name in vars(copied) if name.endswith("_") or name.startswith("_")]
    Answers(ensemble, new).assert_same(Answers(clone(ensemble).fit(train), new))
    assert clone(MotifHierarchyEnsemble()).dictionary is None


@every_kind_of_columns
def test_nothing_is_answered_before_fit(train, columns):
    ensemble = MotifHierarchyEnsemble(columns=columns)
    questions: list[Callable[[], object]] = [
        lambda: ensemble.transform(train),
        lambda: ensemble.transform([]),
        lambda: ensemble.explain(train[0]),
        ensemble.get_feature_names_out,
        lambda: ensemble.stimuli_,
        lambda: ensemble.columns_,
        lambda: ensemble.field_,
        lambda: check_is_fitted(ensemble),
    ]
    for question in questions:
        with pytest.raises(NotFittedError, match="MotifHierarchyEnsemble instance is not fitted yet"):
            question()
    assert not any(hasattr(ensemble, name) for name in ("stimuli_", "columns_", "field_", "n_features_in_"))
    ensemble.fit(train)
    for question in questions:
        question()


@every_kind_of_columns
@pytest.mark.parametrize("leave_own_out", [True, False])
def test_fit_transform_gives_the_training_rows(train, columns, leave_own_out):
    ensemble = MotifHierarchyEnsemble(columns=columns, leave_own_out=leave_own_out)
    rows = ensemble.fit_transform(train, y=np.zeros(len(train)))
    assert isinstance(rows, csr_matrix)
    assert_same_rows(rows, ensemble.stimuli_)
    assert_same_rows(rows, clone(ensemble).fit(iter(train)).stimuli_)
    is_same = (rows != ensemble.transform(train)).nnz == 0
    assert is_same == (not leave_own_out)


@every_kind_of_columns
@pytest.mark.parametrize("asks", [True, False], ids=["asked", "not asked"])
@pytest.mark.parametrize("words", ["default", "not fitted", "fitted"])
def test_parameters_set_after_fit_change_nothing(dictionary, train, new, columns, asks, words):
    """Whether or not anything was asked, and so computed, before."""
    dictionaries = {
        "default": lambda: None,
        "not fitted": lambda: SegmentDictionary(3),
        "fitted": lambda: pickle.loads(pickle.dumps(dictionary)),
    }
    fresh = MotifHierarchyEnsemble(dictionaries[words](), columns).fit(train)
    expected, learned = Answers(fresh, new), snapshot(fresh.hierarchies_)
    ensemble = MotifHierarchyEnsemble(dictionaries[words](), columns).fit(train)
    if asks:
        Answers(ensemble, new).assert_same(expected)
    for name, value in {**OTHER, "columns": next(kind for kind in COLUMNS if kind != columns)}.items():
        ensemble.set_params(**{name: value})
        if asks:
            Answers(ensemble, new).assert_same(expected)
    Answers(ensemble, new).assert_same(expected)
    ensemble.set_params(bandwidth=-1, width="a", columns=3, n_neighbours=0, dictionary=5)
    Answers(ensemble, new).assert_same(expected)
    assert_unchanged(ensemble.hierarchies_, learned)
    assert (ensemble.n_features_in_, ensemble.dictionary_.n_features_in_) == (6, 6)


@pytest.mark.parametrize("name", OTHER)
@pytest.mark.parametrize("first", COLUMNS)
def test_parameters_set_after_fit_hold_for_the_next(train, new, name, first):
    ensemble = MotifHierarchyEnsemble(columns=first).fit(train)
    Answers(ensemble, new)
    ensemble.set_params(**{name: OTHER[name]})
    fresh = MotifHierarchyEnsemble(columns=first).set_params(**{name: OTHER[name]})
    Answers(ensemble.fit(train), new).assert_same(Answers(fresh.fit(train), new))


@every_kind_of_columns
def test_field_has_the_parameters_that_it_was_learned_with(train, columns):
    ensemble = MotifHierarchyEnsemble(
        columns=columns, n_neighbours=3, width=np.float32(0.5), bandwidth=1, min_support=3
    ).fit(train)
    ensemble.set_params(n_neighbours=4, width=0.1, bandwidth=0.2, min_support=1)
    field = ensemble.field_
    assert field is ensemble.field_ and field.hierarchies is ensemble.hierarchies_
    if columns == "prototypes":
        assert isinstance(field, PrototypeField)
        assert (field.n_neighbours, field.width) == (3, 0.5) and type(field.width) is float
        assert len(field.scales) == len(ensemble.columns_)
    else:
        assert isinstance(field, MotifField)
        assert field.bandwidth == 1 and type(field.bandwidth) is float
        np.testing.assert_array_equal(field.columns, ensemble.columns_)
        assert (ensemble.hierarchies_.support[field.columns] >= 3).all()
    ensemble.partial_fit(train)
    assert ensemble.field_ is not field
    if columns == "prototypes":
        assert (ensemble.field_.n_neighbours, ensemble.field_.width) == (4, 0.1)
    else:
        assert ensemble.field_.bandwidth == 0.2


def test_number_of_bins(train):
    ensemble = MotifHierarchyEnsemble().fit(train)
    assert ensemble.n_features_in_ == train[0].description.n_bins == ensemble.dictionary_.n_features_in_
    assert not hasattr(ensemble, "feature_names_in_")
    # Refused, new numbers of bins leave it as it was; learned, they replace it.
    other = [
        DescribedObject(type(one.description)(one.description.segment_histograms[:, :4]), one.segment_edges)
        for one in train
    ]
    with pytest.raises(ValueError, match=r"4 features.*6 features"):
        ensemble.partial_fit(other)
    with pytest.raises(ValueError, match=r"4 features.*6 features"):
        ensemble.transform(other)
    assert ensemble.n_features_in_ == 6
    assert ensemble.fit(other).n_features_in_ == 4


@every_kind_of_columns
def test_names_of_columns_are_unique(train, columns):
    ensemble = MotifHierarchyEnsemble(columns=columns, min_support=1).fit(train)
    for n_objects in (len(train), len(train) + 5):
        names = ensemble.get_feature_names_out()
        assert names.dtype == object and all(type(name) is str for name in names)
        assert len(set(names)) == len(names) == ensemble.stimuli_.shape[1]
        assert ensemble.stimuli_.shape[0] == n_objects
        np.testing.assert_array_equal(ensemble.get_feature_names_out(["a", "b"]), names)
        ensemble.partial_fit(train[:5])


@pytest.fixture(params=["pandas", "polars"])
def container(request) -> str:
    pytest.importorskip(request.param)
    return request.param


def assert_frame(frame: object, rows: csr_matrix, names: list[str]) -> None:
    assert type(frame).__name__ == "DataFrame"
    assert list(frame.columns) == names  # type: ignore[attr-defined]
    assert frame.shape == rows.shape  # type: ignore[attr-defined]
    np.testing.assert_array_equal(np.asarray(frame, np.float64), rows.toarray())


@every_kind_of_columns
def test_data_frames(train, new, columns, container):
    plain = MotifHierarchyEnsemble(columns=columns).fit(train)
    rows, names = plain.transform(new), plain.get_feature_names_out().tolist()
    ensemble = MotifHierarchyEnsemble(columns=columns).set_output(transform=container)
    assert_frame(ensemble.fit_transform(train), plain.stimuli_, names)
    assert_frame(ensemble.transform(new), rows, names)
    assert_frame(clone(ensemble).fit(train).transform(new), rows, names)
    assert_frame(ensemble.transform([]), rows[:0], names)
    # What is learned from stays sparse, and setting it back gives back what was.
    assert_same_rows(ensemble.stimuli_, plain.stimuli_)
    assert ensemble.explain(new[0]) == plain.explain(new[0])
    assert_same_rows(ensemble.set_output(transform="default").transform(new), rows)


@every_kind_of_columns
def test_data_frames_everywhere(train, new, columns, container):
    """Also where scikit-learn is told so for all estimators: the dictionary, and the model's stages."""
    plain = MotifHierarchyEnsemble(columns=columns).fit(train)
    rows, names = plain.transform(new), plain.get_feature_names_out().tolist()
    objects = train * 2 + new * 2
    whole = ShapeConceptModel(ensemble=clone(plain)).fit(objects)
    with sklearn.config_context(transform_output=container):
        ensemble = clone(plain).fit(train)
        assert_frame(ensemble.transform(new), rows, names)
        assert ensemble.explain(new[0]) == plain.explain(new[0])
        model = ShapeConceptModel(ensemble=clone(plain)).fit(objects)
        responses, stimuli, predicted = model.transform(new), model.stimuli(new), model.predict(new)
    np.testing.assert_array_equal(np.asarray(responses), whole.transform(new))
    assert_same_rows(stimuli, whole.stimuli(new))
    np.testing.assert_array_equal(predicted, whole.predict(new))
    of_dictionary = MotifHierarchyEnsemble(SegmentDictionary().set_output(transform=container), columns)
    Answers(of_dictionary.fit(train), new).assert_same(Answers(plain, new))


def test_single_object_is_told_to_be_wrapped(dictionary, train):
    fitted = MotifHierarchyEnsemble(dictionary).fit(train)
    for call in (MotifHierarchyEnsemble().fit, MotifHierarchyEnsemble().fit_transform, fitted.transform,
                 fitted.partial_fit, MotifHierarchyEnsemble().partial_fit):  # fmt: skip
        for one in (train[0], 5, None):
            message = rf"X must be a list, got a single {type(one).__name__}: wrap it in a list, \[X\]"
            with pytest.raises(ValueError, match=message):
                call(one)
    assert fitted.transform([train[0]]).shape == (1, len(fitted.columns_))
    # An explanation is of one object.
    with pytest.raises(ValueError, match="got list at position 0"):
        fitted.explain([train[0]])


@every_kind_of_columns
def test_jobs_and_backends_do_not_matter(train, new, columns):
    def answers(n_jobs: int | None) -> Answers:
        return Answers(MotifHierarchyEnsemble(columns=columns, n_jobs=n_jobs).fit(train), new)

    expected = answers(1)
    assert expected.rows.nnz > 20 and expected.stimuli.nnz > 20
    for n_jobs in (None, 2, -1):
        answers(n_jobs).assert_same(expected)
    for parameters in ({}, {"n_jobs": 2}, {"n_jobs": 3}):
        with joblib.parallel_config(backend="threading", **parameters):
            for n_jobs in (None, 1, 2):
                answers(n_jobs).assert_same(expected)


@every_kind_of_columns
def test_more_objects_than_a_chunk_in_several_jobs(dictionary, train, new, columns):
    many = [one for one in (*new, *train) for _ in range(8)]
    expected = MotifHierarchyEnsemble(dictionary, columns).fit(train).transform(many)
    for n_jobs in (2, 3):
        ensemble = MotifHierarchyEnsemble(dictionary, columns, n_jobs=n_jobs).fit(train)
        assert_same_rows(ensemble.transform(many), expected)
        # How many jobs there are is no matter of what was learned: it can be set at any time.
        assert_same_rows(ensemble.set_params(n_jobs=1).transform(many), expected)


def test_fit_gives_the_ensemble_itself_and_touches_no_object(train):
    before = pickle.dumps(train)
    ensemble = MotifColumns()
    assert ensemble.fit(train) is ensemble and ensemble.partial_fit(train) is ensemble
    ensemble.transform(train)
    assert pickle.dumps(train) == before

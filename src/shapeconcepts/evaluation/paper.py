"""The paper's own figures, to stand beside ours (section Experimental Evaluation)."""

from __future__ import annotations

from dataclasses import dataclass, field


@dataclass(frozen=True)
class PaperFigures:
    """What the paper reports of its Object Shape Category Dataset, shares from 0 to 1.

    Attributes
    ----------
    epsilon_max : float
        Time of most annexations.
    n_concepts : int
        Concepts at that time, of at least `min_concept_size` objects.
    min_concept_size : int
    mean_purity, pure_share : float
        Of these concepts: mean of equation 4, and the share in which it is 1.
    unsupervised_errors : dict of str to float
        Mean classification error of each label over 5 repetitions (table 1).
    supervised_number, supervised_size : int
        Number and minimum size of concepts that cross-validation chose.
    supervised_purity, supervised_error : float
        At that choice: mean purity, and cross-validation error.
    supervised_errors : dict of str to float
        Table 2.
    purity_with_five : float
        Mean purity of only five concepts.
    n_levels : int
        Levels of the dictionary.
    repetitions : int
    """

    epsilon_max: float = 0.48
    n_concepts: int = 36
    min_concept_size: int = 2
    mean_purity: float = 0.862
    pure_share: float = 0.57
    unsupervised_errors: dict[str, float] = field(
        default_factory=lambda: {
            "sack": 0.042,
            "can": 0.065,
            "box": 0.025,
            "teddy": 0.088,
            "ball": 0.0,
            "amphora": 0.104,
            "plate": 0.0,
        }
    )
    supervised_number: int = 68
    supervised_size: int = 2
    supervised_purity: float = 0.901
    supervised_error: float = 0.1479
    supervised_errors: dict[str, float] = field(
        default_factory=lambda: {
            "sack": 0.033,
            "can": 0.068,
            "box": 0.024,
            "teddy": 0.089,
            "ball": 0.0,
            "amphora": 0.107,
            "plate": 0.0,
        }
    )
    purity_with_five: float = 0.5
    n_levels: int = 4
    repetitions: int = 5

    @property
    def unsupervised_mean_error(self) -> float:
        """Mean over the labels of table 1."""
        return sum(self.unsupervised_errors.values()) / len(self.unsupervised_errors)

    @property
    def supervised_mean_error(self) -> float:
        """Mean over the labels of table 2."""
        return sum(self.supervised_errors.values()) / len(self.supervised_errors)


PAPER = PaperFigures()

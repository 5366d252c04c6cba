"""Parameters: what each may be stands once, in its estimator's `_parameter_constraints` (scikit-learn's)."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterable
from functools import cache
from numbers import Integral, Real
from typing import Any, ClassVar

import numpy as np
from sklearn.base import BaseEstimator, clone
from sklearn.utils._param_validation import (
    Interval,
    StrOptions,
    make_constraint,
    validate_parameter_constraints,
)


def whole_number(smallest: int, largest: int = 2**31 - 1) -> Interval:
    """Constraint: a whole number within bounds."""
    return Interval(Integral, smallest, largest, closed="both")


def positive_number() -> Interval:
    """Constraint: a finite number above 0."""
    return Interval(Real, 0, None, closed="neither")


def share() -> Interval:
    """Constraint: a number from 0 to 1."""
    return Interval(Real, 0, 1, closed="both")


def choice(*names: str) -> StrOptions:
    """Constraint: one of several names."""
    return StrOptions(set(names))


def check_parameters(estimator: Any) -> None:
    """Require the parameters of an estimator, and of those among them that are estimators, to be in range.

    Raises
    ------
    ValueError
        That names the first parameter that is not, its value, and what was expected.
    """
    for name, constraints, may_be_boolean in _constraints_of(estimator.__class__):
        value = getattr(estimator, name)
        # To Python, True is a whole number.
        is_sound = may_be_boolean or not isinstance(value, bool | np.bool_)
        if not (is_sound and any(constraint.is_satisfied_by(value) for constraint in constraints)):
            shown = value if is_sound else repr(value)
            validate_parameter_constraints(
                estimator._parameter_constraints, {name: shown}, type(estimator).__name__
            )
        for part in value if isinstance(value, tuple | list) else (value,):
            # Of its class: a frozen estimator answers for the one that it wraps.
            if hasattr(type(part), "_parameter_constraints"):
                check_parameters(part)


# Descriptors are checked with each object.
@cache
def _constraints_of(estimator: Hashable) -> list[tuple[str, list[Any], bool]]:
    """Name, constraints, and whether it may be true or false, of each parameter of a class."""
    stated = estimator._parameter_constraints  # type: ignore[attr-defined]
    return [
        (name, [make_constraint(one) for one in stated[name]], "boolean" in stated[name])
        for name in estimator._get_param_names()  # type: ignore[attr-defined]
    ]


class StagesMixin:
    """For estimators that are made of others: a stage that is None stands for its default.

    Its parameters can be set all the same, as in ``set_params(filtration__stop="annexations")``.

    Attributes
    ----------
    _default_stages : dict of str to callable
        What makes the default of each stage that may be None.
    """

    _default_stages: ClassVar[dict[str, Callable[[], BaseEstimator]]]

    def get_params(self, deep: bool = True) -> dict[str, Any]:
        """Parameters as in scikit-learn, with those of default stages."""
        parameters: dict[str, Any] = super().get_params(deep)  # type: ignore[misc]
        for name, default in self._default_stages.items() if deep else ():
            if parameters[name] is None:
                parameters.update({f"{name}__{key}": value for key, value in default().get_params().items()})
        return parameters

    def set_params(self, **parameters: Any) -> Any:
        """Set parameters as in scikit-learn."""
        for name in {key.partition("__")[0] for key in parameters if "__" in key}:
            if name in self._default_stages and parameters.get(name, getattr(self, name)) is None:
                parameters[name] = self._default_stages[name]()
        return super().set_params(**parameters)  # type: ignore[misc]

    def _stage(self, name: str) -> Any:
        """A stage to be fitted: a copy of the parameter, or the default."""
        stage = getattr(self, name)
        return self._default_stages[name]() if stage is None else clone(stage)


def as_list(X: object, one: type | tuple[type, ...]) -> list[Any]:
    """The objects of an iterable.

    Raises
    ------
    ValueError
        If X is a single object, that is of a type of `one`, or no iterable.
    """
    return list(check_iterable(X, one))


def check_iterable(X: object, one: type | tuple[type, ...]) -> Iterable[Any]:
    """Return an iterable, or raise as `as_list` does."""
    if isinstance(X, one) or not isinstance(X, Iterable):
        raise ValueError(f"X must be a list, got a single {type(X).__name__}: wrap it in a list, [X]")
    return X


def check_length(name: str, value: object) -> float:
    """Return a positive number of metres, or raise a ValueError that names the argument."""
    if isinstance(value, bool) or not isinstance(value, Real) or not 0 < float(value) < np.inf:
        raise ValueError(f"{name} must be a positive number of metres, got {value!r}")
    return float(value)


def check_integer(name: str, value: object, smallest: int) -> int:
    """Return an integer of at least `smallest`, or raise a ValueError that names the argument."""
    if isinstance(value, bool) or not isinstance(value, Integral) or value < smallest:
        raise ValueError(f"{name} must be an integer of at least {smallest}, got {value!r}")
    return int(value)


def check_share(name: str, value: object) -> float:
    """Return a number from 0 to 1, or raise a ValueError that names the argument."""
    if isinstance(value, bool) or not isinstance(value, Real) or not 0 <= float(value) <= 1:
        raise ValueError(f"{name} must be a number from 0 to 1, got {value!r}")
    return float(value)

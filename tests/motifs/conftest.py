"""Fixtures of the motif tests: one learned example, which no test changes."""

import pytest
from motif_objects import example


@pytest.fixture(scope="session")
def slow_objects():
    return example().slow_objects


@pytest.fixture(scope="session")
def train():
    return example().train


@pytest.fixture(scope="session")
def new():
    return example().new


@pytest.fixture(scope="session")
def dictionary():
    return example().dictionary


@pytest.fixture(scope="session")
def model():
    return example().model

# Everything happens in a virtual environment inside the clone; only Python 3.11 to 3.13, pip and make are needed.
#   make demo    simulate scans, learn shape concepts from them, write a report to look at
#   make test    lint, check types and imports, run the tests
#   make wheel-check    build the wheel, and use it elsewhere, without extras
#   make test-bounds    run the tests of kernels with a check of every index
#   make test-lowest    run the tests with the lowest versions that pyproject.toml allows, on Python 3.11 (for nightly use)
#   make benchmark    measure every figure of BENCHMARK.md (Open3D needs libusb-1.0 and libgl1 of the system)
# Choose the interpreter with `make PYTHON=python3.12 ...`.

PYTHON = python3
VENV = .venv
LOWEST = $(VENV)-lowest
BIN = $(VENV)/bin
DEMO = demo-output

.PHONY: demo test test-bounds test-lowest wheel-check lint format benchmark clean

demo: $(VENV)/installed
	@rm -rf $(DEMO)
	$(BIN)/shapeconcepts simulate $(DEMO)/scans --n-per-category 24
	@echo "The first time, kernels are compiled, which takes up to a minute"
	$(BIN)/shapeconcepts learn $(DEMO)/scans --model $(DEMO)/model.safetensors --report $(DEMO)/report.html
	@echo "Open $(CURDIR)/$(DEMO)/report.html in a browser. What next:"
	@echo "  $(BIN)/shapeconcepts respond $(DEMO)/model.safetensors $(DEMO)/scans/can"
	@echo "  $(BIN)/shapeconcepts explain $(DEMO)/model.safetensors $(DEMO)/scans/can/can_000.pcd --image why.png --training-data $(DEMO)/scans"

test: lint
	@$(BIN)/python -m pytest

lint: $(VENV)/installed-test
	@$(BIN)/ruff check .
	@$(BIN)/ruff format --check .
	@$(BIN)/mypy
	@said=$$($(BIN)/lint-imports --no-cache) || { echo "$$said"; exit 1; }

wheel-check:
	@.ci/wheel-check $(PYTHON)

# Kernels that check every index are others than those that do not: a folder of their own keeps them apart.
KERNEL_TESTS = $(addprefix tests/,test_far_away.py test_neighbours.py test_preparation_*.py \
	test_extraction_kernels.py test_segmentation_border_settling.py test_segmentation_creases.py test_segmentation_linkage.py \
	test_segmentation_region_merging.py test_segmentation_supervoxels.py test_descriptors_*.py test_topology_*.py \
	test_concepts_dip.py test_concepts_tree.py motifs/test_motif_reference.py motifs/test_prototype_stimuli.py)

test-bounds: $(VENV)/installed-test
	@NUMBA_BOUNDSCHECK=1 NUMBA_CACHE_DIR=$(abspath $(VENV))/checked-kernels $(BIN)/python -m pytest --quiet $(KERNEL_TESTS)

# Kernels are cached for one version of numba at a time: a folder of its own leaves those of $(VENV) alone.
test-lowest: $(LOWEST)/installed-test
	@NUMBA_CACHE_DIR=$(abspath $(LOWEST))/kernels $(LOWEST)/bin/python -m pytest

format: $(VENV)/installed-test
	@$(BIN)/ruff check --fix .
	@$(BIN)/ruff format .

benchmark: $(VENV)/installed-benchmark
	$(BIN)/python -m benchmarks

clean:
	rm -rf $(VENV) $(LOWEST) $(DEMO) build dist

# Debian's Python cannot put pip into an environment (ensurepip is a package of its own), so the pip outside installs.
INSTALL = $(PYTHON) -m pip --python $(BIN)/python install --quiet --disable-pip-version-check

$(VENV)/installed: pyproject.toml
	@echo "Setting up $(VENV) (once; about a minute)"
	@$(PYTHON) -m venv --without-pip $(VENV)
	@$(INSTALL) --editable .
	@touch $@

$(VENV)/installed-test: $(VENV)/installed
	@echo "Adding the tools for testing"
	@$(INSTALL) --editable '.[test,lint]'
	@touch $@

$(VENV)/installed-benchmark: $(VENV)/installed
	@echo "Adding Open3D, to compare with"
	@$(INSTALL) --editable '.[benchmark]'
	@touch $@

# pip knows no lowest versions, uv does.
$(LOWEST)/installed-test: pyproject.toml
	@echo "Setting up $(LOWEST)"
	@python3.11 -m venv --clear --without-pip $(LOWEST)
	@$(PYTHON) -m pip --python $(LOWEST)/bin/python install --quiet --disable-pip-version-check uv
	@$(LOWEST)/bin/uv pip install --quiet --python $(LOWEST)/bin/python --resolution lowest-direct --editable '.[test]'
	@touch $@

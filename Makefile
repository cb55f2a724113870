# make validate   set up .venv and run the main job: charts by theory and by integration, laid one over the other
# make test       set up .venv and run the checks of every change: about a quarter of an hour on two cores
# make test-full  the slow checks as well: hunts with damaged files and deliberate faults, proofs, kills
# make benchmark  the chart engine against its peers, as ratios
# make docs       the documentation site, in site/; open site/index.html

PYTHON ?= python3
BIN := .venv/bin
ARGS ?=
# Python compiles to bytecode what it imports; that pip does so with all that is there would take half of its time.
PIP = $(BIN)/python -m pip install --quiet --disable-pip-version-check --no-compile

# Numba's cache does not notice an edited callee in another file: a cache folder for each state of what kernels are made of.
export NUMBA_CACHE_DIR := $(CURDIR)/.numba_cache/$(shell $(PYTHON) floquet/running/source.py | cut -c1-16)
# Workers take the cores; BLAS must not take them again.
export OPENBLAS_NUM_THREADS := 1
export MKL_NUM_THREADS := 1
export OMP_NUM_THREADS := 1

.PHONY: validate test test-full benchmark docs lint interpreted kernels clean
.DELETE_ON_ERROR:

validate: .venv/.ready-run
	$(BIN)/python scripts/validate.py $(ARGS)

# Pytest's workers share the cores. One process must have compiled the kernels before, or all would, each for itself; as
# compiling takes one core and needs no tools, the tools are installed beside it, and the checks that compile nothing run.
PYTEST = $(BIN)/python -m pytest --numprocesses auto --dist worksteal

test: .venv/.ready-run
	@$(MAKE) --no-print-directory --jobs 2 kernels lint interpreted
	$(PYTEST) -m "not slow" $(ARGS)

test-full: .venv/.ready-run
	@$(MAKE) --no-print-directory --jobs 2 kernels lint interpreted
	$(PYTEST) --hypothesis-profile=default $(ARGS)

kernels: .venv/.ready-run
	@$(BIN)/python -m tests.warm

# The kernels as plain Python, where an index out of bounds is an error.
interpreted: .venv/.ready-test
	NUMBA_DISABLE_JIT=1 $(BIN)/python -m pytest -m "kernel and not slow" -p no:cacheprovider

lint: .venv/.ready-test
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/lint-imports
	$(BIN)/mypy

# Some machines tell BLAS to take an older processor's kernels, which halves the speed of its products.
benchmark: .venv/.ready-bench
	env -u OPENBLAS_CORETYPE $(BIN)/python -m benchmarks $(ARGS)

docs: .venv/.ready-docs
	$(BIN)/python -m sphinx --fail-on-warning --keep-going --quiet docs site $(ARGS)

.venv/bin/python:
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11))' || { echo "python >= 3.11 is needed; try: make PYTHON=python3.12 $(MAKECMDGOALS)"; exit 1; }
	$(PYTHON) -m venv .venv

.venv/.ready-run: pyproject.toml | .venv/bin/python
	$(PIP) --editable .
	@touch $@

.venv/.ready-test: pyproject.toml | .venv/.ready-run
	$(PIP) --editable '.[test]'
	@touch $@

.venv/.ready-bench: pyproject.toml | .venv/.ready-run
	$(PIP) --editable '.[bench]'
	@touch $@

.venv/.ready-docs: pyproject.toml | .venv/.ready-run
	$(PIP) --editable '.[docs]'
	@touch $@

clean:
	rm -rf .venv .numba_cache .mypy_cache .ruff_cache .pytest_cache .import_linter_cache .hypothesis output site *.egg-info

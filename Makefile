# `make quickstart` and `make test` work on a bare machine with Python >= 3.11 (with venv) and make.
# Both can be repeated: a stamp file in .venv says what is done already.

PYTHON ?= python3
CORES ?= $(shell getconf _NPROCESSORS_ONLN 2>/dev/null || echo 2)
BIN := .venv/bin

# One thread in every numerical process: the same bits everywhere, and no fight for the cores.
export OMP_NUM_THREADS := 1
export MKL_NUM_THREADS := 1
export OPENBLAS_NUM_THREADS := 1
export NUMBA_NUM_THREADS := 1

.PHONY: help setup quickstart test test-slow validate lint format lock clean
help:
	@echo "make quickstart   set up, then compute and draw two scale patterns (workflows/quickstart.yaml)"
	@echo "make test         set up, then the fast test suite"
	@echo "make test-slow    the tests that take minutes"
	@echo "make validate     the validation pages in results/reference/benchmarks; takes hours, goes on if stopped"
	@echo "make lint         ruff and mypy"
	@echo "make format       ruff format and safe fixes"
	@echo "make lock         renew requirements.lock from pyproject.toml"
	@echo "make clean        remove .venv and caches; results stay"

setup: .venv/.system

quickstart: setup
	@$(BIN)/flexscale run workflows/quickstart.yaml --cores $(CORES)

test: setup
	@$(BIN)/python -m pytest -q -n $(CORES) --dist loadgroup

test-slow: setup
	@$(BIN)/python -m pytest -q -m slow

validate: setup
	@$(BIN)/python benchmarks/validate.py

lint: setup
	@$(BIN)/ruff check . && $(BIN)/ruff format --check . && $(BIN)/mypy

format: setup
	@$(BIN)/ruff check --fix . ; $(BIN)/ruff format .

lock: setup
	@$(BIN)/uv pip compile -q --universal --no-header --extra dev -o requirements.lock pyproject.toml

clean:
	rm -rf .venv .pytest_cache .mypy_cache .ruff_cache .hypothesis

# --- set-up, in three steps that are done once each -----------------------------------------

.venv/.python:
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11))' 2>/dev/null || { \
	  echo "FlexScale needs Python 3.11 or newer, and '$(PYTHON)' is not: make $(MAKECMDGOALS) PYTHON=/path/to/python3.11" >&2; exit 4; }
	@$(PYTHON) -c 'import ensurepip, venv' 2>/dev/null || { \
	  echo "Python's venv is missing. On Debian or Ubuntu: apt-get install -y python3-venv" >&2; exit 4; }
	@echo "set-up: creating .venv" >&2
	@$(PYTHON) -m venv .venv
	@$(BIN)/python -m pip install --quiet --disable-pip-version-check 'uv>=0.5'
	@touch $@

.venv/.packages: requirements.lock pyproject.toml .venv/.python
	@echo "set-up: installing the locked packages" >&2
	@$(BIN)/uv pip sync --quiet --compile-bytecode --python $(BIN)/python requirements.lock
	@$(BIN)/uv pip install --quiet --python $(BIN)/python --no-deps --editable .
	@touch $@

.venv/.system: .venv/.packages
	@$(BIN)/flexscale doctor --fix --quiet
	@touch $@

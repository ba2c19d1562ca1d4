# `make quickstart` and `make test` work on a bare machine with Python >= 3.11 (with venv) and make.
# Both can be repeated: a stamp file in .venv says what is done already.

PYTHON ?= python3
CORES ?= $(shell getconf _NPROCESSORS_ONLN 2>/dev/null || echo 2)
BIN := .venv/bin
BEGUN := .venv/.begun
CREATE = $(PYTHON) -m venv --clear .venv && $(BIN)/python -m pip install --quiet --disable-pip-version-check 'uv>=0.5'
SPACE := 3000000 # KB that set-up needs

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

setup: .venv/.kernels

quickstart: setup
	@$(BIN)/flexscale run workflows/quickstart.yaml --cores $(CORES)

# Files go to processes in their order, so that those with few long tests do not come last.
test: setup
	@$(BIN)/python -m pytest -q -n $(CORES) --dist loadfile --no-loadscope-reorder --durations=10

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

# --- set-up, in four steps that are done once each -----------------------------------------
# Each leaves its stamp when it is done. A step that was interrupted is done again from its start.

.venv/.python:
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11))' 2>/dev/null || { \
	  echo "FlexScale needs Python 3.11 or newer, and '$(PYTHON)' is not: make $(MAKECMDGOALS) PYTHON=/path/to/python3.11" >&2; exit 4; }
	@$(PYTHON) -c 'import ensurepip, venv' 2>/dev/null || { \
	  echo "Python's venv is missing. On Debian or Ubuntu: apt-get install -y python3-venv" >&2; exit 4; }
	@test "$$(uname -s)" != Linux || test "$$(uname -m)" = x86_64 || { \
	  echo "On Linux the packages gmsh and ipctk come for x86_64 only, and this machine is $$(uname -m): use one of x86_64, or a container of that kind." >&2; exit 4; }
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info >= (3, 14))' || command -v cc >/dev/null || { \
	  echo "For Python 3.14 and newer a package (immutables) has to be compiled, and there is no C compiler: install one, or make $(MAKECMDGOALS) PYTHON=/path/to/python3.13" >&2; exit 4; }
	@test "$$(df -Pk . | awk 'NR == 2 {print $$4}')" -gt $(SPACE) || { \
	  echo "Set-up needs 3 GB here: .venv takes 2, packages on their way to it the rest. Make room, or clone elsewhere." >&2; exit 4; }
	@echo "set-up: creating .venv, which will take 2 GB; its packages are about 0.6 GB to download" >&2
	@$(CREATE)
	@touch $@

# Packages that were only partly installed are known to nobody: then all is made anew, from what
# has been downloaded already.
.venv/.packages: requirements.lock pyproject.toml .venv/.python
	@test ! -e $(BEGUN) || { echo "set-up: the last one was interrupted; creating .venv anew" >&2; $(CREATE) && touch .venv/.python; }
	@echo "set-up: installing $$(grep -c '^[a-z]' requirements.lock) locked packages; large ones that are downloaded:" >&2
	@touch $(BEGUN); $(BIN)/uv pip sync --compile-bytecode --python $(BIN)/python requirements.lock 2>&1 \
	  | sed -n 's/^Downloading /  /p' >&2
	@$(BIN)/uv pip sync --quiet --python $(BIN)/python requirements.lock # fails, and says why, if that one did
	@$(BIN)/uv pip install --quiet --python $(BIN)/python --no-deps --editable .
	@rm -f $(BEGUN)
	@touch $@

.venv/.system: .venv/.packages
	@$(BIN)/flexscale doctor --fix --quiet
	@touch $@

# Kernels of cells on joints are compiled and kept: the first results need not wait for it.
.venv/.kernels: .venv/.system
	@echo "set-up: compiling kernels, once" >&2
	@$(BIN)/python -c 'import flexscale as fs; fs.sweep(fs.named_pattern("square"), [0], [0, 0.005, 0.012], workers=1)'
	@touch $@

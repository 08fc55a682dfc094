# Every target makes its own virtual environment first; a bare machine needs only make and Python 3.11 or newer.
.DEFAULT_GOAL := help
.PHONY: demo test studies bench lint clean help

VENV := .venv
BIN := $(VENV)/bin
STAMP := $(VENV)/.installed
PIP := $(BIN)/python -m pip --quiet --disable-pip-version-check

# Asked only when an environment is made: the newest interpreter that is recent enough and can make one.
PYTHON ?= $(shell for p in python3.14 python3.13 python3.12 python3.11 python3 python; do \
	$$p -c 'import sys, venv, ensurepip; sys.exit(sys.version_info < (3, 11))' >/dev/null 2>&1 && echo $$p && break; \
	done)

demo: $(STAMP)  ## run the whole loop on a virtual test and write results/demo
	@$(BIN)/testbed demo --out results/demo

test: $(STAMP)  ## run all tests but the long studies
	@$(BIN)/python -m pytest -q -n 2 --dist worksteal -m 'not study'

studies: $(STAMP)  ## make the long studies again and hold them to their bars
	@$(BIN)/python -m pytest -q -n 2 --dist worksteal -m study

bench: $(STAMP)  ## run the benchmarks and print their ratios
	@$(BIN)/python -m pytest -q -s -o python_files='bench_*.py' tests/benchmarks

lint: $(STAMP)  ## ruff check, ruff format --check and mypy
	@$(BIN)/ruff check --quiet
	@$(BIN)/ruff format --check --quiet
	@$(BIN)/mypy --no-error-summary

clean:  ## remove the environment and all caches
	@rm -rf $(VENV) build *.egg-info .mypy_cache .ruff_cache .pytest_cache .hypothesis .benchmarks
	@find models identification testbed tests -name __pycache__ -type d -prune -exec rm -rf {} +

help:  ## show this list
	@awk -F ':.*## ' '/^[a-z]+:.*## / { printf "  make %-7s %s\n", $$1, $$2 }' Makefile

$(STAMP): requirements.lock pyproject.toml
	@python="$(PYTHON)"; \
	if [ -z "$$python" ]; then \
		echo "make: no Python 3.11 or newer with the venv module was found;" >&2; \
		echo "      install one (Debian and Ubuntu: python3 and python3-venv) or name it: make PYTHON=/path/to/python3" >&2; \
		exit 1; \
	fi; \
	echo "making $(VENV) with $$($$python --version), once" >&2; \
	$$python -m venv --clear $(VENV)
	@$(PIP) install -r requirements.lock
	@$(PIP) install --no-deps -e .
	@touch $@

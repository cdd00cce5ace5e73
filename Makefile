# `make validate` and `make test` need Python 3.11 or later with pip, and nothing else: the first
# that runs, since a name on the path may be a shim of one that is not installed.
PYTHON ?= $(or $(firstword $(foreach name,python3.11 python3.12 python3.13 python3,$(shell \
	$(name) -c 'import sys; sys.version_info >= (3, 11) and print("$(name)")' 2>/dev/null))),\
	$(error no Python 3.11 or later is on the path: name one with PYTHON=...))
VENV ?= .venv
BIN := $(VENV)/bin
SUITE ?= quick
ENGINES_VENV ?= .venv-engines
ENGINES ?= $(shell $(PYTHON) -c 'import tomllib; of = tomllib.load(open("pyproject.toml", "rb"))["project"]; \
	print(*sorted({*of["optional-dependencies"]} & {*of["entry-points"]["rockingcan.engines"]}))')

.PHONY: validate engines test test-all test-engines explore random-scenes mutants docs numbers measure lint types contracts models schema clean

validate: $(VENV)/ready
	$(BIN)/rockingcan validate --suite $(SUITE)

# every engine that this machine can have, in an environment beside the other: the extras that pip can
# install together, others in interpreters of their own; ENGINES names those that are wanted
engines: $(ENGINES_VENV)/ready
	$(ENGINES_VENV)/bin/rockingcan validate --suite full --engine all --out reports/engines

# as the program has it: see rockingcan.py
export OPENBLAS_NUM_THREADS ?= 1

# tests run in as many processes as there are cores, a file in one of them
TESTS = bin/python -m pytest -n auto --maxprocesses 8 --dist loadscope --no-loadscope-reorder
PYTEST = $(VENV)/$(TESTS)

test: $(VENV)/ready-to-test
	$(PYTEST) --quick

test-all: $(VENV)/ready-to-test
	$(PYTEST)

# what concerns an optional engine, for those that are installed by the target above
test-engines: $(ENGINES_VENV)/ready
	$(ENGINES_VENV)/$(TESTS) --optional-engines --quick

# property tests with fresh seeds; tests/conftest.py says what becomes of what they find
explore: $(VENV)/ready-to-test
	$(BIN)/python -m pytest -m hypothesis --hypothesis-profile=explore

# a thousand random scenes of each kind of contact, of which the tests take a sample
random-scenes: $(VENV)/ready-to-test
	$(BIN)/python -m tests.random_scenes

# what the tests would not notice if it changed; SHARE=0.1 draws a tenth of it
SHARE ?= 1
mutants: $(VENV)/ready-to-mutate
	$(BIN)/python -m tests.mutation --share $(SHARE) --out reports/mutation.md

lint: $(VENV)/ready-to-develop
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .

types: $(VENV)/ready-to-develop
	$(BIN)/mypy

contracts: $(VENV)/ready-to-develop
	$(BIN)/lint-imports

# the site, in docs/_build/site: it opens from disk
docs: $(VENV)/ready-to-document
	$(BIN)/python -m docs.site

# the numbers in README, CONTRIBUTING and the docs, from the files that were measured
numbers: $(VENV)/ready
	$(BIN)/python -m docs.numbers

# these files, measured again: some forty minutes, or ONLY=cost; docs/measured.toml says how
measure: $(VENV)/ready-to-test
	$(BIN)/python -m docs.measure $(ONLY)

# the published schema of results, from its models
schema: $(VENV)/ready
	$(BIN)/python -m harness.results.schema

# the openable model files, from the scenes
models: $(VENV)/ready
	$(BIN)/python -m models.export

clean:
	rm -rf $(VENV) $(ENGINES_VENV) build dist docs/_build

$(BIN)/python:
	$(PYTHON) -m venv $(VENV)
	$(BIN)/python -m pip install --quiet "pip>=25.1" -c constraints.txt

$(VENV)/ready: pyproject.toml constraints.txt | $(BIN)/python
	$(BIN)/python -m pip install --quiet --editable . -c constraints.txt
	touch $@

$(VENV)/ready-to-test: $(VENV)/ready
	$(BIN)/python -m pip install --quiet --group test -c constraints.txt
	touch $@

$(VENV)/ready-to-mutate: $(VENV)/ready-to-test
	$(BIN)/python -m pip install --quiet --group mutation -c constraints.txt
	touch $@

$(VENV)/ready-to-document: $(VENV)/ready
	$(BIN)/python -m pip install --quiet --group docs -c constraints.txt
	touch $@

$(VENV)/ready-to-develop: $(VENV)/ready-to-test
	$(BIN)/python -m pip install --quiet --group dev -c constraints.txt
	touch $@

$(ENGINES_VENV)/ready: pyproject.toml constraints.txt
	$(PYTHON) -m venv $(ENGINES_VENV)
	$(ENGINES_VENV)/bin/python -m pip install --quiet "pip>=25.1" -c constraints.txt
	$(ENGINES_VENV)/bin/python -m pip install --quiet --editable . --group test -c constraints.txt
	for engine in $(ENGINES); do \
		$(ENGINES_VENV)/bin/python -m pip install --quiet --editable ".[$$engine]" -c constraints.txt \
			|| $(ENGINES_VENV)/bin/rockingcan engines add $$engine \
			|| echo "without $$engine, for the reason above" >&2; \
	done
	touch $@

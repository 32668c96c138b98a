# Every target makes what it needs; `make test` on a fresh Debian 12 as root needs nothing installed by hand.
PYTHON := .venv/bin/python

.PHONY: demo test quick formal lint format types docs bench fuzz peers venv clean

demo: ## the whole path in one terminal, in about two minutes
	@tools/debian.sh python3-venv g++
	@tools/venv.sh
	$(PYTHON) -m roslet demo

test: ## lint, types, layers, every test on CPython and MicroPython, real peers
	tools/test.sh

quick: venv ## the tests that need no peer process
	$(PYTHON) -m pytest -q --ignore=tests/interop

formal: venv ## the proofs of gateware, deeper than the ordinary run has time for
	ROSLET_FORMAL_DEEP=1 $(PYTHON) -m pytest -q --timeout 1800 tests/gateware/test_formal.py

lint: venv ## style and the one-way layers
	$(PYTHON) -m ruff check
	$(PYTHON) -m ruff format --check
	.venv/bin/lint-imports

format: venv
	$(PYTHON) -m ruff check --fix
	$(PYTHON) -m ruff format

types: venv
	$(PYTHON) -m mypy

docs: venv ## every code block of the README and docs/ is run
	$(PYTHON) tools/check_docs.py

bench: venv peers ## ratios against peers and a raw-socket floor
	tools/bench.sh

FUZZ_SECONDS ?= 30
fuzz: venv ## coverage-guided, each target for FUZZ_SECONDS, one after another
	tools/fuzz.sh $(FUZZ_SECONDS)

peers: ## Debian packages, ROS 2 wheels, compiled ROS 1 programs, in a cache outside the tree
	tools/debian.sh
	tools/peers.sh

venv:
	@tools/venv.sh

clean:
	rm -rf .venv build dist .mypy_cache .ruff_cache .pytest_cache .hypothesis .import_linter_cache

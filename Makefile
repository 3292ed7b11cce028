# `make` alone lists the targets. Each works as the first command after a clone: it needs Python 3.11, make and git.

VENV ?= .venv
# Which Python builds the virtual environment: python3.11 where it runs, python3 otherwise. `make PYTHON=... test` overrides.
PYTHON ?= $(shell if python3.11 -c '' >/dev/null 2>&1; then echo python3.11; else echo python3; fi)

BIN := $(VENV)/bin
RUNTIME := $(VENV)/runtime.stamp
DEV := $(VENV)/dev.stamp

PIP_INSTALL := $(BIN)/python -m pip install --quiet --disable-pip-version-check
PIP_COMPILE := $(BIN)/python -m piptools compile --quiet --generate-hashes --allow-unsafe --strip-extras \
	--no-header --no-emit-index-url --no-emit-trusted-host --no-emit-find-links

.PHONY: help demo pictures picture-reports test test-fast test-all lint benchmark results problems proof proof-sample proof-multibody motion-proof motion-proof-sample real-table canonical rules-docs effects-docs instruments-docs fuzz docs notebooks gallery lock clean
.DELETE_ON_ERROR:

help:
	@echo "make demo       optimise the example welding arm; says where the report is"
	@echo "make pictures   docs/pictures/tradeoff.svg and what was solved for it, by the command in docs/how-to/tradeoff.md (ten minutes)"
	@echo "make picture-reports  docs/pictures/diagnosis.png and welding-arm.png, with Chromium"
	@echo "make test       the test suite but for what is marked slow"
	@echo "make test-fast  the tests worth running every minute, some of every room"
	@echo "make test-all   what make test leaves: real machines, the paper, notebooks, a browser, odd files, more seeds (MINUTES=8 begins none after that)"
	@echo "make lint       ruff and pyright"
	@echo "make benchmark  the exchange against a full grid of poses (BENCHMARK_ARGS=... is passed on to benchmarks.results)"
	@echo "make results    benchmarks/RESULTS.md: every measured figure beside its target (RESULTS_ARGS=--quick; many minutes)"
	@echo "make problems   hold the optimiser against every combination of random problems and a hand calculation, 50 of each kind (PROBLEMS=50)"
	@echo "make proof      the diagnosis on concealed physics (PROOF_CASES=1000 PROOF_SEED=... PROOF_OUT=...; an hour or more)"
	@echo "make proof-sample  a seeded sample of it, with bounds that must hold"
	@echo "make proof-multibody  the diagnosis on arms of a multibody engine (PROOF_CASES=600 PROOF_HALF=development or proof; hours)"
	@echo "make motion-proof  the diagnosis on motion logs of MuJoCo arms (PROOF_CASES=300 PROOF_HALF=development or proof; hours)"
	@echo "make motion-proof-sample  twenty of them, some minutes"
	@echo "make real-table  what written files leave of real machines, beside the textbook's least squares (LINKWRIGHT_DATA=..., LINKWRIGHT_PUBLIC=..., REAL=names; twenty minutes)"
	@echo "make rules-docs docs/rules.md from the rules of the diagnosis"
	@echo "make effects-docs docs/effects.md from the effects"
	@echo "make instruments-docs docs/instruments.md from the instruments"
	@echo "make fuzz       odd files of every kind, each read or refused in one line (FUZZ_INPUTS=100000 FUZZ_SEED=1; an hour)"
	@echo "make docs       the site of the docs, commands and Python face, in build/handbook; fails on a broken link"
	@echo "make notebooks  run examples/notebooks and store what they print and draw, with Chromium"
	@echo "make gallery    run examples/gallery and store what its scripts draw and print, with Chromium"
	@echo "make lock       pin the dependencies anew (LOCK_ARGS=--upgrade takes the newest)"
	@echo "make clean      remove what these targets made, the virtual environment included"

# The virtual environment is built anew when the runtime lock or pyproject.toml changes. A stamp is written last, so an
# interrupted build counts as none.
$(RUNTIME): requirements.lock pyproject.toml
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11))' 2>/dev/null \
		|| { echo "Linkwright needs Python 3.11 or newer as python3.11 or python3, or named by: make PYTHON=/path/to/python" >&2; exit 1; }
	@$(PYTHON) -c 'import ensurepip, venv' 2>/dev/null \
		|| { echo "This Python cannot make virtual environments; on Debian or Ubuntu: apt-get install python3-venv" >&2; exit 1; }
	@echo "Building $(VENV) from requirements.lock (once; a minute or two)"
	@$(PYTHON) -m venv --clear $(VENV)
	@$(PIP_INSTALL) --require-hashes -r requirements.lock
	@$(PIP_INSTALL) --no-index --no-deps --no-build-isolation --editable .
	@touch $@

$(DEV): requirements-dev.lock $(RUNTIME)
	@echo "Adding the tools of requirements-dev.lock"
	@$(PIP_INSTALL) --require-hashes -r requirements-dev.lock
	@touch $@

# Two processes that each start a thread for every core only get in each other's way.
ONE_THREAD := OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1

define SHOW_DEMO
import json, pathlib, sys
folder = pathlib.Path(sys.argv[1])
result = json.loads((folder / "result.json").read_text(encoding="utf-8"))
print()
print(f"Worst position error before: {result['before']['max_error_mm']:.4g} mm")
print(f"Worst position error after:  {result['max_error_mm']:.4g} mm")
print(f"Report for people:   {folder / 'report.html'}")
print(f"Result for machines: {folder / 'result.json'}")
missing = [name for name in ("report.html", "arm.yaml") if not (folder / name).is_file()]
sys.exit(f"Not written: {', '.join(missing)}" if missing else 0)
endef
export SHOW_DEMO

demo: $(RUNTIME)
	@out="demo-out-$$(date +%Y%m%d-%H%M%S)-$$$$"; \
	$(BIN)/linkwright optimize examples/welding-arm/problem.yaml --out "$$out" \
		&& $(BIN)/python -c "$$SHOW_DEMO" "$$out"

# The points are kept beside the picture, for a test to find some of them anew.
pictures: $(DEV)
	$(ONE_THREAD) $(BIN)/python -m handbook.front

# Its file says what the report answered; a test holds that against a fresh diagnosis.
picture-reports: $(DEV)
	$(ONE_THREAD) $(BIN)/python -m handbook.pictures

# A file's tests go to one worker, so that what they share is computed once.
PYTEST := $(ONE_THREAD) $(BIN)/python -m pytest -n 2 --dist loadfile --strict-markers

test: $(DEV)
	@$(PYTEST) -m "not slow" $(PYTEST_ARGS)

# With MINUTES, the files come in an order of SHARE's own, so that every commit has others tested.
SHARE ?= $(shell git rev-parse HEAD 2>/dev/null)
test-all: $(DEV)
	@$(PYTEST) -m slow $(if $(MINUTES),--no-loadscope-reorder --minutes $(MINUTES) --share "$(SHARE)") $(PYTEST_ARGS)

# Some of every room, a real optimisation and a real diagnosis among them, by what they cost: 93 s of CPU in all on
# a machine busy with other things, half that in time on two idle cores.
FAST_TESTS := tests/test_house.py \
	tests/sections/test_design.py tests/sections/test_published_values.py tests/sections/test_stock.py \
	tests/materials/test_catalogue.py tests/materials/test_material.py tests/materials/test_reading.py \
	tests/materials/test_store.py::test_a_kill_before_any_line_leaves_the_old_or_the_new_file \
	tests/arm/effects/test_effect_contract.py tests/arm/effects/test_effects_geometry.py \
	tests/arm/effects/test_effects_inertia.py tests/arm/effects/test_effects_loads.py \
	tests/arm/effects/test_effects_thermal.py tests/arm/test_actuators.py \
	tests/arm/test_denavit_hartenberg.py tests/arm/test_files.py tests/arm/test_play.py \
	tests/optimize/test_bad_input.py \
	tests/optimize/test_known_figures.py::test_fixed_lengths_are_a_geometric_program \
	tests/diagnose/reading/test_checks.py tests/diagnose/reading/test_foreign_files.py \
	tests/diagnose/reading/test_formulas.py tests/diagnose/reading/test_reading.py \
	tests/diagnose/residual/test_alignment.py \
	tests/diagnose/test_diagnosis.py::test_too_few_readings_decide_nothing \
	tests/face/test_diagnosis.py::test_diagnosis tests/linkwright/test_json.py \
	tests/linkwright/test_cli.py::test_help_shows_an_example tests/linkwright/test_cli.py::test_wrong_input_is_one_line \
	tests/linkwright/commands/test_inverse.py

test-fast: $(DEV)
	@$(PYTEST) -m "not slow" $(PYTEST_ARGS) $(FAST_TESTS)

lint: $(DEV)
	$(BIN)/ruff check .
	$(BIN)/pyright --pythonpath $(BIN)/python

benchmark: $(DEV)
	$(ONE_THREAD) $(BIN)/python -m benchmarks.results --only grid $(BENCHMARK_ARGS)

results: $(DEV)
	$(ONE_THREAD) $(BIN)/python -m benchmarks.results --page benchmarks/RESULTS.md $(RESULTS_ARGS)

# Some ten minutes of CPU for each ten problems.
PROBLEMS ?= 50
problems: $(DEV)
	@$(ONE_THREAD) PROBLEMS=$(PROBLEMS) $(BIN)/python -m pytest -n 2 $(PYTEST_ARGS) tests/optimize/test_invariants.py tests/optimize/adversary

PROOF_CASES ?= 1000
PROOF_SEED ?= 1
PROOF_HALF ?= disclosed
PROOF_OUT ?= proof-out-$(PROOF_HALF)-$(PROOF_SEED)

# The truths are sealed by hash before the tool is asked anything; a sealed half is asked once.
proof: $(DEV)
	$(BIN)/python -m benchmarks.blind make --cases $(PROOF_CASES) --seed $(PROOF_SEED) --half $(PROOF_HALF) --out $(PROOF_OUT)
	$(ONE_THREAD) $(BIN)/python -m benchmarks.blind run $(PROOF_OUT) --answers $(PROOF_OUT)-answers --jobs 2
	$(BIN)/python -m benchmarks.blind score $(PROOF_OUT) --answers $(PROOF_OUT)-answers --markdown $(PROOF_OUT).md --json $(PROOF_OUT).json

proof-sample: $(DEV)
	$(ONE_THREAD) $(BIN)/python -m benchmarks.blind_sample

PROOF_JOBS ?= 2
# The second generator: its proof half holds unknown classes of its own and is asked once. Goes on where it was interrupted.
PROOF_REMOUNTS ?= 0.35
proof-multibody: PROOF_CASES = 600
proof-multibody: PROOF_HALF = development
proof-multibody: PROOF_OUT = proof-out-multibody-$(PROOF_HALF)-$(PROOF_SEED)
proof-multibody: $(DEV)
	test -f $(PROOF_OUT)/seal.txt || $(BIN)/python -m benchmarks.multibody make --cases $(PROOF_CASES) --seed $(PROOF_SEED) --half $(PROOF_HALF) --out $(PROOF_OUT) --jobs $(PROOF_JOBS) --remounts $(PROOF_REMOUNTS)
	$(ONE_THREAD) $(BIN)/python -m benchmarks.multibody run $(PROOF_OUT) --answers $(PROOF_OUT)-answers --jobs $(PROOF_JOBS)
	$(BIN)/python -m benchmarks.multibody score $(PROOF_OUT) --answers $(PROOF_OUT)-answers --json $(PROOF_OUT).json

# Motion logs: the same order of things, with a generator of their own.
motion-proof: PROOF_CASES = 300
motion-proof-sample: PROOF_CASES = 20
motion-proof motion-proof-sample: PROOF_HALF = development
motion-proof motion-proof-sample: PROOF_OUT = proof-out-motion-$(PROOF_CASES)-$(PROOF_HALF)-$(PROOF_SEED)
motion-proof motion-proof-sample: $(DEV)
	test -f $(PROOF_OUT)/seal.txt || $(BIN)/python -m benchmarks.motion make --cases $(PROOF_CASES) --seed $(PROOF_SEED) --half $(PROOF_HALF) --out $(PROOF_OUT) --jobs $(PROOF_JOBS)
	$(ONE_THREAD) $(BIN)/python -m benchmarks.motion run $(PROOF_OUT) --answers $(PROOF_OUT)-answers --jobs $(PROOF_JOBS)
	$(BIN)/python -m benchmarks.motion score $(PROOF_OUT) --answers $(PROOF_OUT)-answers --json $(PROOF_OUT).json

# docs/real-machines.md says where recordings are; a machine whose recordings are not there is skipped, and named.
REAL ?=
real-table: $(DEV)
	@$(ONE_THREAD) $(BIN)/python -m benchmarks.real table $(REAL)

# Asks every canonical recording and writes down which are missed: a change there is a decision.
canonical: $(DEV)
	@$(ONE_THREAD) $(BIN)/python -m benchmarks.canonical record

rules-docs: $(DEV)
	$(BIN)/python -m benchmarks.rules docs/rules.md

effects-docs: $(DEV)
	$(BIN)/python -m handbook.effects

instruments-docs: $(DEV)
	$(BIN)/python -m handbook.instruments

# Each input within 10 s and 1 GiB; what is neither read nor refused is made as small as it can be, and shown.
FUZZ_INPUTS ?= 100000
FUZZ_SEED ?= 1
fuzz: $(DEV)
	$(ONE_THREAD) $(BIN)/python -m benchmarks.fuzz --inputs $(FUZZ_INPUTS) --seed $(FUZZ_SEED)

# Plots become pictures, by Chromium.
notebooks: $(DEV)
	@PLOTLY_RENDERER=plotly_mimetype $(ONE_THREAD) $(BIN)/python -m handbook.notebooks

gallery: $(DEV)
	$(ONE_THREAD) $(BIN)/python -m handbook.gallery

# Fetches nothing; a warning fails it (told to be quiet it would count none). The pages and their search work from the disk.
docs: $(DEV)
	@NO_MKDOCS_2_WARNING=1 $(ONE_THREAD) $(BIN)/python -m mkdocs build --strict
	@echo "build/handbook/index.html"

# The dev lock repeats the pins of the runtime lock, so that tests run on what users get. The first run on a tree
# without locks needs pip-tools in the environment by hand.
lock:
	@$(BIN)/python -c 'import piptools' 2>/dev/null \
		|| { echo "make lock needs pip-tools: run make test first, or $(BIN)/pip install pip-tools" >&2; exit 1; }
	$(PIP_COMPILE) $(LOCK_ARGS) --all-build-deps --extra browser --extra dxf --output-file requirements.lock pyproject.toml
	$(BIN)/python -c 'import tomllib; print(*tomllib.load(open("pyproject.toml", "rb"))["dependency-groups"]["dev"], sep="\n")' \
		| $(PIP_COMPILE) $(LOCK_ARGS) --extra browser --extra dxf --extra logs --extra parquet --extra step --constraint requirements.lock \
			--output-file requirements-dev.lock pyproject.toml -
	@touch requirements.lock requirements-dev.lock

clean:
	rm -rf $(VENV) build dist ./*.egg-info .pytest_cache .ruff_cache .hypothesis demo-out-* pictures-out proof-out-* rules-out*
	find . -name __pycache__ -type d -prune -exec rm -rf {} +

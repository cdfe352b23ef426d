# A thin front end for CMake: installs what is missing, configures, builds, runs. `make help` lists the targets.
#   DEVICE=   a device of platform/devices or a CPU class (armhf, armel, aarch64, armv4t, armv6, armv7, mips32); empty: this
#             machine
#   PREFIX=   where `make install` goes
#   TESTS=    build and run only the tests that match this regular expression
#   JSON=     also write the table of `make hardcases` or `make mutants` to this file
#   SHARE=    run only this share of the hard cases' inputs
#   SUITES=   run the hard cases of these suites only
DEVICE ?=
PREFIX ?= /usr/local
TESTS ?= .
SCENE ?= cornell
JOBS ?= $(shell nproc 2>/dev/null || echo 2)

# Lets clones in other folders share a compiler cache.
export CCACHE_BASEDIR := $(CURDIR)
export CCACHE_NOHASHDIR := true

CLASS :=
ifneq ($(DEVICE),)
  CLASS := $(shell toolchains/device.sh $(DEVICE))
  ifeq ($(CLASS),)
    $(error DEVICE=$(DEVICE): see above)
  endif
endif
override CLASS := $(filter-out desktop,$(CLASS))
# CROSS_PREFIX=arm-linux-: a vendor's compiler, for the class of DEVICE= or, without it, for the CPU that the compiler or
# CROSS_FLAGS= chooses. SYSROOT= its C library if not its own; ZLIB= folder with include/zlib.h, zconf.h and lib/libz.a;
# MBEDTLS= folder with include/mbedtls and lib/libmbed{tls,x509,crypto}.a of version 2.28. TLS=OFF leaves encryption out.
CROSS_PREFIX ?=
CROSS_FLAGS ?=
SYSROOT ?=
ZLIB ?=
MBEDTLS ?=
TLS ?=
ifneq ($(CROSS_PREFIX),)
  override CLASS := $(or $(CLASS),cross)
endif
ifneq ($(CLASS),)
  ifneq ($(shell toolchains/compiler.sh $(CLASS) "$(CROSS_PREFIX)" "$(SYSROOT)" >&2 || echo bad),)
    $(error no compiler for $(CLASS): see above)
  endif
endif
BUILD := $(if $(CROSS_PREFIX),build-$(CLASS)-$(notdir $(CROSS_PREFIX:%-=%)),build$(CLASS:%=-%))
POCKETRAY := $(BUILD)/pocketray

.PHONY: all run setup-tests test test-box hardcases pages softfloat mutants trials faults demo-split split-table motion-table fuzz flips bench bench-embree bench-povray bench-device contact-sheet room-sheet mach-bands rooms governor package format tidy clean install help setup configure
all: configure
	cmake --build $(BUILD) -j$(JOBS)$(if $(CLASS), --target pocketray)
ifneq ($(CLASS),)
	@echo "$(POCKETRAY): $$(stat -c %s $(POCKETRAY)) bytes, static, for $(or $(DEVICE),$(CROSS_PREFIX))"
endif

setup:
	@toolchains/setup.sh $(or $(CLASS),desktop)

# Ninja and a compiler cache where installed, and the device's toolchain.
configure: setup
	@mkdir -p $(BUILD) && sysroot=$(if $(CLASS),$$(toolchains/sysroot.sh $(CLASS) "$(ZLIB)" "$(MBEDTLS)")) && \
	cmake -S . -B $(BUILD) -DCMAKE_INSTALL_PREFIX=$(PREFIX) \
	  $$([ -f $(BUILD)/CMakeCache.txt ] || ! command -v ninja >/dev/null || echo -G Ninja) \
	  $$(! command -v ccache >/dev/null || echo -DCMAKE_C_COMPILER_LAUNCHER=ccache -DCMAKE_CXX_COMPILER_LAUNCHER=ccache) \
	  $(if $(CLASS),-DCMAKE_TOOLCHAIN_FILE=$(CURDIR)/toolchains/$(CLASS).cmake -DPOCKETRAY_SYSROOT=$$sysroot) \
	  $(if $(TLS),-DPOCKETRAY_TLS=$(TLS)) \
	  $(if $(CROSS_PREFIX),-DPOCKETRAY_CROSS_PREFIX=$(CROSS_PREFIX) -DPOCKETRAY_CROSS_SYSROOT=$(SYSROOT) "-DPOCKETRAY_CROSS_FLAGS=$(CROSS_FLAGS)") \
	  >$(BUILD)/configure.log || { cat $(BUILD)/configure.log 2>/dev/null; exit 1; }

run: configure
	cmake --build $(BUILD) -j$(JOBS) --target pocketray
	$(POCKETRAY) plan $(SCENE)
	$(POCKETRAY) render $(SCENE) --quality high -o $(BUILD)/$(SCENE).png
	$(POCKETRAY) bench $(SCENE)
	@if [ -n "$$DISPLAY$$WAYLAND_DISPLAY" ]; then \
	  echo $(POCKETRAY) view $(SCENE); $(POCKETRAY) view $(SCENE); \
	else \
	  echo "no display here; the picture is $(BUILD)/$(SCENE).png"; \
	fi

setup-tests:
	@$(if $(CLASS),:,toolchains/setup.sh tests)

test: setup-tests configure
	targets=$$(tests/targets.sh $(BUILD) '$(TESTS)') && cmake --build $(BUILD) -j$(JOBS) --target $$targets
	cd $(BUILD) && ctest --output-on-failure -j$(JOBS) -R '$(TESTS)'

# Boots emulated handhelds with the static program. MACHINES= names some of arm926 cortex-a7 aarch64. The first run builds a
# kernel.
MACHINES ?= arm926 cortex-a7 aarch64
test-box: configure
	@toolchains/setup.sh box $(if $(filter arm926,$(MACHINES)),box-kernel armel)
	@cmake --build $(BUILD) -j$(JOBS) --target pocketray
	@tests/box/run.sh $(POCKETRAY) $(MACHINES) || [ $$? = 77 ]

hardcases: setup-tests configure
	@JSON=$(if $(JSON),$(abspath $(JSON))) SHARE=$(SHARE) SUITES="$(SUITES)" \
	  cmake --build $(BUILD) -j$(JOBS) --target hardcases

# The pages that the program writes, in Chromium; screenshots stay in the build folder's pages/.
pages: configure
	@toolchains/setup.sh pages
	cmake --build $(BUILD) -j$(JOBS) --target pocketray
	cd $(BUILD) && ctest --output-on-failure -R '^pages$$'

softfloat: setup-tests configure
	@cmake --build $(BUILD) -j$(JOBS) --target softfloat

# Applies deliberate faults, one at a time: does a test fail? MUTANTS= takes the options of tests/mutation/mutate.sh.
mutants: setup-tests
	@JSON=$(JSON) tests/mutation/mutate.sh --jobs $(JOBS) $(MUTANTS)

# Adds a setting, a lobe, an accelerator, a method of indirect light and a device to a copy of the sources, one at a time,
# and runs the suites that loop over their lists. TRIALS= names some of them.
trials: setup-tests
	tests/trials/trial.sh $(TRIALS)

# Simulates sessions of a device and its servers in which something goes wrong, in JOBS processes. SEED= starts at that seed;
# a failing session prints its own, and make faults SESSIONS=1 SEED=n repeats it. Without SEED= the full tests over sockets
# follow.
SESSIONS ?= 100000
SEED ?= 1
faults: setup-tests configure
	cmake --build $(BUILD) -j$(JOBS) --target test_remote
	@share=$$((($(SESSIONS) + $(JOBS) - 1) / $(JOBS))); [ $$share -gt 0 ] || exit 2; \
	for first in $$(seq $(SEED) $$share $$(($(SEED) + $(SESSIONS) - 1))); do echo $$first; done | \
	xargs -P $(JOBS) -I {} sh -c 'POCKETRAY_FAULT_SEED={} POCKETRAY_FAULT_SESSIONS='$$share' \
	  $(BUILD)/test_remote --no-intro --test-case="faults_simulated*"'
	@[ $(SEED) != 1 ] || POCKETRAY_FAULT_SESSIONS=$(SESSIONS) $(BUILD)/test_remote --no-intro --test-case="faults_over_sockets*"

# A render server and an emulated handheld: in a window if there is a display; otherwise renders some frames and prints the
# split of the last one.
EMULATE ?= tablet
DEMO_SCENE := $(if $(filter command line environment,$(origin SCENE)),$(SCENE),seesaw)
demo-split: configure
	cmake --build $(BUILD) -j$(JOBS) --target pocketray
	@log=$$(mktemp); trap 'kill $$server 2>/dev/null; rm -f $$log' EXIT; \
	$(POCKETRAY) serve --listen 127.0.0.1:0 >$$log & server=$$!; \
	for i in $$(seq 100); do grep -q '^listening' $$log && break; kill -0 $$server 2>/dev/null || exit 1; sleep 0.1; done; \
	cat $$log; address=$$(sed -n 's/^listening on \([^ ]*[0-9]\).*/\1/p' $$log); \
	if [ -n "$$DISPLAY$$WAYLAND_DISPLAY" ]; then \
	  $(POCKETRAY) view $(DEMO_SCENE) --emulate $(EMULATE) --server $$address; \
	else \
	  mkdir -p $(BUILD)/demo && $(POCKETRAY) render $(DEMO_SCENE) --frames 0:24 --emulate $(EMULATE) --server $$address \
	    -o $(BUILD)/demo/$(DEMO_SCENE).png; \
	fi

# What a hostile peer or file can do: runs libFuzzer on each target for FUZZ_SECONDS, from the committed corpus on. New inputs
# go to build-fuzz/corpus, those that break something to build-fuzz.
FUZZ_SECONDS ?= 600
FUZZ_TARGETS ?= message pray import gltf front text client server
fuzz:
	@toolchains/setup.sh desktop clang
	@mkdir -p build-fuzz && cmake -S . -B build-fuzz -DCMAKE_C_COMPILER=clang -DCMAKE_CXX_COMPILER=clang++ \
	  -DPOCKETRAY_SANITIZE=fuzzer-no-link,address,undefined >build-fuzz/configure.log || { cat build-fuzz/configure.log; exit 1; }
	cmake --build build-fuzz -j$(JOBS) --target $(FUZZ_TARGETS:%=fuzz_%)
	@for target in $(FUZZ_TARGETS); do \
	  mkdir -p build-fuzz/corpus/$$target; \
	  build-fuzz/fuzz_$$target -max_total_time=$(FUZZ_SECONDS) -max_len=16384 -timeout=10 -print_final_stats=1 \
	    -artifact_prefix=build-fuzz/$$target- build-fuzz/corpus/$$target tests/fuzz/corpus/$$target \
	    >build-fuzz/$$target.log 2>&1 || { tail -n 40 build-fuzz/$$target.log; exit 1; }; \
	  grep -E '^#[0-9]+.*(DONE)|stat::number_of_executed' build-fuzz/$$target.log | sed "s/^/$$target: /"; \
	done

# Flips bits of the models in ../shared/scenes FLIPS times, in JOBS processes; imports, bakes and renders them. Nothing may
# crash, run forever or use unbounded memory. A failing flip prints its number; make flips FLIP=n repeats it.
FLIPS ?= 100000
FLIP ?=
flips: setup-tests configure
	cmake --build $(BUILD) -j$(JOBS) --target test_import
	@share=$(if $(FLIP),1,$$((($(FLIPS) + $(JOBS) - 1) / $(JOBS)))); \
	for first in $(or $(FLIP),$$(seq 1 $$share $(FLIPS))); do echo $$first; done | \
	xargs -P $(JOBS) -I {} env POCKETRAY_FLIP={} POCKETRAY_FLIPS=$$share \
	  $(BUILD)/test_import --no-intro --test-case="flips_*"

# Compares the chosen split with a sweep of fixed ones: every device, one to three servers, three scenes.
split-table: setup-tests configure
	cmake --build $(BUILD) -j$(JOBS) --target test_split_report
	$(BUILD)/test_split_report --no-skip --test-case=split_report_table

# Motion to photon over links that lose packets, with and without dropping pictures.
motion-table: setup-tests configure
	cmake --build $(BUILD) -j$(JOBS) --target test_remote
	$(BUILD)/test_remote --no-skip --test-case=motion_to_photon_table

bench: configure
	cmake --build $(BUILD) -j$(JOBS) --target pocketray
	$(POCKETRAY) bench $(SCENE) --json -

# Comparisons with other ray tracers. Without SCENE=, all scenes. Make's own messages go to stderr, so that JSON=- can be
# piped.
setup-bench-%:
	@toolchains/setup.sh bench-$* >&2

BENCH_SCENE := $(if $(filter command line environment,$(origin SCENE)),$(SCENE))
ifeq ($(CLASS),)
bench-embree: setup-bench-embree configure
	@cmake --build $(BUILD) -j$(JOBS) --target bench_embree >&2
	@$(BUILD)/bench_embree $(BENCH_SCENE:%=--scene %) $(JSON:%=--json %) \
	  $(BUILD_JSON:%=--build-json %) $(BENCH_OPTIONS)
else
bench-embree: configure
	@$(MAKE) --no-print-directory DEVICE= CROSS_PREFIX= all >&2
	@toolchains/embree.sh $(CLASS) $(BUILD)-embree >&2 && cmake --build $(BUILD)-embree -j$(JOBS) --target embree_cost >&2
	@tests/bench/device/embree_cost.py $(CLASS) $(BUILD)-embree/embree_cost $(BUILD)-embree/packages build/pocketray \
	  $(JSON:%=--json %) $(BENCH_OPTIONS) $(BENCH_SCENE)
endif

bench-povray: setup-bench-povray configure
	@cmake --build $(BUILD) -j$(JOBS) --target bench_povray >&2
	@$(BUILD)/bench_povray $(JSON:%=--json %) $(BENCH_OPTIONS)

# Sample models beside Cycles' pictures of them, the worst first. MODELS= names some; SHEET_OPTIONS= as its --help says.
contact-sheet: configure
	@toolchains/setup.sh contact-sheet
	cmake --build $(BUILD) -j$(JOBS) --target pocketray
	@tests/materials/contact_sheet.py $(POCKETRAY) --folder $(BUILD)/contact-sheet $(if $(MODELS),--models $(MODELS)) \
	  $(JSON:%=--json %) $(SHEET_OPTIONS)

# Five rooms, lit by area lights, point lamps, the sun, luminous surfaces and the sky, beside Cycles' pictures of them.
room-sheet: configure
	@toolchains/setup.sh contact-sheet
	cmake --build $(BUILD) -j$(JOBS) --target pocketray
	@tests/materials/room_sheet.py $(POCKETRAY) --folder $(BUILD)/room-sheet $(JSON:%=--json %) $(SHEET_OPTIONS)

# Indirect light of rooms against full light transport: some from a seed, and those of strangers where they are.
ROOMS ?= 56
ROOM_FILES ?= $(wildcard ../shared/scenes/cornell/mcguire/*.obj ../shared/scenes/cornell/embree/*.obj ../shared/scenes/cornell/*.glb)
rooms: setup-tests configure
	cmake --build $(BUILD) -j$(JOBS) --target measure_rooms
	$(BUILD)/measure_rooms --rounds 6 --lights --gaps --random $(ROOMS) $(ROOM_FILES)

# What --budget-ms chooses, beside the best of an exhaustive search: a table of these scenes, about 25 minutes.
S = ../shared/scenes
GOVERNOR_SCENES ?= cornell seesaw $(wildcard $(S)/cornell/mcguire/CornellBox-Original.obj \
  $(S)/cornell/bevy_CornellBox.glb $(S)/rooms/vr-gallery.glb $(S)/rooms/glass-table.glb $(S)/gltf/Duck.glb $(S)/gltf/Fox.glb \
  $(S)/gltf/DamagedHelmet.glb $(S)/gltf/LightsPunctualLamp/LightsPunctualLamp.gltf) lanterns
governor: setup-tests all
	tests/accuracy/governor_oracle.py $(POCKETRAY) $(BUILD)/governor $(GOVERNOR_SCENES)

# Mach bands of radiosity by each reconstruction: a table, and the cube as [Bastos92] figs. 6 and 7 show it.
mach-bands: setup-tests configure
	cmake --build $(BUILD) -j$(JOBS) --target draw_bands
	@mkdir -p $(BUILD)/mach-bands && $(BUILD)/draw_bands $(BUILD)/mach-bands
	@cd $(BUILD)/mach-bands && if command -v montage >/dev/null; then \
	  quads="constant bilinear quadratic cubic bicubic"; pictures=; \
	  triangles="triangles-constant triangles-linear triangles-quadratic triangles-cubic"; \
	  seen() { for name; do pictures="$$pictures -label $$name $$name.ppm"; done; }; \
	  bands() { for name; do pictures="$$pictures -label lateral-inhibition $$name-bands.ppm"; done; }; \
	  seen $$quads; bands $$quads; seen $$triangles reference; bands $$triangles; \
	  montage -font DejaVu-Sans -pointsize 13 -depth 8 $$pictures -tile 5x -geometry 160x120+3+3 mach-bands.png && \
	  echo "the picture: $(BUILD)/mach-bands/mach-bands.png"; \
	else echo "pictures: $(BUILD)/mach-bands/*.ppm (ImageMagick puts them side by side)"; fi

# The packages of a device's launchers: DEVICE=miyoo-mini (OnionUI, MinUI), rg350 (.opk), portmaster. This machine's program
# bakes their scenes.
package: all
	@toolchains/setup.sh desktop package && $(MAKE) -s DEVICE= CROSS_PREFIX= configure && \
	cmake --build build -j$(JOBS) --target pocketray
ifeq ($(DEVICE),portmaster)
	@toolchains/sdl2.sh $(CLASS) $(BUILD)-sdl2 && cmake --build $(BUILD)-sdl2 -j$(JOBS) --target pocketray
endif
	@toolchains/package.sh "$(DEVICE)" $(POCKETRAY) build/pocketray build/packages \
	  $(if $(filter portmaster,$(DEVICE)),$(BUILD)-sdl2/pocketray)

# Counts instructions under emulation. JSON=FILE: also writes them; BENCH_OPTIONS='--effects --symbols 20 --scenes cornell'.
check-bench-class:
	@[ -n "$(CLASS)" ] || { echo "bench-device: for which device? make bench-device DEVICE=armhf" >&2; exit 1; }
	@classes=$$(python3 tests/bench/device/bench_device.py --classes) && case " $$classes " in *" $(CLASS) "*) ;; \
	  *) echo "bench-device: programs of the class $(CLASS) cannot be counted: DEVICE= is a device or one of $$classes" >&2; exit 1 ;; \
	esac

bench-device: check-bench-class configure
	@$(MAKE) --no-print-directory DEVICE= CROSS_PREFIX= all >&2
	@cmake --build $(BUILD) -j$(JOBS) --target pocketray >&2
	@python3 tests/bench/device/bench_device.py $(CLASS) $(POCKETRAY) build/pocketray $(JSON:%=--json %) $(BENCH_OPTIONS)

install: configure
	cmake --build $(BUILD) -j$(JOBS)
	cmake --build $(BUILD) --target install

format:
	@toolchains/setup.sh format
	git ls-files '*.cpp' '*.h' | xargs clang-format -i

tidy: configure
	@toolchains/setup.sh tidy
	cmake --build $(BUILD) -j$(JOBS) --target tidy

clean:
	rm -rf build build-*

help:
	@echo "make              build for this machine into build/"
	@echo "make run          build, then plan, render and time SCENE=$(SCENE); open the viewer if there is a display"
	@echo "make test         build and run all tests (TESTS=regex: only matching ones)"
	@echo "make test-box     boot emulated handhelds and use the program there (MACHINES='cortex-a7 aarch64': some)"
	@echo "make softfloat    compare the arithmetic for CPUs without FPU with this CPU's, 10^9 pairs of floats"
	@echo "make hardcases    run every hard case in full and write $(BUILD)/hardcases.html (JSON=FILE: also write JSON;"
	@echo "                  SHARE=0.01: a share of the inputs; SUITES='hard shade': just these, keeping other suites' results)"
	@echo "make pages        look at the pages of \`pocketray accuracy\` and of the hard cases in Chromium, about 300 MB"
	@echo "make mutants      apply deliberate faults, one at a time: do the tests notice? (MUTANTS=--list: names,"
	@echo "                  MUTANTS='--only x': just that one, JSON=FILE: also write JSON)"
	@echo "make trials       extend a copy of the sources by one entry of each list and test it (TRIALS='lobe device': some)"
	@echo "make faults       simulate SESSIONS=$(SESSIONS) sessions in which links and servers fail (SEED=n: start at that one)"
	@echo "make fuzz         run libFuzzer on messages and files, FUZZ_SECONDS=$(FUZZ_SECONDS) per target"
	@echo "make flips        flip bits of the sample models FLIPS=$(FLIPS) times, import and render them (FLIP=n: just that one)"
	@echo "make governor     compare --budget-ms with an exhaustive search of settings on eleven scenes, 25 minutes"
	@echo "make demo-split   run a render server and an emulated handheld (SCENE=, EMULATE=)"
	@echo "make split-table  compare the chosen split with the best fixed one, for every device"
	@echo "make motion-table measure motion to photon with a server, over links that lose packets"
	@echo "make bench        measure cost per pixel and per effect of SCENE=$(SCENE), as JSON"
	@echo "make bench-embree compare rays per second with Embree (SCENE=x: one scene, JSON=FILE, BUILD_JSON=FILE: write tables,"
	@echo "                  BENCH_OPTIONS='--isa sse2 --rounds 31': see $(BUILD)/bench_embree --help); with DEVICE=aarch64,"
	@echo "                  instructions a ray"
	@echo "make bench-povray compare whole frames with POV-Ray (JSON=FILE: write the table)"
	@echo "make bench-device count instructions and estimated cycles per pixel for DEVICE=, by part (BENCH_OPTIONS=--effects: and"
	@echo "                  by effect; JSON=FILE: write the table)"
	@echo "make contact-sheet render sample models beside Cycles, the worst first (MODELS='Duck Fox': some, JSON=FILE)"
	@echo "make room-sheet   render five lit rooms beside Cycles at full light transport (JSON=FILE, SHEET_OPTIONS='--rooms bar')"
	@echo "make mach-bands    how visible the patches of radiosity are, by reconstruction: a table and a picture"
	@echo "make format       run clang-format on all sources"
	@echo "make tidy         run clang-tidy on all sources"
	@echo "make package      write the packages of launchers for DEVICE=miyoo-mini, rg350 or portmaster to build/packages"
	@echo "make install      install into PREFIX=$(PREFIX) (and DESTDIR)"
	@echo "make clean        remove build/ and build-*/"
	@echo "DEVICE=x          build for a device or CPU class; tests then run under qemu-user"
	@echo "CROSS_PREFIX=x-   build with the compiler x-g++, for DEVICE= or for its own CPU, which CROSS_FLAGS= selects;"
	@echo "                  SYSROOT=, ZLIB= and MBEDTLS= are folders of its C library, zlib and mbedTLS"

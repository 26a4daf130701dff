# Terraclip. `make demo` and `make test` do all their own set-up; see README.md.
#
#   make            the programs, under build/ (config=debug|release|sanitize|thread; others than release under build/<config>/)
#   make demo       default terrain and pictures, into build/demo/
#   make check      fast tests (seconds)          make test    all tests (minutes)
#   make test-extreme  extreme cases, a row each  make report  error against run time, into build/report/ (report-full)
#   make gpu-report what this OpenGL draws and costs, into build/gpu-report/, to be copied to machines with a GPU
#   make soak       a flight of FRAMES=100000     make soak-threads  a shorter one under ThreadSanitizer
#   make bench      measurements                  make format  clang-format over the sources
#   make fuzz       TIME=seconds, all fuzzers together
#   make install    PREFIX=/usr/local DESTDIR=    make clean

config ?= release
PREFIX ?= /usr/local
DESTDIR ?=
VERSION := $(shell cat VERSION)

O := $(if $(filter release,$(config)),build,build/$(config))
OBJ := $(O)/obj

CC ?= cc
CXX ?= c++
WARN := -Wall -Wextra -Wshadow -Wstrict-prototypes -Wmissing-prototypes -Wpointer-arith -Wvla -Werror
WARNXX := -Wall -Wextra -Wshadow -Werror
# -ffp-contract=off: the same heights from every compiler and on every processor. -fno-math-errno: square roots are an
# instruction, with the same result. -fno-trapping-math: nobody asks whether a number overflowed, so that loops with
# comparisons can be done by wide instructions.
# -fvisibility=hidden: what a shared library shows are the functions of its public header, which says so.
COMMON := -g -fPIC -fvisibility=hidden -pthread -ffp-contract=off -fno-math-errno -fno-trapping-math -MMD -MP -I. -I$(O)/gen -DTC_VERSION='"$(VERSION)"' -DTC_PLUGIN_DIR='"$(PREFIX)/lib/terraclip"'
opt.release := -O3 -DNDEBUG
opt.debug := -O0
opt.sanitize := -O1 -fsanitize=address,undefined -fno-sanitize-recover=undefined -fno-omit-frame-pointer
opt.thread := -O1 -fsanitize=thread -fno-omit-frame-pointer
ifeq ($(opt.$(config)),)
$(error config=$(config): expected debug, release, sanitize or thread)
endif
CFLAGS_ALL = -std=c11 -D_GNU_SOURCE $(COMMON) $(opt.$(config)) $(WARN) $(CFLAGS)
CXXFLAGS_ALL = -std=c++17 $(COMMON) $(opt.$(config)) $(WARNXX) $(CXXFLAGS)
LDFLAGS_ALL = -pthread $(filter -fsanitize%,$(opt.$(config))) $(LDFLAGS)
LIBS := -lm -ldl
comma := ,

# Rooms in the order in which data flows; a file includes its own room and rooms before it (tests/cli/test_structure.sh).
# The core has no OpenGL; drawing has; what is left are the programs' own: files of the world, command lines, windows.
CORE_ROOMS := base field synthesis codec/entropy codec/lifting codec/exact codec/lh04 codec/mask chart packed/file packed/read \
              packed/write map imagery view window content blocks measure
DRAW_ROOMS := gl render
APP_ROOMS := input app
SCHEMES := square rings faces

PLUGIN_SRC := $(wildcard common/*/plugin_*.c common/*/plugin_*.cpp)
sources = $(filter-out $(PLUGIN_SRC) %/main.c,$(wildcard $(addsuffix /*.c,$(1))))
CORE := $(call sources,$(addprefix common/,$(CORE_ROOMS)))
DRAW := $(call sources,$(addprefix common/,$(DRAW_ROOMS)) planar spherical)
APP := $(call sources,$(addprefix common/,$(APP_ROOMS)))
DATA := $(filter-out data/main.c,$(wildcard data/*.c))
SHADERS := $(wildcard shaders/*.glsl shaders/*.vert shaders/*.frag)

obj = $(patsubst %,$(OBJ)/%.o,$(basename $(1)))

LIBRARY := $(O)/libterraclip.a
DRAW_LIBRARY := $(O)/libterraclip-draw.a
SONAME := $(firstword $(subst ., ,$(VERSION)))
SHARED := $(O)/libterraclip.so.$(VERSION)
DRAW_SHARED := $(O)/libterraclip-draw.so.$(VERSION)
APP_LIBRARY := $(OBJ)/app.a
PROGRAMS := $(O)/terraclip $(O)/planar-viewer $(O)/planet-viewer
PLUGINS := $(addprefix $(O)/terraclip-,gdal.so oiio.so window.so video.so)

.PHONY: all
all: $(PROGRAMS) $(PLUGINS) $(LIBRARY) $(DRAW_LIBRARY) $(SHARED) $(DRAW_SHARED)

# make V=1 shows the commands.
Q := $(if $(V),,@)
define LINK
@echo "  LINK  $@"
$(Q)$(CC) $(LDFLAGS_ALL) $^ -o $@ $(LIBS)
endef

# ---- Packages: what Debian and its like must have installed ------------------------------------------------------

.PHONY: packages
packages: build/.packages
build/.packages: .ci/packages
	@sh .ci/packages
	@mkdir -p build && touch $@

# ---- Compiling ---------------------------------------------------------------------------------------------------

$(OBJ)/%.o: %.c | build/.packages
	@mkdir -p $(@D)
	@echo "  CC    $<"
	$(Q)$(CC) $(CFLAGS_ALL) $(CPPFLAGS_$(basename $(notdir $<))) -c $< -o $@

$(OBJ)/%.o: %.cpp | build/.packages
	@mkdir -p $(@D)
	@echo "  CXX   $<"
	$(Q)$(CXX) $(CXXFLAGS_ALL) $(CPPFLAGS_$(basename $(notdir $<))) -c $< -o $@

# Flags of outside libraries are asked for only once their packages are there.
GDAL_PLUGIN := $(wildcard common/input/plugin_gdal*.c)
$(foreach part,$(notdir $(basename $(GDAL_PLUGIN))),$(eval CPPFLAGS_$(part) = $$(shell pkg-config --cflags gdal)))
CPPFLAGS_plugin_window = $(shell pkg-config --cflags glfw3)
# Dear ImGui's headers are not held to our warnings.
CPPFLAGS_plugin_display = $(CPPFLAGS_plugin_window) $(patsubst -I%,-isystem %,$(shell pkg-config --cflags imgui))
VIDEO_LIBRARIES := libavformat libavcodec libswscale libavutil
CPPFLAGS_plugin_video = $(shell pkg-config --cflags $(VIDEO_LIBRARIES))
CPPFLAGS_jpeg2000 = $(shell pkg-config --cflags libopenjp2)
CPPFLAGS_coders = $(CPPFLAGS_plugin_gdal)
CPPFLAGS_gdal_coders = $(CPPFLAGS_plugin_gdal)

# Shaders as strings: build/gen/shaders.c defines tc_shader_files[].
$(O)/gen/shaders.c: shaders/embed.sh $(SHADERS)
	@mkdir -p $(@D)
	$(Q)sh shaders/embed.sh $(SHADERS) > $@.tmp && mv $@.tmp $@
$(OBJ)/gen/shaders.o: $(O)/gen/shaders.c | build/.packages
	@mkdir -p $(@D)
	@echo "  CC    $<"
	$(Q)$(CC) $(CFLAGS_ALL) -c $< -o $@

# Schemes by name: build/gen/schemes.c lists their lists, tc_NAME_schemes[] (scheme.h).
$(O)/gen/schemes.c: Makefile
	@mkdir -p $(@D)
	$(Q){ echo '/* made by the Makefile */'; echo '#include "common/render/scheme.h"'; \
	  for s in $(SCHEMES); do echo "extern const tc_scheme tc_$${s}_schemes[];"; done; \
	  echo 'const tc_scheme *const tc_scheme_lists[] = {'; \
	  for s in $(SCHEMES); do echo "    tc_$${s}_schemes,"; done; echo '    0};'; } > $@.tmp && mv $@.tmp $@
$(OBJ)/gen/schemes.o: $(O)/gen/schemes.c | build/.packages
	@mkdir -p $(@D)
	@echo "  CC    $<"
	$(Q)$(CC) $(CFLAGS_ALL) -c $< -o $@

.PHONY: print-core
print-core: # for tests/extreme/compilers.sh
	@echo $(CORE)

CORE_OBJ := $(call obj,$(CORE))
DRAW_OBJ := $(call obj,$(DRAW)) $(OBJ)/gen/shaders.o $(OBJ)/gen/schemes.o
APP_OBJ := $(call obj,$(APP))
DATA_OBJ := $(call obj,$(DATA))

$(LIBRARY): $(CORE_OBJ)
$(DRAW_LIBRARY): $(DRAW_OBJ)
$(APP_LIBRARY): $(APP_OBJ)
$(LIBRARY) $(DRAW_LIBRARY) $(APP_LIBRARY):
	@echo "  AR    $@"
	$(Q)rm -f $@ && $(AR) rcs $@ $^

# The shared libraries. What drawing needs of the core beyond its public functions it brings along, hidden.
$(SHARED): $(CORE_OBJ)
	@echo "  LINK  $@"
	$(Q)$(CC) -shared -Wl,-soname,libterraclip.so.$(SONAME) $(LDFLAGS_ALL) $^ -o $@ $(LIBS)
	$(Q)ln -sf $(@F) $(O)/libterraclip.so.$(SONAME) && ln -sf libterraclip.so.$(SONAME) $(O)/libterraclip.so
$(DRAW_SHARED): $(DRAW_OBJ) $(SHARED) $(LIBRARY)
	@echo "  LINK  $@"
	$(Q)$(CC) -shared -Wl,-soname,libterraclip-draw.so.$(SONAME) -Wl,--exclude-libs,ALL $(LDFLAGS_ALL) $(DRAW_OBJ) \
	    $(SHARED) $(LIBRARY) -o $@ -Wl,--no-undefined $(LIBS)
	$(Q)ln -sf $(@F) $(O)/libterraclip-draw.so.$(SONAME) && ln -sf libterraclip-draw.so.$(SONAME) $(O)/libterraclip-draw.so

$(O)/terraclip: $(OBJ)/data/main.o $(DATA_OBJ) $(APP_LIBRARY) $(DRAW_LIBRARY) $(LIBRARY)
	$(LINK)

$(O)/planar-viewer: $(OBJ)/planar/main.o $(APP_LIBRARY) $(DRAW_LIBRARY) $(LIBRARY)
	$(LINK)

$(O)/planet-viewer: $(OBJ)/spherical/main.o $(APP_LIBRARY) $(DRAW_LIBRARY) $(LIBRARY)
	$(LINK)

$(O)/terraclip-gdal.so: $(call obj,$(GDAL_PLUGIN)) $(OBJ)/common/input/say.o \
    $(addprefix $(OBJ)/common/base/,status.o cache_folder.o outfile.o srgb.o image_levels.o image_memory.o)
	@echo "  LINK  $@"
	$(Q)$(CC) -shared $(LDFLAGS_ALL) $^ -o $@ $$(pkg-config --libs gdal) -lm
$(O)/terraclip-oiio.so: $(OBJ)/common/input/plugin_oiio.o $(OBJ)/common/base/status.o
	@echo "  LINK  $@"
	$(Q)$(CXX) -shared $(LDFLAGS_ALL) $^ -o $@ -lOpenImageIO -lOpenImageIO_Util
$(O)/terraclip-window.so: $(addprefix $(OBJ)/common/,app/plugin_window.o app/plugin_display.o app/icon.o base/status.o)
	@echo "  LINK  $@"
	$(Q)$(CXX) -shared $(LDFLAGS_ALL) $^ -o $@ -Wl,--exclude-libs,ALL $$(pkg-config --libs imgui glfw3)

$(O)/terraclip-video.so: $(OBJ)/common/app/plugin_video.o $(OBJ)/common/base/status.o
	@echo "  LINK  $@"
	$(Q)$(CC) -shared $(LDFLAGS_ALL) $^ -o $@ $$(pkg-config --libs $(VIDEO_LIBRARIES))

# ---- Tests -------------------------------------------------------------------------------------------------------

# tests/fast/test_*.c run in seconds; tests/slow/test_*.c in minutes; tests/extreme/extreme_*.c print a row a case;
# tests/bench/bench_*.c print figures.
# tests/support/*.c is linked into all of them.
LONGER := $(addprefix $(O)/tests/test_,reading_ahead pack pack_both pack_synthesis pack_put views morph image_levels envelope) # are begun first (tests/run.sh)
FAST := $(LONGER) $(filter-out $(LONGER),$(patsubst tests/fast/%.c,$(O)/tests/%,$(wildcard tests/fast/test_*.c)))
SLOW := $(patsubst tests/slow/%.c,$(O)/tests/%,$(wildcard tests/slow/test_*.c))
EXTREME := $(patsubst tests/extreme/%.c,$(O)/tests/%,$(wildcard tests/extreme/extreme_*.c))
BENCH := $(patsubst tests/bench/%.c,$(O)/tests/%,$(wildcard tests/bench/bench_*.c))
SUPPORT_OBJ := $(call obj,$(wildcard tests/support/*.c))
TEST_OBJ := $(SUPPORT_OBJ) $(DATA_OBJ) $(APP_LIBRARY) $(DRAW_LIBRARY) $(LIBRARY)

define test_rule
$(O)/tests/%: $(OBJ)/tests/$(1)/%.o $(TEST_OBJ)
	@mkdir -p $$(@D)
	@echo "  LINK  $$@"
	$$(Q)$$(CC) $$(LDFLAGS_ALL) $$(LDFLAGS_$$*) $$^ -o $$@ $$(LIBS_$$*) -lcmocka $$(LIBS)
endef
$(eval $(call test_rule,fast))
$(eval $(call test_rule,slow))
$(eval $(call test_rule,extreme))
$(eval $(call test_rule,bench))
$(eval $(call test_rule,soak))
$(eval $(call test_rule,gpu))
.SECONDARY:

# Counts what our own objects allocate, not what the driver does (tests/wrapped).
ALLOCATIONS := test_memory test_damage test_hostile test_draw test_refused
$(foreach t,$(ALLOCATIONS),$(eval LDFLAGS_$(t) := $(patsubst %,-Wl$$(comma)--wrap=%,\
    malloc calloc realloc aligned_alloc strdup free)))
$(ALLOCATIONS:%=$(O)/tests/%): $(OBJ)/tests/wrapped/allocations.o

# Replays the fuzzers' seeds through the fuzzers, whose checksums are all 0: no_crc stands before the library.
SEEDS := $(call obj,tests/fuzz/no_crc tests/fuzz/fuzz_reader tests/fuzz/fuzz_tile)
CPPFLAGS_fuzz_reader := -DLLVMFuzzerTestOneInput=fuzz_reader
CPPFLAGS_fuzz_tile := -DLLVMFuzzerTestOneInput=fuzz_tile_decoders
LDFLAGS_test_seeds := $(SEEDS)
$(O)/tests/test_seeds: | $(SEEDS)

# Codecs to compare with; nothing else is linked with them.
CODERS := $(call obj,tests/bench/jpeg2000 tests/bench/coders tests/bench/gdal_coders)
$(O)/tests/bench_pack: $(CODERS)
$(O)/tests/bench_rate_distortion: $(CODERS) $(OBJ)/tests/bench/rate_summary.o
LIBS_bench_pack = $(shell pkg-config --libs gdal libopenjp2)
LIBS_bench_rate_distortion = $(LIBS_bench_pack)
LIBS_test_host_window = -lEGL
# Tests that ask GDAL itself.
$(foreach t,test_formats test_eight_ways test_image_formats test_image_levels test_ellipsoid,$(eval CPPFLAGS_$(t) = $$(shell pkg-config --cflags gdal))\
    $(eval LIBS_$(t) = $$(shell pkg-config --libs gdal)))

# Makes elevation files for the command-line tests.
$(O)/tests/make-file: $(OBJ)/tests/cli/make_file.o $(OBJ)/tests/support/made_files.o
	@mkdir -p $(@D)
	$(LINK)

# Makes pictures for them, and looks at what is drawn.
CPPFLAGS_make_picture = $(CPPFLAGS_plugin_gdal)
$(O)/tests/make-picture: $(OBJ)/tests/cli/make_picture.o
	@mkdir -p $(@D)
	@echo "  LINK  $@"
	$(Q)$(CC) $(LDFLAGS_ALL) $^ -o $@ $$(pkg-config --libs gdal) -lm

# Runs a program and tells what it took.
$(O)/tests/used: $(OBJ)/tests/cli/used.o $(OBJ)/tests/support/process.o
	@mkdir -p $(@D)
	$(LINK)

# Lets files fall on a window.
$(O)/tests/drop-file: $(OBJ)/tests/cli/drop_file.o
	@mkdir -p $(@D)
	@echo "  LINK  $@"
	$(Q)$(CC) $(LDFLAGS_ALL) $^ -o $@ -lX11

# Looks at a window.
$(O)/tests/window-pixels: $(OBJ)/tests/cli/window_pixels.o
	@mkdir -p $(@D)
	$(LINK)

$(O)/tests/extreme_imagery: | $(addprefix $(O)/tests/,make-file make-picture used)

# Compares the samples of two of them.
$(O)/tests/compare-heights: $(OBJ)/tests/cli/compare_heights.o $(APP_LIBRARY) $(DRAW_LIBRARY) $(LIBRARY)
	@mkdir -p $(@D)
	$(LINK)

# What compares schemes, of whose tables tests/cli/test_report.sh knows what they must say.
COMPARED := $(addprefix $(O)/tests/bench_,schemes triangle_size popping hexagons)

.PHONY: check test test-extreme bench report report-full
check: all $(FAST)
	@sh tests/run.sh $(O) $(FAST)

test: all $(FAST) $(SLOW) $(EXTREME) $(O)/tests/make-file $(O)/tests/compare-heights \
      $(O)/tests/make-picture $(O)/tests/used $(O)/tests/window-pixels $(O)/tests/drop-file $(O)/tests/gpu_figures $(COMPARED)
	@mkdir -p $(O)/extreme
	@TERRACLIP_EXTREME=$(O)/extreme sh tests/run.sh $(O) $(SLOW) $(wildcard tests/cli/test_*.sh) $(EXTREME) $(FAST)

# Sweeps whole, of which `make test` looks at a sixth (tests/support/sweep.h).
SWEEPS := $(patsubst %,$(O)/tests/%,$(basename $(notdir $(shell grep -l sweep_ $(wildcard tests/slow/*.c)))))
test-extreme: all $(EXTREME) $(SWEEPS)
	@mkdir -p $(O)/extreme
	@TERRACLIP_SWEEP=whole TERRACLIP_EXTREME=$(O)/extreme sh tests/run.sh $(O) $(SWEEPS) $(EXTREME)

# A long flight: memory stays flat, windows true; and a short one under ThreadSanitizer, in build/thread.
FRAMES ?= 100000
THREAD_FRAMES ?= 3000
.PHONY: soak soak-threads
soak: $(O)/tests/soak
	@TERRACLIP_SOAK_FRAMES=$(FRAMES) sh tests/run.sh $(O) $(O)/tests/soak
soak-threads:
	@$(MAKE) --no-print-directory soak config=thread FRAMES=$(THREAD_FRAMES)

bench: all $(BENCH)
	@for b in $(BENCH); do $$b || exit 1; done

# Measures, and makes a page of it: build/report/index.html. Under 3 minutes; report-full takes about an hour.
report report-full: all $(BENCH) $(EXTREME)
	@sh tests/report/report.sh $(O) $(if $(filter report,$@),quick,full)

# Measures what the machine's OpenGL draws, against a software renderer: build/gpu-report/index.html. The folder can be
# copied to another machine, whose OpenGL its run.sh measures (tests/gpu/run.sh).
GPU_TESTS := $(addprefix test_,watertight globe_watertight faces_watertight rings_precision faces_precision)
.PHONY: gpu-report
gpu-report: $(addprefix $(O)/tests/,gpu_figures $(GPU_TESTS))
	@TERRACLIP_GPU_START=$$(date +%s); export TERRACLIP_GPU_START; \
	sh tests/gpu/folder.sh $(O) $(O)/gpu-report $(GPU_TESTS) && sh $(O)/gpu-report/run.sh

# ---- Fuzzing -----------------------------------------------------------------------------------------------------

# With clang, apart from all other objects. What the fuzzers find new goes to build/fuzz/, not into the tree's corpus;
# `make fuzz-corpus` packs the seeds anew.
TIME ?= 60
FUZZ_O := build/fuzz
FUZZ_CC ?= clang
FUZZ_CFLAGS := -std=c11 -D_GNU_SOURCE -g -O1 -pthread -ffp-contract=off -MMD -MP -I. -DTC_VERSION='"$(VERSION)"' \
               -fsanitize=address,undefined,float-cast-overflow -fno-sanitize-recover=all -fno-omit-frame-pointer
FUZZ_OBJ := $(patsubst %.c,$(FUZZ_O)/%.o,$(filter-out common/base/crc32c.c,$(CORE)) tests/fuzz/no_crc.c)
FUZZERS := $(FUZZ_O)/reader $(FUZZ_O)/tile

$(FUZZ_O)/%.o: %.c
	@mkdir -p $(@D)
	@echo "  FUZZ  $<"
	$(Q)$(FUZZ_CC) $(FUZZ_CFLAGS) -fsanitize=fuzzer-no-link -c $< -o $@
$(FUZZERS): $(FUZZ_O)/%: $(FUZZ_O)/tests/fuzz/fuzz_%.o $(FUZZ_OBJ)
	@echo "  LINK  $@"
	$(Q)$(FUZZ_CC) $(FUZZ_CFLAGS) -fsanitize=fuzzer $^ -o $@ $(LIBS)
$(FUZZ_O)/make-corpus: $(FUZZ_O)/tests/fuzz/make_corpus.o $(FUZZ_OBJ)
	@echo "  LINK  $@"
	$(Q)$(FUZZ_CC) $(FUZZ_CFLAGS) $^ -o $@ $(LIBS)

.PHONY: fuzz fuzz-corpus
fuzz:
	@sh tests/fuzz/run.sh $(FUZZ_O) $(TIME) $(FUZZ_CC) || exit 1

fuzz-corpus: $(FUZZ_O)/make-corpus
	$(FUZZ_O)/make-corpus tests/fuzz/corpus

# ---- Demo --------------------------------------------------------------------------------------------------------

.PHONY: demo
demo: all
	@sh data/demo.sh $(O)

# ---- House-keeping -----------------------------------------------------------------------------------------------

FORMATTED = $(shell git ls-files -co --exclude-standard '*.c' '*.h' '*.cpp')
.PHONY: format install clean
format:
	clang-format -i $(FORMATTED)

# Manual pages and bash completion, of what the programs say of themselves.
COMMANDS := synth pack info extract height
MANUALS := $(O)/man/planar-viewer.1 $(O)/man/planet-viewer.1 $(O)/man/terraclip.1 $(COMMANDS:%=$(O)/man/terraclip-%.1)
what.planar-viewer := shows elevation models as terrains
what.planet-viewer := shows elevation models as planets
what.terraclip := makes, packs and looks into terrains
MAN = awk -v name=$(basename $(@F)) -v version=$(VERSION)
$(O)/man/%.1: $(PROGRAMS) docs/man.awk
	@mkdir -p $(@D)
	$(Q)$(O)/$* --help | $(MAN) -v what='$(what.$*)' -f docs/man.awk > $@
$(O)/man/terraclip-%.1: $(PROGRAMS) docs/man.awk
	@mkdir -p $(@D)
	$(Q)$(O)/terraclip $* --help | $(MAN) -v what="$$($(O)/terraclip --help | sed -n 's/^  $*  *//p')" -f docs/man.awk > $@
$(O)/completion: $(PROGRAMS) docs/completion.awk
	$(Q){ for program in planar-viewer planet-viewer; do echo "@ $$program -"; $(O)/$$program --help; done; \
	for command in $(COMMANDS); do echo "@ terraclip $$command"; $(O)/terraclip $$command --help; done; } | \
	awk -f docs/completion.awk > $@

install: all $(MANUALS) $(O)/completion
	install -d $(DESTDIR)$(PREFIX)/share/man/man1 $(DESTDIR)$(PREFIX)/share/bash-completion/completions
	install -m 644 $(MANUALS) $(DESTDIR)$(PREFIX)/share/man/man1
	for program in terraclip planar-viewer planet-viewer; do \
	install -m 644 $(O)/completion $(DESTDIR)$(PREFIX)/share/bash-completion/completions/$$program || exit 1; done
	install -d $(DESTDIR)$(PREFIX)/bin $(DESTDIR)$(PREFIX)/lib/terraclip $(DESTDIR)$(PREFIX)/lib/pkgconfig $(DESTDIR)$(PREFIX)/include
	install -m 755 $(PROGRAMS) $(DESTDIR)$(PREFIX)/bin
	install -m 644 $(PLUGINS) $(DESTDIR)$(PREFIX)/lib/terraclip
	install -m 644 $(LIBRARY) $(DESTDIR)$(PREFIX)/lib
	install -m 755 $(SHARED) $(DESTDIR)$(PREFIX)/lib
	cp -P $(O)/libterraclip.so $(O)/libterraclip.so.$(SONAME) $(DESTDIR)$(PREFIX)/lib
	install -m 644 common/terraclip.h $(DESTDIR)$(PREFIX)/include
	cd share && for file in applications/*.desktop mime/packages/*.xml icons/hicolor/*/apps/*; do \
	install -D -m 644 $$file $(DESTDIR)$(PREFIX)/share/$$file || exit 1; done
	sed -e 's|@PREFIX@|$(PREFIX)|' -e 's|@VERSION@|$(VERSION)|' docs/terraclip.pc.in > $(DESTDIR)$(PREFIX)/lib/pkgconfig/terraclip.pc

clean:
	rm -rf build

-include $(shell find $(OBJ) $(FUZZ_O) -name '*.d' 2>/dev/null)

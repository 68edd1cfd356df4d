# isolux: `make help` lists the targets. V=1 shows the commands.

VERSION   := 0.1.0
SOVERSION := 0

config ?= release
PREFIX ?= /usr/local
ifeq ($(origin CC),default)
CC := gcc
endif
ifeq ($(origin CXX),default)
CXX := g++
endif
Q := $(if $(V),,@)

# Lowest first; a folder may include those that tools/layers.sh allows.
FOLDERS ?= base math mesh raycast inspect scenes radiosity render

BUILD ?= $(if $(filter release,$(config)),build,build/$(config))

WARNINGS := -Wall -Wextra -Wpedantic -Werror -Wshadow -Wundef -Wpointer-arith -Wwrite-strings
CWARNINGS := $(WARNINGS) -Wstrict-prototypes -Wmissing-prototypes
COMMON   := -I. -fPIC -pthread -ffp-contract=off -D_GNU_SOURCE -DISOLUX_VERSION='"$(VERSION)"'

SANITIZE := address,undefined
OPT_release  := -O3 -fno-math-errno -fno-trapping-math
OPT_debug    := -Og -g
OPT_sanitize := -O1 -g -fsanitize=$(SANITIZE) -fno-sanitize-recover=all -fno-omit-frame-pointer
# GCC's own manual: with a sanitizer this warning errs. The other configurations keep it.
OPT_sanitize += $(if $(findstring clang,$(CC)),,-Wno-maybe-uninitialized)
OPT_coverage := -O0 -g --coverage
OPT_scalar   := -O2 -DISOLUX_SCALAR -fno-tree-vectorize -fno-math-errno -fno-trapping-math
# For make valgrind: memcheck takes thirty times as long, so the tests with most rays cast fewer.
OPT_valgrind := -O2 -g -DISOLUX_MEMCHECK -fno-math-errno -fno-trapping-math
OPT_fuzz     := -O1 -g -fsanitize=fuzzer-no-link,$(SANITIZE) -fno-sanitize-recover=all
OPT := $(OPT_$(config))
ifeq ($(OPT),)
$(error config is one of debug release sanitize coverage scalar valgrind)
endif

# Headers of outside libraries are not ours to warn about. OpenEXR's own C header has a folder.
DEP_PACKAGES := OpenEXR libpng jansson libzip libxxhash assimp glfw3 epoxy imgui
DEP_FOLDERS  := $(patsubst -I%,%,$(shell pkg-config --cflags-only-I $(DEP_PACKAGES) 2>/dev/null))
SYSTEM_INCLUDES := $(addprefix -isystem ,$(filter-out /usr/include,$(sort $(DEP_FOLDERS) \
                     /usr/include/OpenEXR /usr/include/Imath)))
LIBS := -lOpenMeshCore -lassimp -lOpenEXRCore -lpng -ljansson -lzip -lxxhash -lstdc++ -lm
VIEWER_LIBS := -limgui -lstb -lglfw -lepoxy -lGL -ldl

ALL_CFLAGS    = -std=c17 $(OPT) $(COMMON) $(CWARNINGS) $(CFLAGS)
ALL_CXXFLAGS  = -std=c++17 $(OPT) $(COMMON) $(WARNINGS) $(CXXFLAGS)
LINK = $(CC) $(OPT) -pthread

SOURCES := $(sort $(foreach f,$(FOLDERS),$(wildcard $f/*.c $f/*.cpp)))
OBJECTS := $(patsubst %,$(BUILD)/obj/%.o,$(SOURCES))
# The window is part of the program alone: the library needs no screen.
APP_OBJECTS := $(patsubst %,$(BUILD)/obj/%.o,$(sort $(wildcard app/*.c viewer/*.c viewer/*.cpp)))
BENCH_OBJECTS := $(patsubst %,$(BUILD)/obj/%.o,$(sort $(wildcard bench/*.c)))
TESTS := $(sort $(patsubst tests/%.c,%,$(wildcard tests/test_*.c)))
FUZZ  := $(sort $(patsubst tests/fuzz/fuzz_%.c,%,$(wildcard tests/fuzz/fuzz_*.c)))
TEST_OBJECTS := $(TESTS:%=$(BUILD)/obj/tests/%.c.o) $(FUZZ:%=$(BUILD)/obj/tests/fuzz/fuzz_%.c.o) \
                $(BUILD)/obj/tests/fuzz/replay.c.o
SHARED := $(BUILD)/libisolux.so

.PHONY: all
all: $(BUILD)/isolux $(BUILD)/libisolux.a $(SHARED)

# The program's parts, for tests that look into them.
$(BUILD)/app.a: $(filter-out %/main.c.o,$(APP_OBJECTS))
	@rm -f $@
	$(Q)$(AR) rcs $@ $^

$(BUILD)/isolux: $(APP_OBJECTS) $(BUILD)/libisolux.a
	@echo "  LINK $@"
	$(Q)$(LINK) -o $@ $^ $(LDFLAGS) $(VIEWER_LIBS) $(LIBS)

$(BUILD)/libisolux.a: $(OBJECTS) $(BUILD)/sources
	@echo "  AR   $@"
	@rm -f $@
	$(Q)$(AR) rcs $@ $(OBJECTS)

$(SHARED): $(OBJECTS) $(BUILD)/sources
	@echo "  LINK $@"
	$(Q)$(LINK) -shared -Wl,-soname,libisolux.so.$(SOVERSION) -o $@ $(OBJECTS) $(LDFLAGS) $(LIBS)
	@ln -sf libisolux.so $@.$(SOVERSION)

# Files that change when the options or the list of sources do, so that what was made with others is
# made again.
.PHONY: always
$(BUILD)/options: always
	@mkdir -p $(@D)
	@echo '$(CC) $(CXX) $(subst ','\'',$(ALL_CFLAGS) $(ALL_CXXFLAGS))' | cmp -s - $@ || \
	  echo '$(CC) $(CXX) $(subst ','\'',$(ALL_CFLAGS) $(ALL_CXXFLAGS))' >$@
$(BUILD)/sources: always
	@mkdir -p $(@D)
	@echo '$(SOURCES)' | cmp -s - $@ || echo '$(SOURCES)' >$@

# What is missing is told once, before the compiler tells it in its own way.
$(BUILD)/libraries-found: tools/deps.sh
	@CC="$(CC)" CXX="$(CXX)" tools/deps.sh check $(SYSTEM_INCLUDES)
	@mkdir -p $(@D) && touch $@

$(BUILD)/obj/%.c.o: %.c $(BUILD)/options | $(BUILD)/libraries-found
	@mkdir -p $(@D)
	@echo "  CC   $<"
	$(Q)$(CC) $(ALL_CFLAGS) $(SYSTEM_INCLUDES) $(FUZZ_OPTIONS) $(BENCH_OPTIONS) \
	  -MMD -MP -c -o $@ $<

$(BUILD)/obj/%.cpp.o: %.cpp $(BUILD)/options | $(BUILD)/libraries-found
	@mkdir -p $(@D)
	@echo "  CXX  $<"
	$(Q)$(CXX) $(ALL_CXXFLAGS) $(SYSTEM_INCLUDES) -MMD -MP -c -o $@ $<

# A fuzz target is called by the fuzzer, which has no header.
FUZZ_OPTIONS = $(if $(filter tests/fuzz/%,$<),-Wno-missing-prototypes)

.PRECIOUS: $(BUILD)/obj/%.c.o
-include $(OBJECTS:.o=.d) $(APP_OBJECTS:.o=.d) $(BENCH_OBJECTS:.o=.d) $(TEST_OBJECTS:.o=.d)

# --- getting it, seeing it -----------------------------------------------------------------------

# A sub-make uses all cores, unless the user has said how many.
SUBMAKE = $(MAKE) --no-print-directory $(if $(filter -j% --jobserver%,$(MAKEFLAGS)),,-j$(NPROC))
NPROC  := $(shell nproc 2>/dev/null || echo 1)

.PHONY: deps
deps:
	@tools/deps.sh install

DEMO := scenes/files/cornell.msd
.PHONY: demo
demo: deps
	@$(SUBMAKE) all
	@mkdir -p $(BUILD)/demo
	$(BUILD)/isolux render $(DEMO) -o $(BUILD)/demo/cornell.exr
	@echo "The picture:"
	@realpath $(BUILD)/demo/cornell.* | sed 's/^/  /'

# The pictures of docs/viewer.md, on a screen of their own.
.PHONY: viewer-pictures
viewer-pictures: deps
	@$(SUBMAKE) all
	@ISOLUX=$(BUILD)/isolux tools/viewer_pictures.sh docs/images

# --- speed: against Embree where its headers are, which only this program is linked with ----------

EMBREE := $(wildcard /usr/include/embree3/rtcore.h)
BENCH_SCENES ?= cornell cornell100k scenes/third-party/modern-hall/staircase2.obj room

$(BENCH_OBJECTS): BENCH_OPTIONS = $(if $(EMBREE),-DBENCH_EMBREE)
$(BUILD)/raybench: $(BENCH_OBJECTS) $(BUILD)/libisolux.a
	@echo "  LINK $@"
	$(Q)$(LINK) -o $@ $^ $(LDFLAGS) $(LIBS) $(if $(EMBREE),-lembree3)

.PHONY: bench
bench: $(BUILD)/raybench
	$(BUILD)/raybench -o $(BUILD)/bench.json $(BENCH_SCENES)

# --- tests: one program a file, each in a process of its own -------------------------------------

APP_USERS := $(shell grep -lE '^ *\# *include *"(app|viewer)/' tests/test_*.c tests/fuzz/fuzz_*.c 2>/dev/null)
APP_USERS := $(basename $(notdir $(APP_USERS)))
$(APP_USERS:%=$(BUILD)/tests/%) $(APP_USERS:fuzz_%=$(BUILD)/tests/replay_%) \
$(APP_USERS:%=$(BUILD)/%): $(BUILD)/app.a
LINK_INPUTS = $(filter %.o,$^) $(filter %/app.a,$^) $(filter %/libisolux.a,$^)

$(BUILD)/tests/%: $(BUILD)/obj/tests/%.c.o $(BUILD)/libisolux.a
	@mkdir -p $(@D)
	$(Q)$(LINK) -o $@ $(LINK_INPUTS) $(LDFLAGS) -lcmocka \
	  $(if $(filter %/app.a,$^),$(VIEWER_LIBS)) $(LIBS)

# Fuzz targets without the fuzzer: each file of the corpus once.
$(BUILD)/tests/replay_%: $(BUILD)/obj/tests/fuzz/fuzz_%.c.o $(BUILD)/obj/tests/fuzz/replay.c.o \
                         $(BUILD)/libisolux.a
	@mkdir -p $(@D)
	$(Q)$(LINK) -o $@ $(LINK_INPUTS) $(LDFLAGS) $(LIBS)

TEST_PROGRAMS := $(TESTS:%=$(BUILD)/tests/%) $(FUZZ:%=$(BUILD)/tests/replay_%)
TEST_JOBS ?= $(NPROC)

.PHONY: test test-programs test-one
test: deps
	@$(SUBMAKE) all test-programs
	@BUILD="$(BUILD)" CC="$(CC)" OPT="$(OPT)" CONFIG="$(config)" JOBS="$(TEST_JOBS)" \
	  tests/run.sh $(TEST_PROGRAMS) $(sort $(wildcard tests/cli/*.sh))

test-programs: $(TEST_PROGRAMS)

# make test-one T=test_msd FOLDERS="base math mesh scenes"
test-one: $(BUILD)/tests/$(T)
	$(BUILD)/tests/$(T)

.PHONY: valgrind
valgrind:
	@command -v valgrind >/dev/null || { echo "valgrind is missing: apt-get install valgrind"; exit 1; }
	@$(SUBMAKE) config=valgrind BUILD=$(BUILD)/valgrind test-programs
	@JOBS=$(TEST_JOBS) tests/valgrind.sh $(TESTS:%=$(BUILD)/valgrind/tests/%)

.PHONY: coverage
coverage:
	@$(MAKE) --no-print-directory config=coverage test
	@command -v gcovr >/dev/null || { echo "make coverage: the report needs gcovr" >&2; exit 1; }
	@gcovr --root . --object-directory build/coverage/obj $(FOLDERS:%=--filter '%/') \
	  --filter 'app/' --filter 'viewer/' --gcov-ignore-parse-errors --print-summary --html-details \
	  build/coverage/report.html
	@echo "$(CURDIR)/build/coverage/report.html"

# --- fuzzing: clang's libFuzzer ------------------------------------------------------------------

FUZZ_SECONDS ?= 10

$(BUILD)/fuzz_%: $(BUILD)/obj/tests/fuzz/fuzz_%.c.o $(BUILD)/libisolux.a
	@echo "  LINK $@"
	$(Q)$(CC) -fsanitize=fuzzer,$(SANITIZE) -pthread -o $@ $(LINK_INPUTS) $(LDFLAGS) $(LIBS)

.PHONY: fuzz fuzz-programs
fuzz:
	@command -v clang >/dev/null || { echo "make fuzz needs clang" >&2; exit 1; }
	@$(SUBMAKE) config=fuzz CC=clang CXX=clang++ fuzz-programs
	@for name in $(FUZZ); do \
	  echo "fuzz_$$name: $(FUZZ_SECONDS) s"; \
	  mkdir -p build/fuzz/found/$$name tests/fuzz/corpus/$$name; \
	  build/fuzz/fuzz_$$name -max_total_time=$(FUZZ_SECONDS) -timeout=10 -rss_limit_mb=2048 \
	    -print_final_stats=1 -artifact_prefix=build/fuzz/found/$$name- \
	    build/fuzz/found/$$name tests/fuzz/corpus/$$name >build/fuzz/fuzz_$$name.log 2>&1 || \
	    { tail -n 60 build/fuzz/fuzz_$$name.log; exit 1; }; \
	  grep number_of_executed_units build/fuzz/fuzz_$$name.log; \
	done

fuzz-programs: $(FUZZ:%=$(BUILD)/fuzz_%)

# --- the style -----------------------------------------------------------------------------------

.PHONY: layers stats format
layers:
	@tools/layers.sh

stats:
	@tools/stats.sh

format:
	clang-format -i $(wildcard $(foreach f,$(FOLDERS) viewer app tests tests/fuzz,$f/*.c $f/*.h $f/*.cpp))

# --- installing ----------------------------------------------------------------------------------

BINDIR     := $(DESTDIR)$(PREFIX)/bin
LIBDIR     := $(DESTDIR)$(PREFIX)/lib
HEADERDIR  := $(DESTDIR)$(PREFIX)/include/isolux
DOCDIR     := $(DESTDIR)$(PREFIX)/share/doc/isolux
SCENEDIR   := $(DESTDIR)$(PREFIX)/share/isolux/scenes
MANDIR     := $(DESTDIR)$(PREFIX)/share/man/man1
HEADERS     = $(shell tools/headers.sh $(FOLDERS))
DOCUMENTS  := $(wildcard LICENSE README.md CHANGELOG.md docs/*.md)

.PHONY: install install-files uninstall
install: all
	@$(MAKE) --no-print-directory install-files

# What is built, as it is: a test may run this while others use the build.
install-files:
	@install -d $(BINDIR) $(LIBDIR)/pkgconfig $(DOCDIR) $(SCENEDIR) $(MANDIR) \
	  $(FOLDERS:%=$(HEADERDIR)/%)
	@install -m 755 $(BUILD)/isolux $(BINDIR)/isolux
	@install -m 644 $(BUILD)/libisolux.a $(LIBDIR)/libisolux.a
	@install -m 755 $(SHARED) $(LIBDIR)/libisolux.so.$(VERSION)
	@ln -sf libisolux.so.$(VERSION) $(LIBDIR)/libisolux.so.$(SOVERSION)
	@ln -sf libisolux.so.$(SOVERSION) $(LIBDIR)/libisolux.so
	@for header in $(HEADERS); do install -m 644 $$header $(HEADERDIR)/$$header || exit 1; done
	@install -m 644 $(DOCUMENTS) $(DOCDIR)
	@install -m 644 docs/isolux.1 $(MANDIR)
	@for scene in $(wildcard scenes/files/*.*); do install -m 644 $$scene $(SCENEDIR) || exit 1; done
	@printf '%s\n' 'prefix=$(PREFIX)' 'libdir=$${prefix}/lib' \
	  'includedir=$${prefix}/include/isolux' '' 'Name: isolux' \
	  'Description: Radiosity and global illumination' 'Version: $(VERSION)' \
	  'Cflags: -I$${includedir}' 'Libs: -L$${libdir} -lisolux -lm' \
	  'Libs.private: -pthread $(LIBS)' >$(LIBDIR)/pkgconfig/isolux.pc
	@echo "installed in $(DESTDIR)$(PREFIX)"

uninstall:
	rm -f $(BINDIR)/isolux $(LIBDIR)/libisolux.a $(LIBDIR)/libisolux.so*
	rm -f $(LIBDIR)/pkgconfig/isolux.pc $(MANDIR)/isolux.1
	rm -rf $(HEADERDIR) $(DOCDIR) $(DESTDIR)$(PREFIX)/share/isolux

# --- the rest ------------------------------------------------------------------------------------

.PHONY: clean help
clean:
	rm -rf build

help:
	@echo "make            build/isolux, build/libisolux.a, build/libisolux.so"
	@echo "make deps       install the Debian packages it is built from"
	@echo "make demo       deps, build, and a rendered Cornell box in build/demo/"
	@echo "make test       deps, build, and all tests; last line: N passed, N failed"
	@echo "make test-one T=test_msd         one test program"
	@echo "make fuzz       clang's fuzzer on every reader, FUZZ_SECONDS=10 each"
	@echo "make bench      rays per second against Embree (if installed): build/bench.json"
	@echo "make viewer-pictures  the pictures of docs/viewer.md anew"
	@echo "make valgrind   test programs under memcheck, fewer rays in some: build/valgrind/"
	@echo "make coverage   tests with line coverage: build/coverage/report.html"
	@echo "make layers     refuse includes that point upwards"
	@echo "make stats      code budgets: lengths, asserts, tolerances, globals"
	@echo "make format     clang-format over the tree"
	@echo "make install    DESTDIR= PREFIX=/usr/local; make uninstall takes it away"
	@echo "make clean      remove build/"
	@echo
	@echo "config=release|debug|sanitize|coverage|scalar|valgrind; others than release are in build/CONFIG/"
	@echo "CC=clang CXX=clang++ and V=1 (show commands) work with each"

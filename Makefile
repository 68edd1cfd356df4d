# isolux: `make help` lists the targets.

config ?= release
CC     ?= gcc
CXX    ?= g++
PREFIX ?= /usr/local
VERSION := 0.1.0
SOVERSION := 0

# Lowest first; a folder may include those before it (see `make layers`).
FOLDERS ?= base math mesh raycast scenes radiosity render

BUILD ?= $(if $(filter release,$(config)),build,build/$(config))

WARNINGS := -Wall -Wextra -Wpedantic -Werror -Wshadow -Wundef -Wpointer-arith -Wwrite-strings
CWARNINGS := $(WARNINGS) -Wstrict-prototypes -Wmissing-prototypes
COMMON   := -I. -fPIC -pthread -ffp-contract=off -D_GNU_SOURCE -DISOLUX_VERSION='"$(VERSION)"'

OPT_release  := -O3 -fno-math-errno -fno-trapping-math
OPT_debug    := -Og -g
OPT_sanitize := -O1 -g -fsanitize=address,undefined -fno-sanitize-recover=all -fno-omit-frame-pointer
OPT_coverage := -O0 -g --coverage
OPT_scalar   := -O2 -DISOLUX_SCALAR -fno-tree-vectorize -fno-math-errno -fno-trapping-math
OPT := $(OPT_$(config))
ifeq ($(OPT),)
$(error config is one of debug release sanitize coverage scalar)
endif

DEP_PACKAGES := OpenEXR libpng jansson libxxhash assimp
ALL_CFLAGS   := -std=c17 $(OPT) $(COMMON) $(CWARNINGS) $(CFLAGS)
ALL_CXXFLAGS := -std=c++17 $(OPT) $(COMMON) $(WARNINGS) $(CXXFLAGS)
# OpenEXR's own C library; headers of outside libraries are not ours to warn about.
SYSTEM_INCLUDES := -isystem /usr/include/OpenEXR -isystem /usr/include/Imath
LIBS := -lOpenMeshCore -lassimp -lOpenEXRCore -lpng -ljansson -lxxhash -lstdc++ -lm

SOURCES := $(sort $(foreach f,$(FOLDERS),$(wildcard $f/*.c $f/*.cpp)))
OBJECTS := $(patsubst %,$(BUILD)/obj/%.o,$(SOURCES))
APP_SOURCES := $(sort $(wildcard app/*.c))
APP_OBJECTS := $(patsubst %,$(BUILD)/obj/%.o,$(APP_SOURCES))
TESTS := $(sort $(patsubst tests/%.c,%,$(wildcard tests/test_*.c)))

.PHONY: all
all: $(BUILD)/isolux $(BUILD)/libisolux.a $(BUILD)/libisolux.so

$(BUILD)/isolux: $(APP_OBJECTS) $(BUILD)/libisolux.a
	$(CC) $(OPT) -pthread -o $@ $^ $(LDFLAGS) $(LIBS)

$(BUILD)/libisolux.a: $(OBJECTS)
	@rm -f $@
	$(AR) rcs $@ $^

$(BUILD)/libisolux.so: $(OBJECTS)
	$(CC) $(OPT) -shared -pthread -Wl,-soname,libisolux.so.$(SOVERSION) -o $@ $^ $(LDFLAGS) $(LIBS)

$(BUILD)/obj/%.c.o: %.c
	@mkdir -p $(@D)
	$(CC) $(ALL_CFLAGS) $(SYSTEM_INCLUDES) -MMD -MP -c -o $@ $<

$(BUILD)/obj/%.cpp.o: %.cpp
	@mkdir -p $(@D)
	$(CXX) $(ALL_CXXFLAGS) $(SYSTEM_INCLUDES) -MMD -MP -c -o $@ $<

# --- tests: one program a file, each in a process of its own -------------------------------------

$(BUILD)/tests/%: $(BUILD)/obj/tests/%.c.o $(BUILD)/libisolux.a
	@mkdir -p $(@D)
	$(CC) $(OPT) -pthread -o $@ $^ $(LDFLAGS) -lcmocka $(LIBS)

.PHONY: test-one
# make test-one T=test_msd FOLDERS="base math mesh scenes"
test-one: $(BUILD)/tests/$(T)
	$(BUILD)/tests/$(T)

-include $(OBJECTS:.o=.d) $(APP_OBJECTS:.o=.d) $(patsubst %,$(BUILD)/obj/tests/%.c.d,$(TESTS))

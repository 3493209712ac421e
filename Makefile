#: Stormring's Makefile. A target installs the Debian packages that it misses (as root), or names them.
#:
#: For users
#:   make                   builds the programs, in bin/, and static ones for hosts that have none, in build/static/
#:   make demo              renders gears.png on all cores, measures the balance, compares with POV-Ray
#:   make demo-volume       renders the wind of a NetCDF file over a map: wind-smooth.png, wind-surfaces.png
#:   make image             packs the static programs for containers: build/image.tar
#:   make install           PREFIX=/usr/local DESTDIR=; make uninstall removes what was installed
#:   make need              installs what a build needs
#:
#: Tests
#:   make check             one build, and every test of behaviour once: 10 minutes of two idle cores
#:   make reach             sanitizers, mutants, analyzers, models and the second compiler, for what changed since the last
#:                          make nightly that passed; everything takes 10 minutes
#:   make nightly           all tests, longer, with seeds of the date: half an hour of two idle cores; writes
#:                          tests/PASSED
#:   make fresh             as root: make demo in a Debian that has nothing yet; FULL=1: make check there, takes hours
#:   make fuzz              each decoder for FUZZ_SECONDS=600; FUZZ_SEED=1 repeats a run
#:   make soak              minutes of kills and load
#:
#: Measurements (tests/bench/RESULTS.md)
#:   make bench             every benchmark
#:   make bench-volume      vcworker beside VTK, and with light, attenuation and surfaces
#:   make chart             draws the charts of the manual in an hour, on an idle machine; CHARTS=speedup:speedup draws one
#:   make sheet             draws the scenes of spdgen: man/pictures/spd.png
#:   make report            repeats the papers' experiments: report/index.html; FULL=1 takes their numbers of samples
#:
#: Releases
#:   make dist              packs the last commit: stormring-VERSION.tar.gz
#:   make clean             removes what was built
#:
#: BUILD=DIR builds elsewhere; CC, CFLAGS and LDFLAGS are as usual. POSIX=1 takes nothing that
#: POSIX.1-2008 lacks, and builds in build/posix.

# Without make's own rules: one of them makes X from a newer X.sh, even where X is a script.
.SUFFIXES:
CC       = cc
CFLAGS   = -O2 -g
PREFIX   = /usr/local
TO       = '$(subst ','\'',$(DESTDIR)$(PREFIX))'
WARN     = -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wstrict-prototypes -Wmissing-prototypes \
           -Wpointer-arith -Wcast-qual -Wwrite-strings -Wundef -Wvla -Wdouble-promotion
# No contraction into FMA, no fast-math, and no float in double, as c11 has it on s390x: the same bits on every host.
SYSTEM   = $(if $(POSIX),-D_POSIX_C_SOURCE=200809L,-D_GNU_SOURCE) \
           -Werror=implicit-function-declaration
MODEL    = -std=gnu11 $(SYSTEM) -ffp-contract=off -fno-math-errno -Ilib
# Hardened: what this compiler lacks, or warns of with these CFLAGS, is left out. CFLAGS and LDFLAGS come later and win.
HARD     = -fPIE -fstack-protector-strong -fstack-clash-protection -fcf-protection -mbranch-protection=standard
HARD_LD  = -Wl,-z,relro,-z,now $(if $(filter -static,$(CFLAGS) $(LDFLAGS)),,-pie)
FORTIFY  = -U_FORTIFY_SOURCE -D_FORTIFY_SOURCE=
accepted = $(shell $(CC) $(1) $(CFLAGS) -Werror -S -o - -x c -include stdio.h /dev/null >/dev/null 2>&1 && echo '$(1)')
# A sanitizer sees more where the C library does not check first. Found out when something is compiled, and once.
probed   = $(foreach f,$(HARD),$(call accepted,$(f))) $(if $(findstring -fsanitize,$(CFLAGS)),,$(or \
           $(call accepted,$(FORTIFY)3),$(call accepted,$(FORTIFY)2)))
HARDENED = $(eval HARDENED := $(probed))$(HARDENED)
# Five files are compiled for wider vectors, and used only where the machine has them.
X86      = $(findstring x86_64,$(shell $(CC) -dumpmachine))
FLAGS_trace/trace_avx2    = $(if $(X86),-mavx2 -mno-fma)
FLAGS_trace/shade_avx2    = $(FLAGS_trace/trace_avx2)
FLAGS_trace/trace_avx512  = $(FLAGS_volume/volume_avx512)
FLAGS_volume/volume_avx2  = $(FLAGS_trace/trace_avx2)
FLAGS_volume/volume_avx512 = $(if $(X86),-mavx512f -mavx512dq -mavx512vl -mavx512bw -mno-fma -mprefer-vector-width=512)
LIBS     = -Wl,--as-needed -lpng -lz $(if $(ZSTD),-lzstd) -lm
# Another BUILD has programs of its own: make BUILD=build/clang CC=clang
BUILD    = build$(if $(POSIX),/posix)
$(if $(filter 1,$(words $(BUILD))),,$(error BUILD is "$(BUILD)", expected a directory, without blanks in its name))
# There the copies of scripts and scenes would be the files themselves, and clean would remove them.
$(if $(subst $(CURDIR),,$(or $(realpath $(BUILD)),$(abspath $(BUILD)))),,$(error BUILD is "$(BUILD)", the sources, expected another directory))
BIN      = $(if $(filter build,$(BUILD)),bin,$(BUILD)/bin)
FUZZ_SECONDS = 600
FUZZ_SEED    = 0
# Checks of sums of pointers take a quarter of the compiler's time. What such a pointer would reach, address finds.
FUZZ_FLAGS   = -O1 -g1 -fno-omit-frame-pointer -fno-sanitize-recover=all \
               -fsanitize=fuzzer-no-link,address,undefined,float-cast-overflow -fno-sanitize=pointer-overflow

# Five programs need a library each: where it is missing, the others are built, and make says so.
LIBS_nc2vtk   = -lnetcdf $(LIBS_units) $(LIBS_plane)
LIBS_grib2vtk = -leccodes $(LIBS_units) $(LIBS_plane)
LIBS_backdrop = $(LIBS_units) $(LIBS_plane)
LIBS_album = $(LIBS_units)
LIBS_barbs = $(LIBS_units)
LIBS_section = $(LIBS_plane)
LIBS_units    = $(if $(UDUNITS),-ludunits2)
LIBS_plane    = $(if $(PROJ),-lproj)
LIBS_test_heights = $(LIBS_units)
LIBS_test_expression = $(LIBS_units)
LIBS_test_backdrop = $(LIBS_backdrop)
LIBS_test_plane = $(LIBS_plane)
# Of paint, which only stormview has.
LIBS_paint    = $(shell pkg-config --libs pangocairo 2>/dev/null) $(LIBS_units) $(LIBS_plane)
LIBS_test_paint = $(LIBS_paint)
PANGO         = $(patsubst -I%,-isystem %,$(shell pkg-config --cflags pangocairo 2>/dev/null))
FLAGS_paint/paint = $(PANGO)
FLAGS_paint/text  = $(PANGO)
LIBS_tsvstat  = -lgsl -lgslcblas
LIBS_mesh2nff = -lassimp $(if $(JPEG),-ljpeg)
LIBS_stormview = -lSDL2 $(LIBS_paint)
LIBS_vol2vtk  = -lexpat
LIBS_pack     = $(if $(ARCHIVE),-larchive)
LIBS_cropworker = $(LIBS_pack)
LIBS_fuzz_files = $(LIBS_pack)
# PROGRAM:PACKAGE:MODULE of each that is left out. No "#" here: whether it needs a backslash depends on make's version.
lacks    = $(shell $(CC) $(CFLAGS) -E -x c -include $(1) /dev/null >/dev/null 2>&1 || echo $(2))
LACKING := $(call lacks,netcdf.h,nc2vtk:libnetcdf-dev:cf) $(call lacks,eccodes.h,grib2vtk:libeccodes-dev:grib) \
           $(call lacks,gsl/gsl_cdf.h,tsvstat:libgsl-dev:inference) \
           $(call lacks,assimp/cimport.h,mesh2nff:libassimp-dev:mesh) \
           $(call lacks,expat.h,vol2vtk:libexpat1-dev:voxel) \
           $(call lacks,SDL2/SDL.h,stormview:libsdl2-dev:window) \
           $(call lacks,pango/pangocairo.h $(PANGO),stormview:libpango1.0-dev:paint)
# Without this one, records are not packed on slow links.
ZSTD    := $(if $(call lacks,zstd.h,-),,zstd)
# Without this one, nc2vtk, grib2vtk and barbs convert no units, and backdrop computes no dates.
UDUNITS := $(if $(call lacks,udunits2.h,-),,udunits)
# Without this one, nc2vtk and grib2vtk find no places on planes of projection; backdrop and stormview draw no coasts there.
# section refuses grids on them.
PROJ    := $(if $(call lacks,proj.h,-),,libproj)
# Without this one, `pack files` and cropworker take no files along.
ARCHIVE := $(if $(call lacks,archive.h,-),,archive)
# Without this one, mesh2nff reads no textures in JPEG. It needs stdio.h before it.
JPEG    := $(if $(call lacks,stdio.h -include jpeglib.h,-),,jpeg)
part     = $(foreach l,$(LACKING),$(word $(1),$(subst :, ,$(l))))

EVERY    = $(wildcard bin/*.c)
PROGRAMS = $(patsubst bin/%.c,$(BIN)/%,$(filter-out $(patsubst %,bin/%.c,$(call part,1)),$(EVERY)))
SCRIPTS  = $(filter-out $(EVERY) $(EVERY:.c=),$(wildcard bin/*))
# Scripts look for programs beside themselves, so another BUILD has copies of its own.
COPIES   = $(if $(filter-out bin,$(BIN)),$(SCRIPTS:bin/%=$(BIN)/%) \
           $(patsubst %,$(BUILD)/%,$(wildcard tests/experiments/* scenes/* lib/chart/*)))
NO       = $(call part,3)
LIBOBJ   = $(BUILD)/hosts/bootstrap.o $(patsubst lib/%.c,$(BUILD)/%.o,$(filter-out $(NO:%=lib/%/%) \
           lib/coder/$(if $(ZSTD),none,zstd).c lib/files/$(if $(ARCHIVE),none,archive).c \
           lib/os/$(if $(POSIX),linux,posix).c lib/crop/$(if $(POSIX),confine,unconfined).c \
           lib/projection/$(if $(PROJ),none,libproj).c lib/mesh/$(if $(JPEG),none,jpeg).c \
           lib/units/$(if $(UDUNITS),none,udunits).c,$(wildcard lib/*/*.c)))
UNIT     = $(if $(call lacks,cmocka.h,-),,$(patsubst tests/unit/%.c,$(BUILD)/unit/%,\
           $(filter-out $(NO:%=tests/unit/test_%.c) $(if $(ARCHIVE),,tests/unit/test_files.c),$(wildcard tests/unit/test_*.c))))
LIBS_test_inference = $(LIBS_tsvstat)
LIBS_test_mesh = $(LIBS_mesh2nff)
LIBS_fuzz_voxel = $(LIBS_vol2vtk)
LIBS_fuzz_command = $(LIBS_stormview)
LIBS_test_files = $(LIBS_pack)
FUZZERS  = $(patsubst tests/fuzz/%.c,$(BUILD)/%,$(filter-out $(NO:%=tests/fuzz/fuzz_%.c) $(if $(ARCHIVE),,tests/fuzz/fuzz_files.c) \
           $(if $(filter window paint,$(NO)),tests/fuzz/fuzz_command.c),$(wildcard tests/fuzz/fuzz_*.c)))
# With CDPATH, `cd` may go elsewhere, and prints where.
unexport CDPATH
# What tests and measurements run: these programs.
RUN      = @BIN="$$(cd $(BIN) && pwd)"
# Two commands must do: they use all cores without being told.
PARALLEL = $(MAKE) $(if $(filter -j%,$(MAKEFLAGS)),,-j$(shell tests/processors))

# What hosts with send=auto get: programs that need no library there. Left out where a static library is missing, and by
# sanitizers.
archives = $(patsubst -l%,lib%.a,$(filter -l%,$(LIBS))) libc.a
NO_STATIC := $(filter $(archives),$(foreach a,$(archives),$(shell $(CC) -print-file-name=$a)))
EVERY_STATIC = $(patsubst %,$(BUILD)/static/%,deal fan ringctl rtworker vcworker)
STATIC   = $(if $(findstring -fsanitize,$(CFLAGS))$(NO_STATIC),,$(EVERY_STATIC))
# Where Debian's musl-gcc is, they have musl for a C library, and are smaller. libz.a and libzstd.a
# are made for GNU's, but what these programs call there needs nothing that is different. musl-gcc
# does not know that a program can be both static and position independent.
OF_CC   := $(if $(filter cc gcc,$(CC)),$(shell $(CC) -print-multiarch))
MUSL_AT := $(if $(POSIX),,$(wildcard /usr/lib/$(subst gnu,musl,$(OF_CC))/rcrt1.o))
MUSL    := $(if $(MUSL_AT),$(if $(shell command -v musl-gcc 2>&1),musl-gcc))
MUSL_OF  = os base patience geometry task coder wire image scene simd trace grid spec volume \
           stats proc hosts keep pipe fan worker sched drive
MUSL_OBJ = $(patsubst $(BUILD)/%,$(BUILD)/musl/%,$(filter $(MUSL_OF:%=$(BUILD)/%/%.o),$(LIBOBJ)))
ifneq ($(MUSL),)
STATIC_CC = $(MUSL) -idirafter /usr/include -idirafter /usr/include/$(OF_CC)
STATIC_A  = $(BUILD)/musl/libstormring.a
STATIC_LD = -static -nostartfiles \
            -Wl,-pie,--no-dynamic-linker,-z,text,-z,stack-size=8388608 $(MUSL_AT)
STATIC_LIBS = $(foreach l,z $(ZSTD),$(shell $(CC) -print-file-name=lib$l.a))
else
STATIC_CC = $(CC)
STATIC_LD = $(if $(filter /%,$(shell $(CC) -print-file-name=rcrt1.o)),-static-pie,-static)
STATIC_A  = $(BUILD)/libstormring.a
STATIC_LIBS = $(LIBS)
endif

all: $(PROGRAMS) $(COPIES) $(STATIC)
	$(if $(strip $(LACKING)),@set -- $(call part,2); for p in $(call part,1); do echo "make: $$p is not built: $$1 is missing" >&2; shift; done)
	$(if $(NO_STATIC),@echo "make: no static programs for hosts with send=auto: $(NO_STATIC) is missing" >&2)
	$(if $(ZSTD),,@echo "make: fan -z packs nothing: libzstd-dev is missing" >&2)
	$(if $(UDUNITS),,@echo "make: nc2vtk, grib2vtk and barbs convert no units and heights, backdrop computes no dates: libudunits2-dev is missing" >&2)
	$(if $(PROJ),,@echo "make: planes of projection are not used by nc2vtk and grib2vtk, and have no coasts: libproj-dev is missing" >&2)
	$(if $(JPEG),,@echo "make: mesh2nff reads no textures in JPEG: libjpeg-dev is missing" >&2)
	$(if $(ARCHIVE),,@echo "make: pack takes no files for cropworker: libarchive-dev is missing" >&2)

help:
	@sed -n 's/^#: \{0,1\}//p' Makefile

need:
	@tests/need build

demo:
	@tests/need demo
	@$(PARALLEL) -s all
	$(RUN) tests/demo

demo-volume:
	@tests/need volume
	@$(PARALLEL) -s all
	$(RUN) tests/demo-volume

# What cannot be installed is said, and tests that need it are skipped. If this compiles all, and without a warning, the file
# strict tells 02_compilers.t, which otherwise compiles all once more.
COMPILED := $(wildcard $(BUILD)/libstormring.a)
check reach nightly:
	@tests/need build
	@tests/need $(if $(filter nightly,$@),night,check) || [ "$$CI" != true ]
	@mkdir -p $(BUILD)
	@LC_ALL=C $(PARALLEL) -s all unit 2>$(BUILD)/said || { cat $(BUILD)/said >&2; exit 1; }
	@cat $(BUILD)/said >&2; $(if $(COMPILED),:,grep -q warning: $(BUILD)/said || touch $(BUILD)/strict)
	$(RUN) BEGUN=$(shell date +%s) tests/check $@

bench:
	@tests/need bench
	@$(PARALLEL) -s all
	@for test in tests/bench/[0-9]*.sh; do echo "== $$test"; $$test || exit; done

bench-volume:
	@tests/need bench
	@$(PARALLEL) -s all
	@tests/bench/87_volumes.sh

# The first two commands of a new user, on a machine that has nothing yet.
fresh:
	@FULL=$(FULL) tests/fresh

# Minutes of kills and loads, by hand.
soak:
	@tests/need check
	@$(PARALLEL) -s all
	@prove -v tests/soak/*.sh

# Experiments and the names of their charts, in man/pictures. That of limits is without the integrators. All are measured
# before the first is drawn: a new chart makes the commit dirty. tests/bench/60_replay.sh draws the bars of hosts.
CHARTS = balancing:balancing latency:methods speedup:speedup tracing:speed-accuracy casting:volume-accuracy \
         hierarchy:hierarchy limits:limits slaves:slaves
chart:
	@tests/need bench chart
	@$(PARALLEL) -s all
	@for e in $(CHARTS); do table=build/$${e%:*}.tsv; rm -rf $$table*; \
		bin/protocol -o $$table $${e%:*} && bin/protocol -v $${e%:*} $$table || exit; done
	@for e in $(CHARTS); do grep -v 'contour is\|cells are\|rays meet\|only layer\|as a haze' build/$${e%:*}.tsv | \
		bin/chart -l -o man/pictures/$${e#*:}.svg || exit; done

# The scenes of SPD in one picture, for the manual.
sheet:
	@tests/need build chart
	@$(PARALLEL) -s all
	$(RUN) tests/sheet

# What the papers measured, within 20 minutes; FULL=1 takes their numbers of samples. Goes on where it was stopped.
report:
	@tests/need check bench
	@$(PARALLEL) -s all
	@FULL=$(FULL) tests/report

# Each target starts from its committed corpus; what it finds worth keeping stays in build/fuzz.
fuzz:
	@tests/need check
	@$(PARALLEL) -s sanitized OF=fuzzers
	@tests/fuzz/run $(FUZZ_SECONDS) $(FUZZ_SEED)

# For tests: OF=TARGETS with sanitizers.
sanitized:
	@$(MAKE) BUILD=build/fuzz CC=clang CFLAGS='$(FUZZ_FLAGS) $(STRICT)' $(OF)

unit: $(UNIT)
fuzzers: $(FUZZERS)

# Says what to install before a missing compiler or header makes noise.
$(BUILD)/.need:
	@tests/need -n build
	@mkdir -p $(BUILD) && touch $@

$(BUILD)/libstormring.a: $(LIBOBJ)
	@rm -f $@
	$(AR) rcs $@ $(LIBOBJ)
	@echo '$(LIBS)' >$(BUILD)/libs # for programs that are compiled elsewhere

compile  = $(CC) $(MODEL) $(WARN) $(STRICT) $(HARDENED) $(CFLAGS) $(FLAGS_$*) -MMD -MP -c -o $@ $<
$(BUILD)/%.o: lib/%.c | $(BUILD)/.need
	@mkdir -p $(@D)
	$(compile)

# The program that hosts run before a worker that is sent to them.
$(BUILD)/hosts/bootstrap.c: lib/hosts/bootstrap.sh lib/hosts/bootstrap.sed | $(BUILD)/.need
	@mkdir -p $(@D)
	sed -f lib/hosts/bootstrap.sed $< >$@

$(BUILD)/hosts/bootstrap.o: $(BUILD)/hosts/bootstrap.c
	$(compile)

$(PROGRAMS): $(BIN)/%: bin/%.c $(BUILD)/libstormring.a
	@mkdir -p $(BUILD)/dep $(BIN)
	$(CC) $(MODEL) $(WARN) $(STRICT) $(HARDENED) $(CFLAGS) $(HARD_LD) $(LDFLAGS) -MMD -MP -MF $(BUILD)/dep/$*.d -o $@ $< \
		$(BUILD)/libstormring.a $(LIBS) $(LIBS_$*)

$(STATIC): $(BUILD)/static/%: bin/%.c $(STATIC_A)
	@mkdir -p $(@D)
	$(STATIC_CC) $(MODEL) $(WARN) $(STRICT) $(HARDENED) $(CFLAGS) -Wl,-z,relro,-z,now $(LDFLAGS) $(STATIC_LD) \
		-s -o $@ $< $(STATIC_A) $(STATIC_LIBS)

$(BUILD)/musl/libstormring.a: $(MUSL_OBJ)
	@rm -f $@
	$(AR) rcs $@ $(MUSL_OBJ)

# Static programs are stripped: -g would take a fifth of the compiler's time for nothing.
$(BUILD)/musl/%.o: private override CC := $(STATIC_CC)
$(BUILD)/musl/%.o: private override CFLAGS := $(CFLAGS) -g0
$(BUILD)/musl/%.o: lib/%.c | $(BUILD)/.need
	@mkdir -p $(@D)
	$(compile)

$(BUILD)/musl/hosts/bootstrap.o: $(BUILD)/hosts/bootstrap.c
	@mkdir -p $(@D)
	$(compile)

# An image of the static programs for podman, docker and the like: stormring-engines(7)
image: $(BUILD)/image.tar
$(BUILD)/image.tar: tests/image $(STATIC)
	tests/image $@ $(VERSION) $(STATIC)

$(COPIES): $(BUILD)/%: %
	@mkdir -p $(@D)
	cp $< $@

# What policies must do, for their tests.
ORACLES  = $(patsubst tests/oracles/%.c,$(BUILD)/oracles/%.o,$(wildcard tests/oracles/*.c))
$(BUILD)/liboracles.a: $(ORACLES)
	@rm -f $@
	$(AR) rcs $@ $(ORACLES)

$(BUILD)/oracles/%.o: tests/oracles/%.c | $(BUILD)/.need
	@mkdir -p $(@D)
	$(compile)

$(BUILD)/unit/%: tests/unit/%.c $(BUILD)/liboracles.a $(BUILD)/libstormring.a
	@mkdir -p $(@D)
	$(CC) $(MODEL) $(WARN) $(STRICT) $(HARDENED) $(CFLAGS) $(HARD_LD) $(LDFLAGS) -MMD -MP -MF $@.d -o $@ $< $(BUILD)/liboracles.a $(BUILD)/libstormring.a -lcmocka $(LIBS) $(LIBS_$(@F))

$(BUILD)/fuzz_%: tests/fuzz/fuzz_%.c $(BUILD)/libstormring.a
	$(CC) $(MODEL) $(WARN) $(STRICT) $(HARDENED) $(CFLAGS) -fsanitize=fuzzer -MMD -MP -MF $@.d -o $@ $< $(BUILD)/libstormring.a $(LIBS) $(LIBS_$(@F))

install: all
	@tests/install $(TO) $(PROGRAMS) $(SCRIPTS) $(STATIC)

uninstall:
	@tests/install -u $(TO)

VERSION  = $(shell sed -n 's/^.define STORMRING_VERSION "\(.*\)"/\1/p' lib/base/base.h)
dist:
	git archive --prefix=stormring-$(VERSION)/ -o stormring-$(VERSION).tar.gz HEAD

# Another BUILD may be a directory with more in it than what was built.
EVERY_O  = $(BUILD)/hosts/bootstrap.o $(patsubst lib/%.c,$(BUILD)/%.o,$(wildcard lib/*/*.c))
EVERY_MUSL = $(EVERY_O:$(BUILD)/%=$(BUILD)/musl/%)
OF_BUILD = $(BUILD)/.need $(BUILD)/said $(BUILD)/strict $(BUILD)/libstormring.a $(BUILD)/libs $(BUILD)/hosts/bootstrap.c $(BUILD)/liboracles.a $(ORACLES) $(ORACLES:.o=.d) $(EVERY_O) $(EVERY_O:.o=.d) $(EVERY:bin/%.c=$(BUILD)/dep/%.d) \
           $(EVERY_MUSL) $(EVERY_MUSL:.o=.d) $(BUILD)/musl/libstormring.a $(BUILD)/image.tar \
           $(UNIT) $(UNIT:=.d) $(FUZZERS) $(FUZZERS:=.d) $(COPIES) $(EVERY_STATIC)
clean:
	$(if $(filter build,$(BUILD)),rm -rf build report gears.png gears.frags wind-*.png wind-*.frags stormring-*.tar.gz)
	rm -f $(EVERY:bin/%.c=$(BIN)/%) $(OF_BUILD)
	@rmdir -p $(sort $(dir $(OF_BUILD))) 2>/dev/null || :

-include $(LIBOBJ:.o=.d) $(MUSL_OBJ:.o=.d) $(ORACLES:.o=.d) $(wildcard $(BUILD)/dep/*.d $(BUILD)/unit/*.d $(BUILD)/fuzz_*.d)

.PHONY: all help dist image need demo demo-volume check reach nightly fresh bench bench-volume soak chart sheet report fuzz sanitized unit fuzzers install uninstall clean

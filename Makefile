# Stormring: make, make demo, make check, make install PREFIX=/usr/local DESTDIR=

CC       = cc
CFLAGS   = -O2 -g
PREFIX   = /usr/local
WARN     = -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wstrict-prototypes -Wmissing-prototypes \
           -Wpointer-arith -Wcast-qual -Wwrite-strings -Wundef -Wvla -Wdouble-promotion
# No contraction into FMA and no fast-math: the same bits on every host.
MODEL    = -std=c11 -D_GNU_SOURCE -ffp-contract=off -fno-math-errno -Ilib
BUILD    = build

PROGRAMS = $(patsubst bin/%.c,bin/%,$(wildcard bin/*.c))
SCRIPTS  = $(filter-out %.c $(PROGRAMS),$(wildcard bin/*))
LIBOBJ   = $(patsubst lib/%.c,$(BUILD)/%.o,$(wildcard lib/*/*.c))
UNIT     = $(patsubst tests/unit/%.c,$(BUILD)/unit/%,$(wildcard tests/unit/*.c))

all: $(PROGRAMS)

$(BUILD)/libstormring.a: $(LIBOBJ)
	@rm -f $@
	$(AR) rcs $@ $(LIBOBJ)

$(BUILD)/%.o: lib/%.c
	@mkdir -p $(@D)
	$(CC) $(MODEL) $(WARN) $(CFLAGS) $(FLAGS_$(notdir $*)) -MMD -c -o $@ $<

bin/%: bin/%.c $(BUILD)/libstormring.a
	@mkdir -p $(BUILD)/bin
	$(CC) $(MODEL) $(WARN) $(CFLAGS) $(LDFLAGS) -MMD -MF $(BUILD)/bin/$*.d -o $@ $< \
	    $(BUILD)/libstormring.a -Wl,--as-needed -lpng -lz -lm

$(BUILD)/unit/%: tests/unit/%.c $(BUILD)/libstormring.a
	@mkdir -p $(@D)
	$(CC) $(MODEL) $(WARN) $(CFLAGS) $(LDFLAGS) -MMD -MF $@.d -o $@ $< \
	    $(BUILD)/libstormring.a -lcmocka -Wl,--as-needed -lpng -lz -lm

unit: $(UNIT)

clean:
	rm -rf $(BUILD) $(PROGRAMS)

-include $(LIBOBJ:.o=.d) $(wildcard $(BUILD)/bin/*.d) $(wildcard $(BUILD)/unit/*.d)

.PHONY: all unit clean

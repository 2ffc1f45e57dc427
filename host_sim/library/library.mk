# library.mk - libcontactplant for a user's own program, and what is installed.
#   make install PREFIX=/usr DESTDIR=stage LIBDIR=/usr/lib64
#   make lib CROSS=arm-none-eabi- LIB_FLAGS="-mcpu=cortex-m7 -mthumb -mfpu=fpv5-d16 -mfloat-abi=hard"
VERSION := $(shell sed -n 's/^.define CONTACTPLANT_VERSION *"\(.*\)"/\1/p' host_sim/library/contactplant.h)
ABI     := $(shell sed -n 's/^.define CONTACTPLANT_ABI *\([0-9]*\).*/\1/p' host_sim/library/contactplant.h)
PREFIX  = /usr/local
DESTDIR =
LIBDIR  = $(PREFIX)/lib
CROSS   =
LIB_FLAGS =

# The core, what reads a scene, what talks to a plant: no file, no socket, no clock.
LIB_SRC := $(CORE_SRC) $(LIB_HOST) $(LIB_CLIENT) hal/link/cannelloni.c $(if $(CROSS),,hal/posix/check_host.c)
# The host's library has the program's objects, one for firmware a build of its own.
ROOM     = $(BUILD)$(if $(CROSS),/lib-$(CROSS:%-=%))
PUBLIC   = $(ROOM)/libcontactplant.a
SHARED   = $(BUILD)/libcontactplant.so.$(ABI)
LIB_OBJ  = $(if $(CROSS),$(LIB_SRC:%.c=$(ROOM)/%.o),$(call obj,$(LIB_SRC)))

lib: $(PUBLIC) $(if $(CROSS),,$(SHARED)) $(ROOM)/contactplant-config.cmake ## libcontactplant.a and libcontactplant.so; CROSS=arm-none-eabi- LIB_FLAGS=.. for firmware

ifdef CROSS
# A cross compiler may come without a C library: the declarations are enough for it.
HOSTED := $(shell printf '\043include <stdio.h>\n' | $(CROSS)gcc -E - >/dev/null 2>&1 || echo -isystem linker/hosted)
CROSS_MODE = $(SECTIONS) $(HOSTED) $(LIB_FLAGS)
$(ROOM)/flags: FORCE
	@$(call keep_flags,$(CROSS)gcc $(OPT) $(FLAGS) $(EXTRA) $(CROSS_MODE))
$(ROOM)/%.o: SHARED_MODE = $(CROSS_MODE)
$(ROOM)/%.o: %.c $(ROOM)/flags
	@$(info $()  $(CROSS)gcc $<)$(CROSS)gcc $(CFLAGS) $(POSIX) -c $< -o $@
-include $(wildcard $(LIB_OBJ:.o=.d))
endif
# One object, whose hidden symbols become local: a user's own `exact` or `exponential` meets none of ours.
$(ROOM)/libcontactplant.o: $(LIB_OBJ)
	@$(if $(CROSS),$(CROSS)gcc,$(CC)) $(LIB_FLAGS) -r -nostdlib $^ -o $@
	@$(CROSS)objcopy --localize-hidden $@
$(PUBLIC): $(ROOM)/libcontactplant.o
	@rm -f $@
	@$(CROSS)ar rcs $@ $<
# find_package(contactplant) finds it there, too: -D contactplant_DIR=build, or the room of a cross compiler.
POINTER = $(shell $(if $(CROSS),$(CROSS)gcc $(LIB_FLAGS),$(CC) $(EXTRA)) -dM -E -x c /dev/null | sed -n 's/.*__SIZEOF_POINTER__ //p')
$(ROOM)/contactplant-config.cmake: $(addprefix host_sim/library/,cmake.sh contactplant-config.cmake.in contactplant-config-version.cmake.in) $(PUBLIC)
	@ABI=$(ABI) VERSION=$(VERSION) POINTER=$(POINTER) host_sim/library/cmake.sh $(ROOM) $(ROOM) $(ROOM) host_sim/library
$(SHARED): $(LIB_OBJ)
	@$(CC) $(CFLAGS) -shared -Wl,-soname,$(@F) -Wl,--no-undefined -Wl,--gc-sections $^ -lm -o $@
	@ln -sf $(@F) $(BUILD)/libcontactplant.so

install: all ## program, library, header, contactplant.pc, CMake config, man pages, completion, presets: PREFIX=/usr/local DESTDIR= LIBDIR=
	@PREFIX="$(PREFIX)" LIBDIR="$(LIBDIR)" DESTDIR="$(DESTDIR)" ABI=$(ABI) VERSION=$(VERSION) POINTER=$(POINTER) host_sim/library/install.sh install $(BUILD)
	@echo "installed contactplant $(VERSION) in $(DESTDIR)$(PREFIX)"
uninstall: $(BUILD)/contactplant fmu ## removes what make install with the same variables has installed
	@PREFIX="$(PREFIX)" LIBDIR="$(LIBDIR)" DESTDIR="$(DESTDIR)" ABI=$(ABI) VERSION=$(VERSION) POINTER=$(POINTER) host_sim/library/install.sh uninstall $(BUILD)

# For tests that build the library in another way.
lib-sources:
	@echo $(LIB_SRC)
lib-flags:
	@echo $(FLAGS) $(POSIX) $(SHARED_MODE)

.PHONY: lib lib-sources lib-flags install uninstall

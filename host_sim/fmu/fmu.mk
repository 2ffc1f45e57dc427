# fmu.mk - what contactplant fmu packs beside the scene: a binary that any scene fits, and its sources. No client and no bus.
FMU_OWN := host_sim/fmu/fmu.c $(addprefix host_sim/fmu/fmu_,values.c step.c refuse.c variables.c)
FMU_SRC := $(filter-out $(LIB_CLIENT) hal/link/%,$(LIB_SRC)) $(FMU_OWN)
FMU_OWN_OBJ := $(FMU_OWN:host_sim/fmu/%.c=$(BUILD)/fmu_parts/%.o)
FMU_OBJ  = $(call obj,$(filter-out $(FMU_OWN),$(FMU_SRC))) $(FMU_OWN_OBJ)
FMU_PLATFORM = $(shell $(CC) -dumpmachine | sed 's/-.*//')-linux
# The flags that the bits need, and a source's own: an importer that compiles the sources takes them from buildDescription.xml.
FMU_FLAGS = -std=c99 -O2 $(filter -f%,$(FLAGS))
fmu: $(BUILD)/fmu/files ## what contactplant fmu packs into every FMU: binary and sources, in build/fmu

# In a shared library the functions have the standard's own names.
$(FMU_OWN_OBJ): $(BUILD)/fmu_parts/%.o: host_sim/fmu/%.c $(BUILD)/flags
	@mkdir -p $(@D)
	@$(info $()  $(CC) $< for FMUs)$(CC) $(CFLAGS) $(POSIX) -DFMI3_OVERRIDE_FUNCTION_PREFIX -c $< -o $@
$(BUILD)/fmu_parts/fmu.so: $(FMU_OBJ) host_sim/fmu/fmu.map
	@$(CC) $(CFLAGS) -shared -Wl,--version-script=host_sim/fmu/fmu.map -Wl,--no-undefined -Wl,--gc-sections $(FMU_OBJ) -lm -s -o $@
$(BUILD)/fmu/files: $(BUILD)/fmu_parts/fmu.so host_sim/fmu/fmu_parts.sh LICENSE
	@FLAGS="$(FMU_FLAGS)" DEFINITIONS="$(patsubst -D%,%,$(POSIX))" DEPENDENCIES="$(FMU_OBJ:.o=.d)" \
	    host_sim/fmu/fmu_parts.sh $(BUILD) $< $(FMU_PLATFORM) $(FMU_SRC)
-include $(wildcard $(FMU_OWN_OBJ:.o=.d))

# For the test that links them under the sanitizers.
fmu-objects:
	@echo $(FMU_OBJ)

.PHONY: fmu fmu-objects

# The tests' importer: the standard's functions by dlopen, beside the library's own plant. tests/fmi/test_fmi.sh gives it FMUs.
IMPORTER := $(call obj,$(wildcard tests/fmi/*.c) tests/unit/main.c tests/unit/check.c)
$(BUILD)/importer: $(IMPORTER) $(PUBLIC)
	$(link)

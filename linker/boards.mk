# boards.mk - one block a board: compiler, flags, sources, linker script, QEMU. docs/PORTING.md says how to add one.
#   make firmware BOARD=mps2-an500 [MODEL=afm_tip METHOD=taylor]    build/firmware/mps2-an500/contactplant.elf
BOARDS = mps2-an500
BOARD  = mps2-an500
MODEL  = hertz_rig
METHOD = rk4

# Arm MPS2+ with the Cortex-M7 image AN500: hardware double, LAN9118.
mps2-an500_PACKAGES = gcc-arm-none-eabi qemu-system-arm
mps2-an500_CROSS    = arm-none-eabi-
mps2-an500_CPU      = -mcpu=cortex-m7 -mthumb -mfpu=fpv5-d16 -mfloat-abi=hard
mps2-an500_FACTS    = -DBOARD_CLOCK_HZ=25000000 -DBOARD_CAPTURE_VALUES=65536
mps2-an500_SCRIPT   = linker/mps2_an500.ld
mps2-an500_SOURCES  = linker/startup_cortex_m.c hal/cortex_m.c hal/board_mps2.c hal/uart_cmsdk.c hal/lan9118.c $(ETHERNET)
mps2-an500_QEMU     = qemu-system-arm -M mps2-an500 -display none -monitor none -semihosting-config enable=on,target=native

# Shared by boards: the bus on Ethernet; and what every image has.
ETHERNET = hal/net.c hal/ipv4.c hal/cannelloni.c hal/network.c
EVERY    = linker/memory.c hal/board.c hal/console.c

ifeq ($(filter $(BOARD),$(BOARDS)),)
$(error no board "$(BOARD)"; there are: $(BOARDS))
endif

FW       = $(BUILD)/firmware/$(BOARD)
FW_CC    = $($(BOARD)_CROSS)gcc
FW_FLAGS = -O2 -g $(FLAGS) -ffreestanding -isystem linker/include -ffunction-sections -fdata-sections -MMD -MP \
           $($(BOARD)_CPU) $($(BOARD)_FACTS) -DBOARD_NAME='"$(BOARD)"'
FW_LINK  = -nostdlib -T $($(BOARD)_SCRIPT) -Wl,--gc-sections,--fatal-warnings,-Map=$@.map
fw_obj   = $(patsubst %.c,$(FW)/%.o,$(1))
FW_CORE  = $(call fw_obj,$(CORE_SRC) $(EVERY) $($(BOARD)_SOURCES))

$(FW)/%.o: %.c | cross-compiler
	@mkdir -p $(@D)
	@echo "  $(FW_CC) $<"
	@$(FW_CC) $(FW_FLAGS) -c $< -o $@
cross-compiler:
	@command -v $(FW_CC) >/dev/null || { echo "$(FW_CC) is not installed: apt-get install $($(BOARD)_PACKAGES)"; exit 1; }
# The choice of model and method is part of main.o.
$(FW)/choice: FORCE
	@mkdir -p $(@D)
	@echo '$(MODEL) $(METHOD)' | cmp -s - $@ || echo '$(MODEL) $(METHOD)' >$@
$(FW)/firmware/main.o: FW_FLAGS += -DFIRMWARE_MODEL='"$(MODEL)"' -DFIRMWARE_METHOD='"$(METHOD)"'
$(FW)/firmware/main.o: $(FW)/choice

$(FW)/contactplant.elf: $(FW)/firmware/main.o $(FW_CORE)
$(FW)/board_hash.elf: $(call fw_obj,tests/board_hash.c tests/hash_run.c) $(FW_CORE)
$(FW)/board_fault.elf: $(call fw_obj,tests/board_fault.c) $(FW_CORE)
$(FW)/%.elf: $($(BOARD)_SCRIPT) $(wildcard linker/*.ld)
	@$(FW_CC) $($(BOARD)_CPU) $(FW_LINK) $(filter %.o,$^) -lgcc -o $@

firmware: $(FW)/contactplant.elf
	@linker/sizes.sh $(BOARD) $($(BOARD)_CROSS)size $<

# What tests/boards.sh boots.
board-images: $(FW)/contactplant.elf $(FW)/board_hash.elf $(FW)/board_fault.elf
boards:
	@echo $(BOARDS)
# One line of a board's block, for scripts: make -s BOARD=mps2-an500 FACT=QEMU board-fact
board-fact:
	@echo $($(BOARD)_$(FACT))
FORCE:
.PHONY: firmware board-images boards board-fact cross-compiler FORCE

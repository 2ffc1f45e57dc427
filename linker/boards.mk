# boards.mk - one block a board: compiler, flags, sources, linker script, QEMU. docs/guide/porting.md says how to add one.
#   make firmware BOARD=mps2-an500 [MODEL=afm_tip METHOD=taylor SUBSTEPS=32]    build/firmware/mps2-an500/contactplant.elf
#   make firmware BOARD=mps2-an500 SCENE=kb-fig16    a preset (models/scenes/scenes_table.c): its plant, drives, method, frame and substeps
# METHOD and SUBSTEPS (of a frame of 1 ms) are the board's own, where it has any. WAIT=spin: a Cortex-M looks at its clock instead of
# sleeping, for emulators.
BOARDS = mps2-an500 mps2-an386 xlnx-zcu102-r5 riscv-virt
BOARD  = mps2-an500
MODEL  = hertz_rig
METHOD = $(or $($(BOARD)_METHOD),rk4)
SUBSTEPS = $(or $($(BOARD)_SUBSTEPS),64)
SCENE  =
WAIT   =
# Of 1000 ticks, of each trajectory that board_hash.elf runs; at most the 100 of tests/data/hash.txt. Seven have each kind of command and of
# drive (tests/bits/hash_run.c).
BLOCKS  ?= $(or $($(BOARD)_BLOCKS),7)

# Arm MPS2+ with the Cortex-M7 image AN500: hardware double, LAN9118.
mps2-an500_PACKAGES = gcc-arm-none-eabi qemu-system-arm
mps2-an500_BUS      = ethernet
mps2-an500_WATCHDOG = cmsdk
mps2-an500_FAULT_CLOCK = clock
mps2-an500_FAULT_CAUSE = 00010000
mps2-an500_CROSS    = arm-none-eabi-
mps2-an500_CPU      = -mcpu=cortex-m7 -mthumb -mfpu=fpv5-d16 -mfloat-abi=hard
mps2-an500_FACTS    = -DBOARD_CLOCK_HZ=25000000 -DBOARD_CAPTURE_VALUES=65536
mps2-an500_SCRIPT   = linker/mps2_an500.ld
mps2-an500_SOURCES  = linker/startup_cortex_m.c hal/board/cortex_m.c hal/board/cortex_m_end.c hal/board/mps2_counter.c hal/board/board_mps2.c hal/device/uart_cmsdk.c hal/device/cmsdk_watchdog.c hal/device/registers.c hal/ethernet/lan9118.c linker/int64.c $(ETHERNET)
mps2-an500_QEMU     = qemu-system-arm -M mps2-an500 -display none -monitor none -semihosting-config enable=on,target=native -kernel IMAGE

# Arm MPS2 with the Cortex-M4 image AN386: hardware float, double in software, LAN9118. 8 substeps are what a part of
# 168 MHz can do in a millisecond (docs/why/boards.md), 35 in a period of the default rig.
mps2-an386_PACKAGES = gcc-arm-none-eabi qemu-system-arm
mps2-an386_WATCHDOG = cmsdk
mps2-an386_FAULT_CLOCK = clock
mps2-an386_FAULT_CAUSE = 00010000
mps2-an386_CROSS    = arm-none-eabi-
mps2-an386_CPU      = -mcpu=cortex-m4 -mthumb -mfpu=fpv4-sp-d16 -mfloat-abi=hard
mps2-an386_FACTS    = -DBOARD_CLOCK_HZ=25000000 -DBOARD_CAPTURE_VALUES=8192
mps2-an386_METHOD   = rk4_float32
mps2-an386_SUBSTEPS = 8
mps2-an386_BLOCKS   = 4
mps2-an386_SCRIPT   = linker/mps2_an386.ld
mps2-an386_SOURCES  = linker/startup_cortex_m.c linker/soft_sqrt.c hal/board/cortex_m.c hal/board/cortex_m_end.c hal/board/mps2_counter.c hal/board/board_mps2.c hal/device/uart_cmsdk.c hal/device/cmsdk_watchdog.c hal/device/registers.c hal/ethernet/lan9118.c $(ETHERNET)
mps2-an386_QEMU     = qemu-system-arm -M mps2-an386 -display none -monitor none -semihosting-config enable=on,target=native -kernel IMAGE

# A Cortex-R5F of a Xilinx ZCU102: hardware double, CAN. QEMU's cycle counter runs at 1 GHz, a board's at 500 MHz. QEMU starts
# with the R5 switched off: the first application processor (cpu 0) asks its firmware for it (PSCI CPU_ON of 4 at 0x100000), in eight
# instructions at 0x7000000.
xlnx-zcu102-r5_PACKAGES = gcc-arm-none-eabi qemu-system-arm
xlnx-zcu102-r5_BUS      = can
xlnx-zcu102-r5_FAULT_CLOCK = clock
xlnx-zcu102-r5_FAULT_CAUSE = 00000000
xlnx-zcu102-r5_CROSS    = arm-none-eabi-
xlnx-zcu102-r5_CPU      = -mcpu=cortex-r5 -marm -mfpu=vfpv3-d16 -mfloat-abi=hard
xlnx-zcu102-r5_FACTS    = -DBOARD_CLOCK_HZ=1000000000 -DBOARD_CAPTURE_VALUES=65536
xlnx-zcu102-r5_SCRIPT   = linker/xlnx_zcu102_r5.ld
xlnx-zcu102-r5_SOURCES  = linker/startup_cortex_r.c hal/board/cortex_r.c hal/board/cortex_r_base.c hal/board/board_zcu102.c linker/int64.c hal/device/uart_cadence.c hal/can/xilinx_can.c $(CAN)
xlnx-zcu102-r5_QEMU     = qemu-system-aarch64 -M xlnx-zcu102,canbus0=bus,canbus1=bus -object can-bus,id=bus -m 128 -smp 5 \
    -display none -audiodev none,id=quiet -monitor none -semihosting-config enable=on,target=native \
    -device loader,addr=0x7000000,cpu-num=0 \
    -device loader,addr=0x7000000,data=0xF2B88000D2800060,data-len=8 \
    -device loader,addr=0x7000008,data=0xD2A00202D2800081,data-len=8 \
    -device loader,addr=0x7000010,data=0xD4000003D2800003,data-len=8 \
    -device loader,addr=0x7000018,data=0x17FFFFFFD503207F,data-len=8 \
    -device loader,cpu-num=4,file=IMAGE

# QEMU's RISC-V machine with two Kvaser PCIcan cards (SJA1000) on one bus: hardware double.
riscv-virt_PACKAGES = gcc-riscv64-unknown-elf qemu-system-misc
riscv-virt_BUS      = can
riscv-virt_SOCKETCAN = -object can-host-socketcan,id=host,if=vcan0,canbus=bus
riscv-virt_WATCHDOG = i6300esb
riscv-virt_WATCHDOG_DEVICE = -device i6300esb
riscv-virt_FAULT_CLOCK = nothing stops this clock
riscv-virt_FAULT_CAUSE = 00000003
riscv-virt_CROSS    = riscv64-unknown-elf-
riscv-virt_CPU      = -march=rv64gc -mabi=lp64d -mcmodel=medany
riscv-virt_FACTS    = -DBOARD_CLOCK_HZ=10000000 -DBOARD_CAPTURE_VALUES=65536
riscv-virt_SCRIPT   = linker/riscv_virt.ld
riscv-virt_SOURCES  = linker/startup_riscv.c hal/board/riscv.c hal/board/riscv_base.c hal/board/board_riscv_virt.c hal/device/uart_16550.c hal/can/kvaser_pci.c hal/device/i6300esb.c hal/can/sja1000.c $(CAN)
riscv-virt_QEMU     = qemu-system-riscv64 -M virt -m 16 -bios none -display none -monitor none -object can-bus,id=bus \
    -device kvaser_pci,canbus=bus -device kvaser_pci,canbus=bus -kernel IMAGE

# Shared by boards: the bus on Ethernet; and what every image has.
ETHERNET = hal/ethernet/net.c hal/ethernet/ipv4.c hal/link/cannelloni.c hal/ethernet/network.c
CAN      = hal/can/can.c hal/device/registers.c
EVERY    = linker/startup.c linker/memory.c hal/board/board.c hal/board/console.c

ifeq ($(filter $(BOARD),$(BOARDS)),)
$(error no board "$(BOARD)"; there are: $(BOARDS))
endif

ifneq ($(SCENE),)
ifeq ($(shell grep -c '^ *{"$(SCENE)",' models/scenes/scenes_table.c),0)
$(error no scene "$(SCENE)"; contactplant list scenes shows them)
endif
ifneq ($(filter-out file,$(origin MODEL) $(origin METHOD) $(origin SUBSTEPS)),)
$(error SCENE has its own model, method and substeps; leave out MODEL, METHOD and SUBSTEPS)
endif
endif

FW       = $(BUILD)/firmware/$(BOARD)
FW_CC    = $($(BOARD)_CROSS)gcc
FW_FLAGS = -O2 -g1 $(FLAGS) $(EXTRA) $(WERROR) -ffreestanding -isystem linker/include -ffunction-sections -fdata-sections \
           -fstack-usage -MMD -MP $($(BOARD)_CPU) $($(BOARD)_FACTS) -DBOARD_NAME='"$(BOARD)"'
FW_LINK  = -nostdlib -T $($(BOARD)_SCRIPT) -Wl,--gc-sections,--fatal-warnings,-Map=$@.map
fw_obj   = $(patsubst %.c,$(FW)/%.o,$(1))
FW_CORE  = $(call fw_obj,$(CORE_SRC) $(EVERY) $($(BOARD)_SOURCES))

FW_BUILT_WITH := $(FW_CC) -O2 -g1 $(FLAGS) $(EXTRA) $($(BOARD)_CPU) $($(BOARD)_FACTS)
$(FW)/flags: FORCE
	@$(call keep_flags,$(FW_BUILT_WITH))
$(FW)/%.o: %.c $(FW)/flags | cross-compiler
	@$(info $()  $(FW_CC) $<)$(FW_CC) $(FW_FLAGS) -c $< -o $@
cross-compiler:
	@command -v $(FW_CC) >/dev/null || { echo "$(FW_CC) is not installed: apt-get install $($(BOARD)_PACKAGES)"; exit 1; }
# The choice of model, method and substeps is part of main.o, that of the wait of cortex_m.o, of blocks of board_hash.o;
# work_pieces.o has substeps.
$(FW)/choice: FORCE
	@mkdir -p $(@D)
	@echo '$(MODEL) $(METHOD) $(SUBSTEPS) $(SCENE) $(WAIT) $(BLOCKS)' | cmp -s - $@ || echo '$(MODEL) $(METHOD) $(SUBSTEPS) $(SCENE) $(WAIT) $(BLOCKS)' >$@
$(FW)/firmware/main.o: FW_FLAGS += -DFIRMWARE_MODEL='"$(MODEL)"' -DFIRMWARE_METHOD='"$(METHOD)"' \
    -DFIRMWARE_SUBSTEPS=$(SUBSTEPS) $(if $(SCENE),-DFIRMWARE_SCENE='"$(SCENE)"')
$(FW)/hal/board/cortex_m.o: FW_FLAGS += $(if $(filter spin,$(WAIT)),-DBOARD_SPIN=300)
$(FW)/tests/boards/board_hash.o: FW_FLAGS += -DBOARD_BLOCKS=$(BLOCKS)
$(FW)/tests/bench/cost/work_pieces.o: FW_FLAGS += -DBOARD_SUBSTEPS=$(SUBSTEPS)
$(FW)/firmware/main.o $(FW)/hal/board/cortex_m.o $(FW)/tests/boards/board_hash.o $(FW)/tests/bench/cost/work_pieces.o: $(FW)/choice

$(FW)/contactplant.elf: $(FW)/firmware/main.o $(FW_CORE)
$(FW)/board_hash.elf: $(call fw_obj,tests/boards/board_hash.c tests/bits/hash_run.c tests/bits/hash_peak_force.c tests/bits/arithmetic.c) $(FW_CORE)
$(FW)/board_cost.elf: $(call fw_obj,tests/boards/board_cost.c tests/bench/cost/work_pieces.c tests/bench/cost/worst_cases.c tests/bench/rate/rate_cases.c) $(FW_CORE)
$(FW)/rate_board.elf: $(call fw_obj,tests/bench/rate/rate_board.c tests/bench/rate/rate_cases.c) $(FW_CORE)
$(FW)/lever_board.elf: $(call fw_obj,tests/bench/rate/lever_board.c tests/bench/rate/rate_cases.c) $(FW_CORE)
$(FW)/board_fault.elf: $(call fw_obj,tests/boards/board_fault.c) $(FW_CORE)
$(FW)/board_main.elf: FW_LINK += -Wl,--wrap=app_overrun
$(FW)/board_main.elf: $(FW)/firmware/main.o $(call fw_obj,tests/boards/board_main.c) $(FW_CORE)
$(FW)/board_watchdog.elf: $(call fw_obj,tests/boards/board_watchdog.c) $(FW_CORE)
$(FW)/board_can.elf: $(call fw_obj,tests/boards/board_can.c tests/can/can_session.c) $(FW_CORE)
$(FW)/%.elf: $($(BOARD)_SCRIPT) $(wildcard linker/*.ld)
	@$(FW_CC) $($(BOARD)_CPU) $(FW_LINK) $(filter %.o,$^) -lgcc -o $@

firmware: $(FW)/contactplant.elf ## an image for a board: BOARD=mps2-an500 MODEL=hertz_rig METHOD=rk4 SUBSTEPS=64, or SCENE=kb-fig16 (arm-none-eabi-gcc)
	@linker/sizes.sh $(BOARD) $($(BOARD)_CROSS)size $< $(if $(SCENE),81920)
	@$(MAKE) -s IMAGE=contactplant.elf stack-depth
stack-depth:
	@$(PYTHON) tests/house/stack_depth.py $(BOARD) $(FW)/$(IMAGE) $($(BOARD)_CROSS) $(FW)

# What tests/boards/boards.sh boots. No circle among its objects; start-up is left out: it names every handler, and a restart begins there.
board-images: $(FW)/contactplant.elf $(FW)/board_hash.elf $(FW)/board_fault.elf $(FW)/board_main.elf $(FW)/board_cost.elf \
              $(if $(filter can,$($(BOARD)_BUS)),$(FW)/board_can.elf) $(if $($(BOARD)_WATCHDOG),$(FW)/board_watchdog.elf)
	@tests/house/check_circles.sh $($(BOARD)_CROSS)nm $(filter-out $(FW)/linker/%,$(FW_CORE))
boards:
	@echo $(BOARDS)
# What scripts take of a board's block, or of what stands above for all: a line `NAME = value` each.
FACTS = QEMU CROSS METHOD SUBSTEPS BLOCKS PACKAGES BUS SOCKETCAN WATCHDOG WATCHDOG_DEVICE FAULT_CLOCK FAULT_CAUSE
board-facts:
	@:$(foreach fact,$(FACTS),$(info $(fact) = $(or $($(BOARD)_$(fact)),$($(fact)))))
FORCE:
.PHONY: firmware stack-depth board-images boards board-facts cross-compiler FORCE

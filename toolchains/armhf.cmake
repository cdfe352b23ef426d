# 32-bit ARM with NEON, hard float: Cortex-A7 and up (Miyoo Mini class). Used by `make DEVICE=armhf`.
set(CMAKE_SYSTEM_PROCESSOR armv7-a-neon)
set(POCKETRAY_TRIPLE arm-linux-gnueabihf)
set(POCKETRAY_CPU_FLAGS "-mcpu=cortex-a7 -mfpu=neon-vfpv4")
set(CMAKE_CROSSCOMPILING_EMULATOR qemu-arm;-cpu;cortex-a7)
# start_arm.S asks the kernel for these: HWCAP_NEON, VFPv3, VFPv4, IDIVA.
set(POCKETRAY_CPU_NAME "an ARMv7 CPU with NEON and division (Cortex-A7 or later)")
set(POCKETRAY_CPU_VERSION 7)
set(POCKETRAY_CPU_BITS 0x33000)
include(${CMAKE_CURRENT_LIST_DIR}/device.cmake)

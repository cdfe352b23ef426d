# 32-bit ARM with an FPU, but without integer division and perhaps without NEON: Cortex-A8, Cortex-A9. Used by
# `make DEVICE=armv7`.
set(CMAKE_SYSTEM_PROCESSOR armv7-a)
set(POCKETRAY_TRIPLE arm-linux-gnueabihf)
set(POCKETRAY_CPU_FLAGS "-march=armv7-a -mtune=cortex-a8 -mfpu=vfpv3-d16")
set(CMAKE_CROSSCOMPILING_EMULATOR qemu-arm;-cpu;cortex-a9)
# start_arm.S asks the kernel for these: HWCAP_VFPv3.
set(POCKETRAY_CPU_NAME "an ARMv7 CPU with an FPU")
set(POCKETRAY_CPU_VERSION 7)
set(POCKETRAY_CPU_BITS 0x2000)
include(${CMAKE_CURRENT_LIST_DIR}/device.cmake)

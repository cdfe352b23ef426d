# 32-bit ARM without an FPU: ARM926EJ-S (F1C100s class). Used by `make DEVICE=armel`.
set(CMAKE_SYSTEM_PROCESSOR armv5te)
set(POCKETRAY_TRIPLE arm-linux-gnueabi)
set(POCKETRAY_CPU_FLAGS "-mcpu=arm926ej-s -mfloat-abi=soft")
set(CMAKE_CROSSCOMPILING_EMULATOR qemu-arm;-cpu;arm926)
# start_arm.S asks the kernel for these: HWCAP_EDSP.
set(POCKETRAY_CPU_NAME "an ARMv5TE CPU")
set(POCKETRAY_CPU_VERSION 5)
set(POCKETRAY_CPU_BITS 0x80)
include(${CMAKE_CURRENT_LIST_DIR}/device.cmake)

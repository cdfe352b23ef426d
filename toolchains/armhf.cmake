# 32-bit ARM with NEON, hard float: Cortex-A7 and up (Miyoo Mini class). Used by `make DEVICE=armhf`.
set(CMAKE_SYSTEM_PROCESSOR armv7-a)
set(POCKETRAY_TRIPLE arm-linux-gnueabihf)
set(POCKETRAY_CPU_FLAGS "-mcpu=cortex-a7 -mfpu=neon-vfpv4")
set(CMAKE_CROSSCOMPILING_EMULATOR qemu-arm;-cpu;cortex-a7)
include(${CMAKE_CURRENT_LIST_DIR}/device.cmake)

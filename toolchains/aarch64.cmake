# 64-bit ARM: Cortex-A53 and up. Used by `make DEVICE=aarch64`.
set(CMAKE_SYSTEM_PROCESSOR aarch64)
set(POCKETRAY_TRIPLE aarch64-linux-gnu)
set(POCKETRAY_CPU_FLAGS "-mcpu=cortex-a53")
set(CMAKE_CROSSCOMPILING_EMULATOR qemu-aarch64;-cpu;cortex-a53)
include(${CMAKE_CURRENT_LIST_DIR}/device.cmake)

# ARMv4T without an FPU: ARM920T (GP2X). Needs a compiler and C library for it, by prefix: `make DEVICE=armv4t CROSS_PREFIX=…`.
set(CMAKE_SYSTEM_PROCESSOR armv4t)
set(POCKETRAY_CPU_FLAGS "-march=armv4t -mtune=arm920t -mfloat-abi=soft -marm")
set(CMAKE_CROSSCOMPILING_EMULATOR qemu-arm;-cpu;ti925t)
include(${CMAKE_CURRENT_LIST_DIR}/device.cmake)

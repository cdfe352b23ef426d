# Little-endian MIPS32 release 2 with an FPU: RG350, GCW Zero. Used by `make DEVICE=mips32`.
set(CMAKE_SYSTEM_PROCESSOR mips)
set(POCKETRAY_TRIPLE mipsel-linux-gnu)
set(POCKETRAY_CPU_FLAGS "-march=mips32r2 -mhard-float")
set(CMAKE_CROSSCOMPILING_EMULATOR qemu-mipsel;-cpu;24Kf)
include(${CMAKE_CURRENT_LIST_DIR}/device.cmake)

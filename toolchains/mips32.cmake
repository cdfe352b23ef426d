# Little-endian MIPS32 release 2 with an FPU: RG350, GCW Zero. Used by `make DEVICE=mips32`.
set(CMAKE_SYSTEM_PROCESSOR mips)
set(POCKETRAY_TRIPLE mipsel-linux-gnu)
set(POCKETRAY_CPU_FLAGS "-march=mips32r2 -mhard-float")
set(CMAKE_CROSSCOMPILING_EMULATOR qemu-mipsel;-cpu;24Kf)
# start_mips.S tries an instruction.
set(POCKETRAY_CPU_NAME "a CPU of MIPS32 release 2")
include(${CMAKE_CURRENT_LIST_DIR}/device.cmake)

# ARMv6 with an FPU: ARM1176 (Raspberry Pi Zero). Debian's hard-float libraries need ARMv7, so these programs pass floats as the
# soft-float libraries of armel expect and compute them in the FPU. Used by `make DEVICE=armv6`.
set(CMAKE_SYSTEM_PROCESSOR armv6)
set(POCKETRAY_TRIPLE arm-linux-gnueabi)
set(POCKETRAY_CPU_FLAGS "-mcpu=arm1176jzf-s -mfpu=vfpv2 -mfloat-abi=softfp -marm")
set(CMAKE_CROSSCOMPILING_EMULATOR qemu-arm;-cpu;arm1176)
# start_arm.S asks the kernel for these: HWCAP_VFP.
set(POCKETRAY_CPU_NAME "an ARMv6 CPU with an FPU")
set(POCKETRAY_CPU_VERSION 6)
set(POCKETRAY_CPU_BITS 0x40)
include(${CMAKE_CURRENT_LIST_DIR}/device.cmake)

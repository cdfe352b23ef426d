# Shared by all device builds: Debian's cross compiler, libraries from POCKETRAY_SYSROOT only (made by sysroot.sh), one static
# binary without unused code.
set(CMAKE_SYSTEM_NAME Linux)
set(CMAKE_C_COMPILER ${POCKETRAY_TRIPLE}-gcc)
set(CMAKE_CXX_COMPILER ${POCKETRAY_TRIPLE}-g++)
set(CMAKE_C_FLAGS_INIT "${POCKETRAY_CPU_FLAGS} -ffunction-sections -fdata-sections")
set(CMAKE_CXX_FLAGS_INIT "${POCKETRAY_CPU_FLAGS} -ffunction-sections -fdata-sections")
set(CMAKE_EXE_LINKER_FLAGS_INIT "-Wl,--gc-sections")

list(APPEND CMAKE_TRY_COMPILE_PLATFORM_VARIABLES POCKETRAY_SYSROOT)
if(NOT POCKETRAY_SYSROOT)
  message(FATAL_ERROR "Set POCKETRAY_SYSROOT to the output of toolchains/sysroot.sh, or use make DEVICE=")
endif()
set(CMAKE_FIND_ROOT_PATH ${POCKETRAY_SYSROOT})
set(CMAKE_FIND_ROOT_PATH_MODE_PROGRAM NEVER)
set(CMAKE_FIND_ROOT_PATH_MODE_LIBRARY ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_INCLUDE ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_PACKAGE ONLY)
set(ENV{PKG_CONFIG_LIBDIR} ${POCKETRAY_SYSROOT}/lib/pkgconfig)

set(POCKETRAY_STATIC ON CACHE BOOL "one static binary")
set(POCKETRAY_IMPORT OFF CACHE BOOL "read glTF, OBJ and other formats (desktop)")
set(POCKETRAY_ACCURACY OFF CACHE BOOL "measure what accuracy costs in time (desktop)")

# Shared by all device builds: a cross compiler, libraries from POCKETRAY_SYSROOT only (made by sysroot.sh), one static binary
# without unused code. The compiler is Debian's or, with POCKETRAY_CROSS_PREFIX, a vendor's, which may have its own opinion on
# warnings and its own sysroot, POCKETRAY_CROSS_SYSROOT.
set(CMAKE_SYSTEM_NAME Linux)
if(NOT POCKETRAY_CROSS_PREFIX)
  set(POCKETRAY_CROSS_PREFIX ${POCKETRAY_TRIPLE}-)
else()
  set(POCKETRAY_WERROR OFF CACHE BOOL "warnings are errors")
endif()
set(CMAKE_C_COMPILER ${POCKETRAY_CROSS_PREFIX}gcc)
set(CMAKE_CXX_COMPILER ${POCKETRAY_CROSS_PREFIX}g++)
set(POCKETRAY_CPU_FLAGS "${POCKETRAY_CPU_FLAGS} ${POCKETRAY_CROSS_FLAGS}")
if(POCKETRAY_CROSS_SYSROOT)
  set(CMAKE_SYSROOT ${POCKETRAY_CROSS_SYSROOT})
endif()
set(CMAKE_C_FLAGS_INIT "${POCKETRAY_CPU_FLAGS} -ffunction-sections -fdata-sections")
set(CMAKE_CXX_FLAGS_INIT "${POCKETRAY_CPU_FLAGS} -ffunction-sections -fdata-sections")
set(CMAKE_EXE_LINKER_FLAGS_INIT "-Wl,--gc-sections")

list(APPEND CMAKE_TRY_COMPILE_PLATFORM_VARIABLES POCKETRAY_SYSROOT POCKETRAY_CROSS_PREFIX POCKETRAY_CROSS_FLAGS
  POCKETRAY_CROSS_SYSROOT)
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

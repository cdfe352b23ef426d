# 32-bit x86: addresses as narrow as a handheld's, at the speed of this machine and under its sanitizers. For tests only,
# see .ci/run; toolchains/setup.sh x86-32 installs the packages. SSE2 computes floats as written, where the x87 would not.
set(POCKETRAY_M32 "-m32 -march=i686 -msse2 -mfpmath=sse")
set(CMAKE_C_FLAGS_INIT "${POCKETRAY_M32}")
set(CMAKE_CXX_FLAGS_INIT "${POCKETRAY_M32} -isystem /usr/include/x86_64-linux-gnu")  # <asm/…> of the kernel
# Some kernels refuse programs of 32 bits: its own loader tells.
execute_process(COMMAND /lib32/ld-linux.so.2 --version RESULT_VARIABLE POCKETRAY_REFUSED OUTPUT_QUIET ERROR_QUIET)
if(NOT POCKETRAY_REFUSED EQUAL 0)
  set(CMAKE_SYSTEM_NAME Linux)
  set(CMAKE_SYSTEM_PROCESSOR i686)
  set(CMAKE_CROSSCOMPILING_EMULATOR qemu-i386)
endif()
set(ZLIB_LIBRARY /usr/lib32/libz.so CACHE FILEPATH "of lib32z1-dev")
set(ZLIB_INCLUDE_DIR /usr/include CACHE PATH "the same for both widths")
foreach(package PNG SDL2 assimp embree)
  set(CMAKE_DISABLE_FIND_PACKAGE_${package} ON)
endforeach()
set(POCKETRAY_IMPORT OFF CACHE BOOL "read glTF, OBJ and other formats (desktop)")
set(POCKETRAY_RADIOSITY OFF CACHE BOOL "solve radiosity (desktop)")
set(POCKETRAY_ACCURACY OFF CACHE BOOL "measure what accuracy costs in time (desktop)")

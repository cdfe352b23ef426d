# The core: everything a device needs. No exceptions, no RTTI.
file(GLOB_RECURSE POCKETRAY_CORE CONFIGURE_DEPENDS src/base/*.cpp src/scene/*.cpp src/effect/*.cpp src/brdf/*.cpp
  src/accel/*.cpp src/indirect/*.cpp src/shade/*.cpp src/temporal/*.cpp src/present/*.cpp src/plan/*.cpp src/plan/effects/*.cpp src/engine/*.cpp)
if(POCKETRAY_NETWORK)
  file(GLOB POCKETRAY_SPLIT CONFIGURE_DEPENDS src/split/*.cpp src/wire/*.cpp)
  list(APPEND POCKETRAY_CORE ${POCKETRAY_SPLIT})
endif()
add_library(pocketray_core STATIC ${POCKETRAY_CORE})
# Only pocketray_… is visible outside the program or library that the library is linked into.
set_target_properties(pocketray_core PROPERTIES OUTPUT_NAME pocketray EXPORT_NAME pocketray
  CXX_VISIBILITY_PRESET hidden VISIBILITY_INLINES_HIDDEN ON)
target_include_directories(pocketray_core PUBLIC $<BUILD_INTERFACE:${CMAKE_CURRENT_SOURCE_DIR}/src> $<INSTALL_INTERFACE:include>)
target_compile_options(pocketray_core PRIVATE -fno-exceptions -fno-rtti)
target_link_libraries(pocketray_core PUBLIC $<BUILD_INTERFACE:pocketray_flags> ZLIB::ZLIB Threads::Threads)

# -O3 speeds up the kernels: single rays by a twentieth, packets by a sixth (make bench-embree). But pairs of floats that it
# stores as vectors stall when they are read one by one, and GCC up to 13 also computes in the unused lanes of their registers,
# which raises floating-point exceptions by chance (GCC bug 110762).
if(NOT POCKETRAY_SANITIZE)
  foreach(isa baseline fixed neon avx2 avx512)
    set_property(SOURCE src/accel/bvh_kernels_${isa}.cpp APPEND PROPERTY COMPILE_OPTIONS
      -fno-tree-slp-vectorize "$<$<CONFIG:Release>:-O3>")
  endforeach()
endif()
# Kernels compiled again for each instruction set (src/base/isa.h); only box tests are fused, by intrinsics.
if(CMAKE_SYSTEM_PROCESSOR MATCHES "^(x86_64|AMD64)$")
  set_property(SOURCE src/accel/bvh_kernels_avx2.cpp APPEND PROPERTY COMPILE_OPTIONS "-mavx2;-mfma;-mbmi;-mbmi2")
  # GCC up to 12 warns of values that its own AVX-512 headers leave undefined on purpose.
  set_property(SOURCE src/accel/bvh_kernels_avx512.cpp APPEND PROPERTY
    COMPILE_OPTIONS "-mavx2;-mfma;-mbmi;-mbmi2;-mavx512f;-mavx512dq;-mavx512vl;-Wno-uninitialized;$<$<CXX_COMPILER_ID:GNU>:-Wno-maybe-uninitialized>")
endif()

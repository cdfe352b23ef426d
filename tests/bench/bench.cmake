# Instructions a ray on a device, beside Embree's there: tests/bench/device/embree_cost.py counts them.
set(POCKETRAY_EMBREE "" CACHE PATH "folder with Embree's packages for the device, unpacked")
if(POCKETRAY_EMBREE)
  add_executable(embree_cost EXCLUDE_FROM_ALL tests/bench/device/embree_cost.cpp tests/bench/bench_rays.cpp
    tests/bench/bench_scene.cpp tests/bench/embree_side.cpp tests/bench/embree_trace.cpp tests/bench/ours.cpp
    tests/bench/ray_sets.cpp)
  target_include_directories(embree_cost PRIVATE tests)
  target_include_directories(embree_cost SYSTEM PRIVATE ${POCKETRAY_EMBREE}/usr/include)
  file(GLOB embree_library ${POCKETRAY_EMBREE}/usr/lib/*/libembree3.so.3)
  target_link_libraries(embree_cost PRIVATE pocketray_app ${embree_library})
  target_link_options(embree_cost PRIVATE LINKER:--allow-shlib-undefined)
endif()

# Whole frames compared with POV-Ray's, which `make bench-povray` installs and runs.
if(POCKETRAY_BENCH AND NOT CMAKE_CROSSCOMPILING)
  file(GLOB sources CONFIGURE_DEPENDS tests/bench/povray/*.cpp)
  add_executable(bench_povray ${sources})
  target_include_directories(bench_povray PRIVATE tests)
  target_compile_definitions(bench_povray PRIVATE POCKETRAY_CACHE="${CMAKE_CURRENT_BINARY_DIR}/povray")
  target_link_libraries(bench_povray PRIVATE pocketray_app)
endif()

# What encryption costs: tests/bench/device/tls_cost.py counts it.
if(POCKETRAY_HAVE_TLS)
  add_executable(tls_cost EXCLUDE_FROM_ALL tests/bench/device/tls_cost.cpp)
  target_link_libraries(tls_cost PRIVATE pocketray_platform)
endif()
# What rows from a server cost: tests/bench/device/codec_cost.py counts it.
if(POCKETRAY_NETWORK)
  add_executable(codec_cost EXCLUDE_FROM_ALL tests/bench/device/codec_cost.cpp)
  target_link_libraries(codec_cost PRIVATE pocketray_core)
endif()

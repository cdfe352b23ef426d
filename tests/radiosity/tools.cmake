# Writes src/brdf/linear_lobe_table.h.
add_executable(fit_linear_lobes EXCLUDE_FROM_ALL tests/brdf/fit/fit_linear_lobes.cpp)
target_include_directories(fit_linear_lobes PRIVATE tests)
target_link_libraries(fit_linear_lobes PRIVATE pocketray_core)
add_executable(fit_sheen EXCLUDE_FROM_ALL tests/brdf/fit/fit_sheen.cpp)
# The table and the pictures of `make mach-bands`.
if(TARGET pocketray_radiosity AND NOT CMAKE_CROSSCOMPILING)
  add_executable(draw_bands EXCLUDE_FROM_ALL tests/mach_bands/draw_bands.cpp tests/radiosity/mach_bands.cpp)
  target_include_directories(draw_bands PRIVATE tests)
  target_include_directories(draw_bands SYSTEM PRIVATE ${DOCTEST_INCLUDE})
  target_link_libraries(draw_bands PRIVATE pocketray_test_support pocketray_radiosity)
endif()
# The table of `make rooms`.
if(TARGET pocketray_radiosity AND TARGET pocketray_accuracy AND NOT CMAKE_CROSSCOMPILING)
  add_executable(measure_rooms EXCLUDE_FROM_ALL tests/rooms/measure_rooms.cpp tests/radiosity/reference/room_light.cpp
    tests/radiosity/reference/random_room.cpp)
  target_include_directories(measure_rooms PRIVATE tests)
  target_include_directories(measure_rooms SYSTEM PRIVATE ${DOCTEST_INCLUDE})
  target_link_libraries(measure_rooms PRIVATE pocketray_test_support pocketray_radiosity pocketray_accuracy)
  if(TARGET pocketray_import)
    target_link_libraries(measure_rooms PRIVATE pocketray_import)
  endif()
endif()

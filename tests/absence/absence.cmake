# The cost of absent effects: the parts of the core that depend on effects, compiled again with only those that a scene
# calls for. Everything else is linked from the core, and so is the program with all effects.
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_BUILD_TYPE STREQUAL "Release" AND NOT POCKETRAY_SANITIZE AND
   NOT CMAKE_CROSSCOMPILING)
  add_executable(absence_all tests/absence/render_frames.cpp)
  target_link_libraries(absence_all PRIVATE pocketray_test_support)
  file(GLOB sources CONFIGURE_DEPENDS src/plan/*.cpp src/plan/effects/*.cpp src/shade/*.cpp src/engine/*.cpp)
  foreach(build "cornell 0x8c87" "statue 0x3c03" "seesaw 0x23c03" "cube 0x8880" "furnace 0x8081" "lanterns 0x20009c85")
    separate_arguments(build)
    list(GET build 0 scene)
    list(GET build 1 effects)
    add_executable(absence_${scene} tests/absence/render_frames.cpp ${POCKETRAY_TEST_SUPPORT} ${sources})
    target_include_directories(absence_${scene} PRIVATE tests)
    target_compile_definitions(absence_${scene} PRIVATE POCKETRAY_EFFECTS_BUILT=${effects}u)
    target_link_libraries(absence_${scene} PRIVATE pocketray_core)
  endforeach()
  add_test(NAME absence COMMAND bash ${CMAKE_CURRENT_SOURCE_DIR}/tests/absence/absence_test.sh ${CMAKE_CURRENT_BINARY_DIR}
    ${CMAKE_CURRENT_SOURCE_DIR}/tests/absence/counts.txt ${CMAKE_CXX_COMPILER})
  set_tests_properties(absence PROPERTIES SKIP_RETURN_CODE 77)
endif()

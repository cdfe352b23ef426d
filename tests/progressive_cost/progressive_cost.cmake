# What it costs to show a frame coarse first.
if(CMAKE_BUILD_TYPE STREQUAL "Release" AND NOT POCKETRAY_SANITIZE AND NOT CMAKE_CROSSCOMPILING)
  add_executable(progressive_cost tests/progressive_cost/refine_frame.cpp)
  target_link_libraries(progressive_cost PRIVATE pocketray_test_support)
  add_test(NAME progressive_cost COMMAND
    bash ${CMAKE_CURRENT_SOURCE_DIR}/tests/progressive_cost/progressive_cost_test.sh $<TARGET_FILE:progressive_cost>)
  set_tests_properties(progressive_cost PROPERTIES SKIP_RETURN_CODE 77)
endif()

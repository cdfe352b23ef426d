# Packages of launchers, with this machine's program in place of a device's; the exporter from Blender.
if(NOT CMAKE_CROSSCOMPILING)
  add_test(NAME toolchains COMMAND bash ${CMAKE_CURRENT_SOURCE_DIR}/tests/app/toolchains_test.sh ${CMAKE_CURRENT_SOURCE_DIR})
  if(PYTHON3)
    add_test(NAME device_profiles COMMAND ${PYTHON3} ${CMAKE_CURRENT_SOURCE_DIR}/tests/bench/device/profiles_test.py
      ${CMAKE_CURRENT_SOURCE_DIR})
  endif()
  add_test(NAME packages COMMAND bash ${CMAKE_CURRENT_SOURCE_DIR}/tests/packages/packages_test.sh
    ${CMAKE_CURRENT_SOURCE_DIR} $<TARGET_FILE:pocketray_sealed>)
  add_test(NAME blender COMMAND bash ${CMAKE_CURRENT_SOURCE_DIR}/tests/blender/blender_test.sh
    ${CMAKE_CURRENT_SOURCE_DIR} $<TARGET_FILE:pocketray_sealed>)
  set_tests_properties(packages blender PROPERTIES SKIP_RETURN_CODE 77)
endif()

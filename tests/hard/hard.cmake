# `make softfloat`: compares the arithmetic in integers with this CPU's for a thousand million pairs of floats.
add_custom_target(softfloat DEPENDS test_base USES_TERMINAL VERBATIM COMMAND ${CMAKE_COMMAND} -E env
  POCKETRAY_SOFT_PAIRS=1000000000 $<TARGET_FILE:test_base> --test-case=soft_float_*)

# `make hardcases`: runs the tests hard_NN_… of all suites in full. JSON=FILE in the environment also writes the table.
foreach(suite ${POCKETRAY_HARD_SUITES})
  list(APPEND hard_programs $<TARGET_FILE:${suite}>)
endforeach()
string(REPLACE ";" " " emulator "${CMAKE_CROSSCOMPILING_EMULATOR}")
add_custom_target(hardcases DEPENDS ${POCKETRAY_HARD_SUITES} USES_TERMINAL VERBATIM
  COMMAND ${CMAKE_COMMAND} -E env "EMULATOR=${emulator}"
    bash ${CMAKE_CURRENT_SOURCE_DIR}/tests/hard/hardcases.sh ${hard_programs})

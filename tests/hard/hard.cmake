# `make softfloat`: compares the arithmetic in integers with this CPU's for a thousand million pairs of floats.
add_custom_target(softfloat DEPENDS test_base USES_TERMINAL VERBATIM COMMAND ${CMAKE_COMMAND} -E env
  POCKETRAY_SOFT_PAIRS=1000000000 $<TARGET_FILE:test_base> --test-case=soft_float_*)

# An ordinary method as compilers make it by default on CPUs with FMA; ordinary_test.cpp measures its misses.
if(CMAKE_SYSTEM_PROCESSOR MATCHES "^(x86_64|AMD64)$")
  set_source_files_properties(tests/hard/contracted.cpp PROPERTIES COMPILE_OPTIONS "-ffp-contract=fast;-mfma")
else()
  set_source_files_properties(tests/hard/contracted.cpp PROPERTIES COMPILE_OPTIONS "-ffp-contract=fast")
endif()

# `make hardcases`: runs the tests hard_NN_… of all suites and writes hardcases.html. hardcases.sh explains SHARE, SUITES and
# JSON in the environment.
foreach(suite ${POCKETRAY_HARD_SUITES})
  list(APPEND hard_programs $<TARGET_FILE:${suite}>)
endforeach()
string(REPLACE ";" " " emulator "${CMAKE_CROSSCOMPILING_EMULATOR}")
add_custom_target(hardcases DEPENDS ${POCKETRAY_HARD_SUITES} USES_TERMINAL VERBATIM
  COMMAND ${CMAKE_COMMAND} -E env "EMULATOR=${emulator}" "HTML=${CMAKE_CURRENT_BINARY_DIR}/hardcases.html"
    "LINES_FILE=${CMAKE_CURRENT_BINARY_DIR}/hardcases.lines"
    bash ${CMAKE_CURRENT_SOURCE_DIR}/tests/hard/hardcases.sh ${hard_programs})

find_program(PYTHON3 python3)
if(PYTHON3)
  add_test(NAME hard_page COMMAND bash ${CMAKE_CURRENT_SOURCE_DIR}/tests/hard/page_test.sh)
endif()

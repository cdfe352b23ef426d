# The pages of `pocketray accuracy` and of the hard cases in Chromium; skipped without it. `make pages` installs it.
if(PYTHON3 AND TARGET pocketray_accuracy AND NOT CMAKE_CROSSCOMPILING AND NOT POCKETRAY_SANITIZE)
  add_test(NAME pages COMMAND ${PYTHON3} -B ${CMAKE_CURRENT_SOURCE_DIR}/tests/page/pages_test.py $<TARGET_FILE:pocketray>
    ${CMAKE_CURRENT_BINARY_DIR}/pages)
  set_tests_properties(pages PROPERTIES SKIP_RETURN_CODE 77 TIMEOUT 1200)
endif()

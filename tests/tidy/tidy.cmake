# What compilers do not check: rules of sources and documents, the core's objects, an installed copy.
set(tidy ${CMAKE_CURRENT_SOURCE_DIR}/tests/tidy)
if(NOT POCKETRAY_SANITIZE)
  string(TOUPPER "${CMAKE_BUILD_TYPE}" build_type)
  separate_arguments(cpu_flags UNIX_COMMAND "${CMAKE_CXX_FLAGS} ${CMAKE_CXX_FLAGS_${build_type}}")
  add_test(NAME objects COMMAND bash ${tidy}/objects_test.sh ${CMAKE_CURRENT_BINARY_DIR}/CMakeFiles/pocketray_core.dir
    ${CMAKE_NM} ${CMAKE_OBJDUMP} ${CMAKE_CXX_COMPILER} ${cpu_flags})
  if(NOT CMAKE_CROSSCOMPILING)
    add_test(NAME source_rules COMMAND bash ${tidy}/source_rules_test.sh ${CMAKE_CURRENT_SOURCE_DIR})
    add_test(NAME documents COMMAND bash ${tidy}/documents_test.sh ${CMAKE_CURRENT_SOURCE_DIR})
    add_test(NAME turns COMMAND bash ${tidy}/turns_test.sh ${CMAKE_CURRENT_SOURCE_DIR})
    add_test(NAME assertions COMMAND bash ${tidy}/assertions_test.sh ${CMAKE_CURRENT_SOURCE_DIR})
    add_test(NAME mutation_list COMMAND bash ${CMAKE_CURRENT_SOURCE_DIR}/tests/mutation/mutate.sh --check)
    add_test(NAME install COMMAND bash ${tidy}/install_test.sh ${CMAKE_CURRENT_SOURCE_DIR} ${CMAKE_CURRENT_BINARY_DIR}
      ${CMAKE_CXX_COMPILER} ${CMAKE_C_COMPILER} ${CMAKE_OBJDUMP})
  endif()
endif()

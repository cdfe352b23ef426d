# The library as callers use it: plain C. install_test.sh also compiles this as C++ against an installed copy.
file(GLOB sources CONFIGURE_DEPENDS tests/api/*.c)
configure_file(src/engine/pocketray.h ${CMAKE_CURRENT_BINARY_DIR}/include/pocketray/pocketray.h COPYONLY)
add_executable(test_api ${sources})
set_target_properties(test_api PROPERTIES C_STANDARD 99 C_EXTENSIONS OFF LINKER_LANGUAGE CXX)
target_include_directories(test_api BEFORE PRIVATE ${CMAKE_CURRENT_BINARY_DIR}/include)
target_compile_definitions(test_api PRIVATE API_FILE="${CMAKE_CURRENT_SOURCE_DIR}/tests/fuzz/corpus/pray/full")
target_link_libraries(test_api PRIVATE pocketray_core)
add_test(NAME api COMMAND test_api)

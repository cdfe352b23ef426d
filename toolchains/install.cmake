# Install rules: the program, libpocketray.a with its header, a CMake package and a pkg-config file. Both packages find their
# files relative to themselves, so an installed tree can be moved.
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

install(TARGETS pocketray RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
install(TARGETS pocketray_core EXPORT pocketray ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
install(FILES src/engine/pocketray.h DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/pocketray)

set(package_folder ${CMAKE_INSTALL_LIBDIR}/cmake/pocketray)
configure_package_config_file(toolchains/pocketrayConfig.cmake.in ${CMAKE_CURRENT_BINARY_DIR}/package/pocketrayConfig.cmake
  INSTALL_DESTINATION ${package_folder})
write_basic_package_version_file(${CMAKE_CURRENT_BINARY_DIR}/package/pocketrayConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/package/pocketrayConfig.cmake
  ${CMAKE_CURRENT_BINARY_DIR}/package/pocketrayConfigVersion.cmake DESTINATION ${package_folder})
install(EXPORT pocketray NAMESPACE pocketray:: DESTINATION ${package_folder} FILE pocketrayTargets.cmake)

# A C program must also link the C++ library, as a C++ compiler would.
foreach(name stdc++ c++)
  if(name IN_LIST CMAKE_CXX_IMPLICIT_LINK_LIBRARIES)
    set(POCKETRAY_PC_CXX "-l${name} -lm")
  endif()
endforeach()
if(NOT POCKETRAY_ATOMIC_64)
  string(APPEND POCKETRAY_PC_CXX " -latomic")
endif()
file(RELATIVE_PATH POCKETRAY_PC_TO_PREFIX /prefix/${CMAKE_INSTALL_LIBDIR}/pkgconfig /prefix)
string(REGEX REPLACE "/$" "" POCKETRAY_PC_TO_PREFIX "${POCKETRAY_PC_TO_PREFIX}")
configure_file(toolchains/pocketray.pc.in ${CMAKE_CURRENT_BINARY_DIR}/package/pocketray.pc @ONLY)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/package/pocketray.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig)

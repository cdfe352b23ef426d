# Ranks under mpirun; without MPI, only what such a build says of them.
if(NOT CMAKE_CROSSCOMPILING)
  add_test(NAME mpi COMMAND bash ${CMAKE_CURRENT_SOURCE_DIR}/tests/mpi/mpi_test.sh $<TARGET_FILE:pocketray>
    $<BOOL:${POCKETRAY_MPI}>)
  set_tests_properties(mpi PROPERTIES SKIP_RETURN_CODE 77)
  if(TARGET pocketray_accuracy)
    add_executable(simulate_ranks EXCLUDE_FROM_ALL tests/mpi/simulate_ranks.cpp tests/mpi/simulate_frames.cpp)
    target_link_libraries(simulate_ranks PRIVATE pocketray_app)
  endif()
  if(POCKETRAY_NETWORK)
    add_executable(simulate_serve EXCLUDE_FROM_ALL tests/mpi/simulate_serve.cpp)
    target_link_libraries(simulate_serve PRIVATE pocketray_app)
  endif()
endif()

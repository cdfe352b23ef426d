# A server and clients controlled by a test.
if(POCKETRAY_NETWORK)
  target_sources(test_remote PRIVATE tests/support/scripted_client.cpp tests/support/faulty_proxy.cpp
    tests/support/lying_server.cpp tests/support/link_fault.cpp tests/support/test_entropy.cpp)
  target_sources(test_platform PRIVATE tests/support/link_fault.cpp)
  if(TARGET test_split_report)
    target_sources(test_split_report PRIVATE tests/support/scripted_client.cpp)
  else()
    target_sources(test_remote PRIVATE src/desktop/split_report/virtual_world.cpp)
  endif()
endif()

# Any compiler by prefix, with its own choice of CPU or that of CROSS_FLAGS. Used by `make CROSS_PREFIX=…` without DEVICE.
set(CMAKE_SYSTEM_PROCESSOR cross)
include(${CMAKE_CURRENT_LIST_DIR}/device.cmake)

include(${CMAKE_CURRENT_LIST_DIR}/SoupleHeaders.cmake)
souple_headers(fmt fmt::fmt fmt)
if(TARGET fmt::fmt)  # the library itself is compiled for the machine
  set_target_properties(fmt::fmt PROPERTIES INTERFACE_COMPILE_DEFINITIONS FMT_HEADER_ONLY)
endif()

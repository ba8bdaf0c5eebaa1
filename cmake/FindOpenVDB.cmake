# OpenVDB and the headers that its own need: oneTBB, Imath, and Boost, which Debian's libopenvdb-dev does not ask for.
# Target OpenVDB::openvdb. OpenVDB's own module is in no place that CMake searches, and wants compiled parts of Boost.
include(FindPackageHandleStandardArgs)

find_path(OpenVDB_INCLUDE_DIR openvdb/openvdb.h)
find_library(OpenVDB_LIBRARY openvdb)
find_path(OpenVDB_BOOST_INCLUDE_DIR boost/uuid/uuid.hpp)
find_package(TBB QUIET)
find_package(Imath QUIET)

find_package_handle_standard_args(OpenVDB REQUIRED_VARS OpenVDB_LIBRARY OpenVDB_INCLUDE_DIR OpenVDB_BOOST_INCLUDE_DIR
                                                        Imath_FOUND TBB_FOUND)
mark_as_advanced(OpenVDB_INCLUDE_DIR OpenVDB_LIBRARY OpenVDB_BOOST_INCLUDE_DIR)

if(OpenVDB_FOUND AND NOT TARGET OpenVDB::openvdb)
  add_library(OpenVDB::openvdb INTERFACE IMPORTED)
  target_include_directories(OpenVDB::openvdb INTERFACE ${OpenVDB_INCLUDE_DIR} ${OpenVDB_BOOST_INCLUDE_DIR})
  target_link_libraries(OpenVDB::openvdb INTERFACE ${OpenVDB_LIBRARY} Imath::Imath TBB::tbb)
endif()

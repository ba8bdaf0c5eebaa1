include(${CMAKE_CURRENT_LIST_DIR}/SoupleHeaders.cmake)
souple_headers(Eigen3 Eigen3::Eigen Eigen)

include(${CMAKE_CURRENT_LIST_DIR}/SoupleHeaders.cmake)
souple_headers(nlohmann_json nlohmann_json::nlohmann_json nlohmann)

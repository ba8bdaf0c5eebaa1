include(CMakePackageConfigHelpers)

set(SOUPLE_PACKAGE_DIR ${CMAKE_INSTALL_LIBDIR}/cmake/souple)

install(TARGETS souple souple_host EXPORT souple-targets
        ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR}
        LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR}
        INCLUDES DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
# Public headers only, as they are when installing.
set(include_dir ${CMAKE_INSTALL_INCLUDEDIR})
if(NOT IS_ABSOLUTE ${include_dir})
  set(include_dir "\${CMAKE_INSTALL_PREFIX}/${include_dir}")
endif()
install(CODE "
  include(\"${PROJECT_SOURCE_DIR}/cmake/SouplePublicHeaders.cmake\")
  souple_public_headers(\"${PROJECT_SOURCE_DIR}\" headers)
  foreach(header IN LISTS headers)
    cmake_path(GET header PARENT_PATH folder)
    file(INSTALL \"${PROJECT_SOURCE_DIR}/\${header}\" DESTINATION \"${include_dir}/\${folder}\")
  endforeach()")
install(FILES ${PROJECT_BINARY_DIR}/include/souple/version.h DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/souple)
if(EXISTS ${PROJECT_SOURCE_DIR}/scenes)
  install(DIRECTORY ${PROJECT_SOURCE_DIR}/scenes/ DESTINATION ${CMAKE_INSTALL_DATADIR}/souple/scenes)
endif()
if(TARGET souple_app)
  install(TARGETS souple_app RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
endif()
if(TARGET souple_mesh_reader)
  install(TARGETS souple_mesh_reader RUNTIME DESTINATION ${CMAKE_INSTALL_LIBEXECDIR}/souple)
endif()
if(SOUPLE_MAN_PAGE)
  install(FILES ${SOUPLE_MAN_PAGE} DESTINATION ${CMAKE_INSTALL_MANDIR}/man1)
endif()
install(FILES ${PROJECT_SOURCE_DIR}/LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR})

install(EXPORT souple-targets NAMESPACE souple:: DESTINATION ${SOUPLE_PACKAGE_DIR})
get_target_property(library_type souple TYPE)
get_property(dependencies GLOBAL PROPERTY SOUPLE_DEPENDENCIES)
set(SOUPLE_INSTALLED_LIBEXEC ${CMAKE_INSTALL_LIBEXECDIR}/souple)
configure_package_config_file(${PROJECT_SOURCE_DIR}/cmake/souple-config.cmake.in
                              ${PROJECT_BINARY_DIR}/souple-config.cmake
                              INSTALL_DESTINATION ${SOUPLE_PACKAGE_DIR} PATH_VARS SOUPLE_INSTALLED_LIBEXEC)
# Before 1.0 a minor version may break what a user wrote.
write_basic_package_version_file(${PROJECT_BINARY_DIR}/souple-config-version.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/souple-config.cmake ${PROJECT_BINARY_DIR}/souple-config-version.cmake
        DESTINATION ${SOUPLE_PACKAGE_DIR})

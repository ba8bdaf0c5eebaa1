# Packages for render/: libepoxy (OpenGL and EGL), libpng, Dear ImGui (its font atlas; the viewer's panels). Target
# SoupleGraphics::SoupleGraphics. Searched without pkg-config, which a user may not have.
include(FindPackageHandleStandardArgs)

find_path(EPOXY_INCLUDE_DIR epoxy/gl.h)
find_path(EPOXY_EGL_INCLUDE_DIR epoxy/egl.h)
find_library(EPOXY_LIBRARY epoxy)
find_path(IMGUI_INCLUDE_DIR imgui.h PATH_SUFFIXES imgui)
find_library(IMGUI_LIBRARY imgui)
find_library(STB_LIBRARY stb)  # Debian's imgui is linked to it
find_package(PNG QUIET)

find_package_handle_standard_args(SoupleGraphics REQUIRED_VARS EPOXY_LIBRARY EPOXY_INCLUDE_DIR EPOXY_EGL_INCLUDE_DIR
                                                               IMGUI_LIBRARY IMGUI_INCLUDE_DIR PNG_FOUND)
mark_as_advanced(EPOXY_INCLUDE_DIR EPOXY_EGL_INCLUDE_DIR EPOXY_LIBRARY IMGUI_INCLUDE_DIR IMGUI_LIBRARY STB_LIBRARY)

if(SoupleGraphics_FOUND AND NOT TARGET SoupleGraphics::SoupleGraphics)
  add_library(SoupleGraphics::SoupleGraphics INTERFACE IMPORTED)
  target_include_directories(SoupleGraphics::SoupleGraphics INTERFACE ${EPOXY_INCLUDE_DIR} ${IMGUI_INCLUDE_DIR})
  target_link_libraries(SoupleGraphics::SoupleGraphics INTERFACE ${IMGUI_LIBRARY} ${EPOXY_LIBRARY} PNG::PNG
                                                                 ${CMAKE_DL_LIBS})
  if(STB_LIBRARY)
    target_link_libraries(SoupleGraphics::SoupleGraphics INTERFACE ${STB_LIBRARY})
  endif()
endif()

# souple_public_headers(source out): the headers that users include, and all that these include, relative to the source
# folder. They are installed, and a shared library exports what they declare. Needs no project: installing runs it too.
cmake_policy(VERSION 3.25)
set(SOUPLE_PUBLIC_HEADERS
    souple/souple.h
    # objects and meshes
    souple/geometry/adjacency.h souple/geometry/builders.h souple/geometry/convex_hull.h souple/geometry/fill.h
    souple/geometry/mass_properties.h souple/geometry/mesh_report.h souple/geometry/weld.h
    # user constraints
    souple/constraints/all.h souple/solver/custom_constraint.h souple/solver/set_projector.h
    # files
    souple/io/animated_points.h souple/io/animated_target.h souple/io/checkpoint_file.h souple/io/mdd.h
    souple/mesh_files/mesh_animation.h souple/mesh_files/mesh_file.h souple/mesh_files/mesh_write.h souple/io/particle_file.h souple/io/pc2.h souple/io/playback.h
    souple/io/recorder.h souple/scene/scene.h
    # surfaces of fluids
    souple/surface/fluid_surface.h
    # hosts and games
    souple/host/action_queue.h souple/host/clock.h souple/host/drag_plane.h souple/host/drawable.h souple/host/fixed_step.h
    souple/host/grab.h
    souple/host/material_tunables.h souple/host/placement.h souple/host/session.h souple/host/vertex_welder.h)

# souple_included(source out file...): these files, those that they include of the library, and so on, without what is made
# when configuring.
function(souple_included source out)
  set(found "")
  set(next ${ARGN})
  while(next)
    list(POP_FRONT next file)
    if(file IN_LIST found OR NOT EXISTS ${source}/${file})
      continue()
    endif()
    list(APPEND found ${file})
    get_property(known GLOBAL PROPERTY souple_includes_${file} SET)
    if(NOT known)
      file(STRINGS ${source}/${file} lines REGEX "^#include [\"<]souple/")
      list(TRANSFORM lines REPLACE "^#include [\"<]([^\">]+).*" "\\1")
      set_property(GLOBAL PROPERTY souple_includes_${file} "${lines}")
    endif()
    get_property(includes GLOBAL PROPERTY souple_includes_${file})
    list(APPEND next ${includes})
  endwhile()
  set(${out} ${found} PARENT_SCOPE)
endfunction()

function(souple_public_headers source out)
  souple_included(${source} found ${SOUPLE_PUBLIC_HEADERS})
  list(SORT found)
  set(${out} ${found} PARENT_SCOPE)
endfunction()

# souple_hide_internals(): the shared library exports what the public headers declare, and nothing else. A source first gets
# those of the public headers that it includes, declared visible; all else is hidden. Kernels are left out, so that nothing
# that they include is compiled for another instruction set. Our own programs link the same objects as a static library.
function(souple_hide_internals)
  souple_public_headers(${PROJECT_SOURCE_DIR} headers)
  # The members of a hidden implementation have the visibility of the class that declares it.
  set(script ${PROJECT_BINARY_DIR}/souple.map)
  file(CONFIGURE OUTPUT ${script} CONTENT "{ local: *4Impl*; };\n")
  set_target_properties(souple PROPERTIES CXX_VISIBILITY_PRESET hidden VISIBILITY_INLINES_HIDDEN ON
                                          POSITION_INDEPENDENT_CODE ON DISABLE_PRECOMPILE_HEADERS ON)
  get_target_property(sources souple SOURCES)
  foreach(source IN LISTS sources)
    cmake_path(GET source STEM name)
    if(name MATCHES "^(scalar|sse|avx2|avx512|neon|wasm)_.*instances$")
      continue()
    endif()
    cmake_path(ABSOLUTE_PATH source BASE_DIRECTORY ${CMAKE_CURRENT_SOURCE_DIR} OUTPUT_VARIABLE path)
    cmake_path(RELATIVE_PATH path BASE_DIRECTORY ${PROJECT_SOURCE_DIR})
    souple_included(${PROJECT_SOURCE_DIR} included ${path})
    set(lines "#pragma GCC visibility push(default)\n")
    foreach(header IN LISTS headers)
      if(header IN_LIST included)
        string(APPEND lines "#include \"${header}\"\n")
      endif()
    endforeach()
    string(APPEND lines "#pragma GCC visibility pop\n")
    set(visible ${PROJECT_BINARY_DIR}/visible/${path}.h)
    file(CONFIGURE OUTPUT ${visible} @ONLY CONTENT "${lines}")
    set_property(SOURCE ${source} TARGET_DIRECTORY souple APPEND PROPERTY COMPILE_OPTIONS -include ${visible})
  endforeach()
  target_link_options(souple PRIVATE "LINKER:--version-script=${script}")

  add_library(souple_static STATIC EXCLUDE_FROM_ALL $<TARGET_OBJECTS:souple>)
  get_target_property(links souple LINK_LIBRARIES)
  target_link_libraries(souple_static PUBLIC ${links})
  target_compile_features(souple_static PUBLIC cxx_std_20)
  target_include_directories(souple_static PUBLIC ${PROJECT_SOURCE_DIR} ${PROJECT_BINARY_DIR}/include)
  set_target_properties(souple_all PROPERTIES INTERFACE_LINK_LIBRARIES souple_static)
endfunction()

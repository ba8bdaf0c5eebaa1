# souple_public_headers(source out): the headers that users include, and all that these include, relative to the source
# folder. They are installed, and a shared library exports what they declare. Needs no project: installing runs it too.
set(SOUPLE_PUBLIC_HEADERS
    souple/souple.h
    # objects and meshes
    souple/geometry/adjacency.h souple/geometry/builders.h souple/geometry/fill.h souple/geometry/mesh_report.h
    souple/geometry/weld.h
    # user constraints
    souple/constraints/all.h souple/solver/custom_constraint.h souple/solver/set_projector.h
    # files
    souple/io/animated_points.h souple/io/animated_target.h souple/io/checkpoint_file.h souple/io/mdd.h
    souple/io/mesh_file.h souple/io/mesh_write.h souple/io/particle_file.h souple/io/pc2.h souple/io/playback.h
    souple/io/recorder.h souple/scene/scene.h
    # surfaces of fluids
    souple/surface/fluid_surface.h
    # hosts and games
    souple/host/action_queue.h souple/host/clock.h souple/host/drag_plane.h souple/host/drawable.h souple/host/fixed_step.h
    souple/host/grab.h
    souple/host/material_tunables.h souple/host/placement.h souple/host/session.h souple/host/vertex_welder.h)

function(souple_public_headers source out)
  set(found "")
  set(next ${SOUPLE_PUBLIC_HEADERS})
  while(next)
    list(POP_FRONT next header)
    # version.h is made when configuring.
    if(header IN_LIST found OR NOT EXISTS ${source}/${header})
      continue()
    endif()
    list(APPEND found ${header})
    file(STRINGS ${source}/${header} includes REGEX "^#include [\"<]souple/")
    foreach(include IN LISTS includes)
      string(REGEX REPLACE "^#include [\"<]([^\">]+).*" "\\1" include "${include}")
      list(APPEND next ${include})
    endforeach()
  endwhile()
  list(SORT found)
  set(${out} ${found} PARENT_SCOPE)
endfunction()

# souple_hide_internals(): the shared library exports what the public headers declare, and nothing else. Each source begins
# with these headers, declared visible; all else is hidden. Kernels are left out, so that nothing that they include is compiled
# for another instruction set. Our own programs link the same objects as a static library.
function(souple_hide_internals)
  souple_public_headers(${PROJECT_SOURCE_DIR} headers)
  list(TRANSFORM headers REPLACE "(.+)" "#include \"\\1\"" OUTPUT_VARIABLE includes)
  list(JOIN includes "\n" includes)
  set(visible ${PROJECT_BINARY_DIR}/souple_visible.h)
  file(CONFIGURE OUTPUT ${visible} @ONLY CONTENT
"#pragma GCC visibility push(default)
@includes@
#pragma GCC visibility pop
")
  # The members of a hidden implementation have the visibility of the class that declares it.
  set(script ${PROJECT_BINARY_DIR}/souple.map)
  file(CONFIGURE OUTPUT ${script} CONTENT "{ local: *4Impl*; };\n")
  set_target_properties(souple PROPERTIES CXX_VISIBILITY_PRESET hidden VISIBILITY_INLINES_HIDDEN ON
                                          POSITION_INDEPENDENT_CODE ON DISABLE_PRECOMPILE_HEADERS ON)
  get_target_property(sources souple SOURCES)
  foreach(source IN LISTS sources)
    cmake_path(GET source STEM name)
    if(NOT name MATCHES "^(sse|avx2|avx512|neon)(_|$)")
      set_property(SOURCE ${source} TARGET_DIRECTORY souple APPEND PROPERTY COMPILE_OPTIONS "SHELL:-include ${visible}")
    endif()
  endforeach()
  target_link_options(souple PRIVATE "LINKER:--version-script=${script}")

  add_library(souple_static STATIC EXCLUDE_FROM_ALL $<TARGET_OBJECTS:souple>)
  get_target_property(links souple LINK_LIBRARIES)
  target_link_libraries(souple_static PUBLIC ${links})
  target_compile_features(souple_static PUBLIC cxx_std_20)
  target_include_directories(souple_static PUBLIC ${PROJECT_SOURCE_DIR} ${PROJECT_BINARY_DIR}/include)
  set_target_properties(souple_all PROPERTIES INTERFACE_LINK_LIBRARIES souple_static)
endfunction()

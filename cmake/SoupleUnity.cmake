# Unity builds: the sources of a folder are compiled several at a time. The library then takes half of the processor time,
# tests take a third.
#
#   souple_unite(target...)  groups the sources that the target has so far
#
# Names without linkage are therefore unique within a folder. Each source still includes all that it uses: a slow test
# compiles it alone (tests/package/check_shared.cmake). Sources with options of their own are grouped apart. Vector kernels
# and sources with definitions of their own are compiled alone.
option(SOUPLE_UNITY "Compile several sources of a folder at a time" ${PROJECT_IS_TOP_LEVEL})
# Without precompiled headers, larger groups read the headers less often (SouplePrecompile.cmake).
set(SOUPLE_UNITY_SOURCES 8)
if(CMAKE_CXX_COMPILER_ID MATCHES Clang)
  set(SOUPLE_UNITY_SOURCES 20)
endif()

function(souple_unite)
  if(NOT SOUPLE_UNITY)
    return()
  endif()
  foreach(target IN LISTS ARGN)
    get_target_property(sources ${target} SOURCES)
    get_target_property(base ${target} SOURCE_DIR)
    set(folders "")
    foreach(source IN LISTS sources)
      if(NOT source MATCHES "^[^$]*[.]cpp$" OR source MATCHES "(^|/)(kernels|mesh_files|passes)/[^/]*$")
        continue()
      endif()
      cmake_path(ABSOLUTE_PATH source BASE_DIRECTORY ${base} NORMALIZE OUTPUT_VARIABLE path)
      cmake_path(GET path PARENT_PATH folder)
      cmake_path(RELATIVE_PATH folder BASE_DIRECTORY ${PROJECT_SOURCE_DIR})
      string(MAKE_C_IDENTIFIER "${folder}" folder)
      get_source_file_property(definitions ${source} TARGET_DIRECTORY ${target} COMPILE_DEFINITIONS)
      if(definitions)
        continue()
      endif()
      get_source_file_property(options ${source} TARGET_DIRECTORY ${target} COMPILE_OPTIONS)
      if(options)
        string(MAKE_C_IDENTIFIER "${folder}${options}" folder)
        set(options_${folder} "${options}")
      endif()
      list(APPEND folders ${folder})
      list(APPEND sources_${folder} ${path})
    endforeach()
    list(REMOVE_DUPLICATES folders)
    foreach(folder IN LISTS folders)
      souple_unite_folder_(${target} ${folder} "${options_${folder}}" ${sources_${folder}})
      set(sources_${folder} "")
      set(options_${folder} "")
    endforeach()
    # A type of an anonymous namespace counts as a header's where the source that declares it is included.
    target_compile_options(${target} PRIVATE $<$<CXX_COMPILER_ID:GNU>:-Wno-subobject-linkage>)
  endforeach()
endfunction()

# Groups of equal size: few large ones would leave processors without work. Those that CMake makes (UNITY_BUILD) hold
# absolute paths, with which a compiler cache serves one folder only; they also leave out sources with options.
function(souple_unite_folder_ target folder options)
  list(LENGTH ARGN count)
  math(EXPR groups "(${count} + ${SOUPLE_UNITY_SOURCES} - 1) / ${SOUPLE_UNITY_SOURCES}")
  set(i 0)
  foreach(source IN LISTS ARGN)
    math(EXPR group "${i} * ${groups} / ${count}")
    cmake_path(RELATIVE_PATH source BASE_DIRECTORY ${PROJECT_SOURCE_DIR})
    string(APPEND includes_${group} "#include \"${source}\"\n")
    math(EXPR i "${i} + 1")
  endforeach()
  set_source_files_properties(${ARGN} TARGET_DIRECTORY ${target} PROPERTIES HEADER_FILE_ONLY ON)
  math(EXPR last "${groups} - 1")
  foreach(group RANGE ${last})
    set(unit ${PROJECT_BINARY_DIR}/Unity/${target}/unity_${folder}_${group}.cpp)
    file(CONFIGURE OUTPUT ${unit} CONTENT "${includes_${group}}" @ONLY)
    target_sources(${target} PRIVATE ${unit})
    if(options)
      set_source_files_properties(${unit} TARGET_DIRECTORY ${target} PROPERTIES
        COMPILE_OPTIONS "${options}" SKIP_PRECOMPILE_HEADERS ON)
    endif()
  endforeach()
  target_include_directories(${target} PRIVATE ${PROJECT_SOURCE_DIR})
endfunction()

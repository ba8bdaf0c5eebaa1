# Unity builds: the sources of a folder are compiled several at a time. The library then takes half of the processor time,
# tests take a third.
#
#   souple_unite(target...)  groups the sources that the target has so far
#
# Names without linkage are therefore unique within a folder. Each source still includes all that it uses: script/lint
# compiles it alone. Sources with options of their own, such as vector kernels, are compiled alone.
option(SOUPLE_UNITY "Compile several sources of a folder at a time" ${PROJECT_IS_TOP_LEVEL})
set(SOUPLE_UNITY_SOURCES 8)

function(souple_unite)
  if(NOT SOUPLE_UNITY)
    return()
  endif()
  foreach(target IN LISTS ARGN)
    get_target_property(sources ${target} SOURCES)
    get_target_property(base ${target} SOURCE_DIR)
    set(folders "")
    foreach(source IN LISTS sources)
      if(NOT source MATCHES "^[^$]*[.]cpp$" OR source MATCHES "(^|/)(kernels|mesh_files|multilevel|passes)/[^/]*$")
        continue()
      endif()
      cmake_path(ABSOLUTE_PATH source BASE_DIRECTORY ${base} NORMALIZE OUTPUT_VARIABLE path)
      cmake_path(GET path PARENT_PATH folder)
      cmake_path(RELATIVE_PATH folder BASE_DIRECTORY ${PROJECT_SOURCE_DIR})
      string(MAKE_C_IDENTIFIER "${folder}" folder)
      list(APPEND folders ${folder})
      list(APPEND sources_${folder} ${source})
    endforeach()
    list(REMOVE_DUPLICATES folders)
    foreach(folder IN LISTS folders)
      souple_unite_folder_(${target} ${folder} ${sources_${folder}})
      set(sources_${folder} "")
    endforeach()
    set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_MODE GROUP)
    # A type of an anonymous namespace counts as a header's where the source that declares it is included.
    target_compile_options(${target} PRIVATE $<$<CXX_COMPILER_ID:GNU>:-Wno-subobject-linkage>)
  endforeach()
endfunction()

# Groups of equal size: few large ones would leave processors without work.
function(souple_unite_folder_ target folder)
  list(LENGTH ARGN count)
  math(EXPR groups "(${count} + ${SOUPLE_UNITY_SOURCES} - 1) / ${SOUPLE_UNITY_SOURCES}")
  set(i 0)
  foreach(source IN LISTS ARGN)
    math(EXPR group "${i} * ${groups} / ${count}")
    set_source_files_properties(${source} TARGET_DIRECTORY ${target} PROPERTIES UNITY_GROUP ${folder}_${group})
    math(EXPR i "${i} + 1")
  endforeach()
endfunction()

cmake_policy(VERSION 3.25)

# Installs BUILD into a fresh prefix below WORK, moves that prefix, builds examples/hello and examples/embed against it
# and runs them.
function(run)
  execute_process(COMMAND ${ARGN} COMMAND_ECHO STDOUT RESULT_VARIABLE result)
  if(NOT result EQUAL 0)
    list(JOIN ARGN " " command)
    message(FATAL_ERROR "failed (${result}): ${command}")
  endif()
endfunction()

file(REMOVE_RECURSE ${WORK})
file(MAKE_DIRECTORY ${WORK}/run)
run(${CMAKE_COMMAND} --install ${BUILD} --prefix ${WORK}/first)
file(RENAME ${WORK}/first ${WORK}/prefix)

# An installed package works on another machine: nothing in it may name this source or build tree.
file(GLOB_RECURSE package_files ${WORK}/prefix/*.cmake)
if(NOT package_files)
  message(FATAL_ERROR "no package files below ${WORK}/prefix")
endif()
foreach(file IN LISTS package_files)
  file(READ ${file} text)
  foreach(tree ${SOURCE} ${BUILD} ${WORK}/first)
    string(FIND "${text}" "${tree}/" at)
    if(NOT at EQUAL -1)
      message(FATAL_ERROR "${file} names ${tree}")
    endif()
  endforeach()
endforeach()

# Public headers, with all that they include, and no others.
file(GLOB_RECURSE headers RELATIVE ${WORK}/prefix/include ${WORK}/prefix/include/*.h)
foreach(internal impl state stages step diagnose)
  if(souple/world/${internal}.h IN_LIST headers)
    message(FATAL_ERROR "souple/world/${internal}.h is installed, and no user includes it")
  endif()
endforeach()
foreach(header IN LISTS headers)
  file(STRINGS ${WORK}/prefix/include/${header} includes REGEX "^#include [\"<](souple/|fmt|Eigen|nlohmann|tbb|oneapi|assimp)")
  foreach(include IN LISTS includes)
    string(REGEX REPLACE "^#include [\"<]([^\">]+).*" "\\1" include "${include}")
    if(NOT include IN_LIST headers)
      message(FATAL_ERROR "${header} includes ${include}, which is not installed")
    endif()
  endforeach()
endforeach()

# A consumer has neither oneTBB's nor assimp's headers and CMake files.
run(${CMAKE_COMMAND} -D CMAKE_DISABLE_FIND_PACKAGE_TBB=ON -D CMAKE_DISABLE_FIND_PACKAGE_assimp=ON
    -G ${GENERATOR} -S ${SOURCE}/examples/hello -B ${WORK}/build -D CMAKE_CXX_COMPILER=${COMPILER}
    -D CMAKE_BUILD_TYPE=Release -D CMAKE_PREFIX_PATH=${WORK}/prefix -D WANTED_VERSION=${VERSION})
run(${CMAKE_COMMAND} --build ${WORK}/build)
run(${CMAKE_COMMAND} -E chdir ${WORK}/run ${WORK}/build/hello)
foreach(file run.json cloth.obj cloth.pc2)
  if(NOT EXISTS ${WORK}/run/out/${file})
    message(FATAL_ERROR "hello left no out/${file}")
  endif()
endforeach()

# The program that reads meshes through assimp is found in the moved prefix, by the installed program and by the package.
file(GLOB reader ${WORK}/prefix/libexec/souple/souple-mesh-reader)
if(reader AND EXISTS ${WORK}/prefix/bin/souple)
  file(WRITE ${WORK}/run/square.off "OFF\n4 1 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3\n")
  file(WRITE ${WORK}/run/square.json
       "{\"souple\": 1, \"objects\": [{\"name\": \"a\", \"kind\": \"cloth\", \"mesh\": {\"file\": \"square.off\"}}]}")
  run(${WORK}/prefix/bin/souple check ${WORK}/run/square.json)
  file(WRITE ${WORK}/find/CMakeLists.txt "cmake_minimum_required(VERSION 3.25)\nproject(find LANGUAGES CXX)\n"
       "find_package(souple REQUIRED)\nif(NOT EXISTS \"\${SOUPLE_MESH_READER}\")\n  message(FATAL_ERROR missing)\nendif()\n")
  run(${CMAKE_COMMAND} -G ${GENERATOR} -S ${WORK}/find -B ${WORK}/build_find -D CMAKE_CXX_COMPILER=${COMPILER}
      -D CMAKE_PREFIX_PATH=${WORK}/prefix)
elseif(EXISTS ${BUILD}/libexec/souple/souple-mesh-reader)
  message(FATAL_ERROR "souple-mesh-reader is built and not installed")
endif()

# Compiled as C++17, against the headers of souple/host alone.
run(${CMAKE_COMMAND} -G ${GENERATOR} -S ${SOURCE}/examples/embed -B ${WORK}/build_embed
    -D CMAKE_CXX_COMPILER=${COMPILER} -D CMAKE_BUILD_TYPE=Release -D CMAKE_PREFIX_PATH=${WORK}/prefix
    -D WANTED_VERSION=${VERSION})
run(${CMAKE_COMMAND} --build ${WORK}/build_embed)
run(${WORK}/build_embed/embed)

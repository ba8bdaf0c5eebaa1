cmake_policy(VERSION 3.25)

# A shared library exports what the public headers declare and nothing else, has a SONAME with its version, and serves
# programs and user constraints. Each source is compiled alone, without optimization and for one instruction set: the symbols are the same.
function(run)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE result OUTPUT_VARIABLE said ERROR_VARIABLE said)
  if(NOT result EQUAL 0)
    list(JOIN ARGN " " command)
    message(FATAL_ERROR "failed (${result}): ${command}\n${said}")
  endif()
  set(said "${said}" PARENT_SCOPE)
endfunction()

file(REMOVE_RECURSE ${WORK})
run(${CMAKE_COMMAND} -G ${GENERATOR} -S ${SOURCE} -B ${WORK}/build -D CMAKE_BUILD_TYPE=Debug -D CMAKE_CXX_FLAGS_DEBUG=-O0
    -D CMAKE_CXX_COMPILER=${COMPILER} -D BUILD_SHARED_LIBS=ON -D SOUPLE_BUILD_APP=OFF -D SOUPLE_INSTRUCTION_SETS=sse
    -D SOUPLE_UNITY=OFF)
run(${CMAKE_COMMAND} --build ${WORK}/build --parallel)
run(${CMAKE_COMMAND} --install ${WORK}/build --prefix ${WORK}/prefix)

file(GLOB_RECURSE library ${WORK}/prefix/libsouple.so.${VERSION})
if(NOT library)
  message(FATAL_ERROR "no libsouple.so.${VERSION} below ${WORK}/prefix")
endif()
string(REGEX REPLACE "^([0-9]+\\.[0-9]+).*" "\\1" soversion ${VERSION})
run(readelf -d ${library})
if(NOT said MATCHES "SONAME[^\n]*libsouple\\.so\\.${soversion}\\]")
  message(FATAL_ERROR "the library's SONAME is not libsouple.so.${soversion}:\n${said}")
endif()

run(nm --dynamic --defined-only --demangle ${library})
string(REPLACE ";" "," said "${said}")
string(REGEX MATCHALL "[^\n]+" symbols "${said}")
list(LENGTH symbols count)
foreach(internal "World::Impl" "souple::build_constraints\\(" "souple::find_candidates\\(" "souple::GaussSeidel" "souple::drive_obstacles")
  if(said MATCHES "${internal}")
    message(FATAL_ERROR "the library exports ${internal}, which no public header declares")
  endif()
endforeach()
foreach(public "souple::World::step\\(double\\)" "souple::grid\\(" "souple::host::Session::advance\\(" "souple::load_scene")
  if(NOT said MATCHES "${public}")
    message(FATAL_ERROR "the library does not export ${public}")
  endif()
endforeach()
message(STATUS "${count} symbols")
if(count GREATER 3000)
  message(FATAL_ERROR "the library exports ${count} symbols; expected at most 3000")
endif()

# examples/hello, and a constraint of a user and one of ours in a program's own instantiation.
run(${CMAKE_COMMAND} -G ${GENERATOR} -S ${SOURCE}/examples/hello -B ${WORK}/hello -D CMAKE_CXX_COMPILER=${COMPILER}
    -D CMAKE_PREFIX_PATH=${WORK}/prefix -D WANTED_VERSION=${VERSION}
    -D CMAKE_DISABLE_FIND_PACKAGE_TBB=ON -D CMAKE_DISABLE_FIND_PACKAGE_assimp=ON -D CMAKE_DISABLE_FIND_PACKAGE_fmt=ON)
run(${CMAKE_COMMAND} --build ${WORK}/hello)
file(READ ${SOURCE}/docs/getting-started.md page)
string(REGEX MATCH "```cpp\n(#include <souple/solver/set_projector.h>.*)\n```\n\n## Settings" found "${page}")
file(WRITE ${WORK}/constraint.cpp "${CMAKE_MATCH_1}\n")
cmake_path(GET library PARENT_PATH folder)
run(${COMPILER} -std=c++20 ${WORK}/constraint.cpp -I${WORK}/prefix/include -L${folder} -lsouple -Wl,-rpath,${folder}
    -o ${WORK}/constraint)
run(${WORK}/constraint)

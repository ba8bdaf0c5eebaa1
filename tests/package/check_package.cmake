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

run(${CMAKE_COMMAND} -G ${GENERATOR} -S ${SOURCE}/examples/hello -B ${WORK}/build -D CMAKE_CXX_COMPILER=${COMPILER}
    -D CMAKE_BUILD_TYPE=Release -D CMAKE_PREFIX_PATH=${WORK}/prefix -D WANTED_VERSION=${VERSION})
run(${CMAKE_COMMAND} --build ${WORK}/build)
run(${CMAKE_COMMAND} -E chdir ${WORK}/run ${WORK}/build/hello)
foreach(file run.json cloth.obj cloth.pc2)
  if(NOT EXISTS ${WORK}/run/out/${file})
    message(FATAL_ERROR "hello left no out/${file}")
  endif()
endforeach()

# Compiled as C++17, against the headers of souple/host alone.
run(${CMAKE_COMMAND} -G ${GENERATOR} -S ${SOURCE}/examples/embed -B ${WORK}/build_embed
    -D CMAKE_CXX_COMPILER=${COMPILER} -D CMAKE_BUILD_TYPE=Release -D CMAKE_PREFIX_PATH=${WORK}/prefix
    -D WANTED_VERSION=${VERSION})
run(${CMAKE_COMMAND} --build ${WORK}/build_embed)
run(${WORK}/build_embed/embed)

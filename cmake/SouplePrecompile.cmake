# Precompiled headers: a fifth of the time of compiling the library, a third of that of the tests. Two functions:
#
#   souple_precompile(target header...)  compiles the headers once for all sources of the target
#   souple_reuse_headers(target from)    takes those of another target, which is compiled with the same options
#
# Clang compiles without them: its precompiled headers hold absolute paths, with which a compiler cache serves one folder
# only. A source still includes all that it uses: a slow test compiles each alone (tests/package/check_shared.cmake), and
# script/lint reads them without precompiled headers.
option(SOUPLE_PRECOMPILE "Precompiled headers, except with Clang" ${PROJECT_IS_TOP_LEVEL})
if(CMAKE_CXX_COMPILER_ID MATCHES Clang)
  set(SOUPLE_PRECOMPILE OFF)
endif()

function(souple_precompile target)
  if(SOUPLE_PRECOMPILE)
    target_precompile_headers(${target} PRIVATE ${ARGN})
  endif()
endfunction()

function(souple_reuse_headers target from)
  if(SOUPLE_PRECOMPILE)
    target_precompile_headers(${target} REUSE_FROM ${from})
  endif()
endfunction()

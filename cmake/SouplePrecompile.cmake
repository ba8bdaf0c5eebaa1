# Precompiled headers: a fifth of the time of compiling the library, a third of that of the tests. Two functions:
#
#   souple_precompile(target header...)  compiles the headers once for all sources of the target
#   souple_reuse_headers(target from)    takes those of another target, which is compiled with the same options
#
# A source still includes all that it uses: a slow test compiles each alone (tests/package/check_shared.cmake), and
# script/lint reads them without precompiled headers.
option(SOUPLE_PRECOMPILE "Precompiled headers" ${PROJECT_IS_TOP_LEVEL})

function(souple_precompile target)
  if(NOT SOUPLE_PRECOMPILE)
    return()
  endif()
  target_precompile_headers(${target} PRIVATE ${ARGN})
  if(CMAKE_CXX_COMPILER_ID MATCHES Clang)
    # Without the time of day, so that a compiler cache knows the result again.
    target_compile_options(${target} PRIVATE "SHELL:-Xclang -fno-pch-timestamp")
  endif()
endfunction()

function(souple_reuse_headers target from)
  if(NOT SOUPLE_PRECOMPILE)
    return()
  endif()
  target_precompile_headers(${target} REUSE_FROM ${from})
  if(CMAKE_CXX_COMPILER_ID MATCHES Clang)
    target_compile_options(${target} PRIVATE "SHELL:-Xclang -fno-pch-timestamp")
  endif()
endfunction()

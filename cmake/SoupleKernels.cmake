# souple_add_kernels(NAME...) adds the translation units NAME.cpp of the current folder to the library, one per
# instruction set, as far as they are for the processor that is compiled for; all else is compiled for any
# processor of its architecture. A NAME is an instruction set, or one and a part, such as avx2_meshes.
function(souple_add_kernels)
  if(CMAKE_SYSTEM_PROCESSOR MATCHES "^(x86_64|AMD64)$")
    set(known sse avx2 avx512)
  elseif(CMAKE_SYSTEM_PROCESSOR MATCHES "^(aarch64|arm64)$")
    set(known neon)
  endif()
  set(avx2 -mavx2)
  # g++ 12 takes the "undefined" registers of its own AVX-512 header for mistakes (GCC bug 105593).
  set(avx512 -mavx512f -mavx512dq $<$<CXX_COMPILER_ID:GNU>:-Wno-uninitialized>
             $<$<CXX_COMPILER_ID:GNU>:-Wno-maybe-uninitialized>)
  foreach(set IN LISTS known)
    list(APPEND ${set} ${SOUPLE_FEWER_CHECKS})
  endforeach()
  foreach(name IN LISTS ARGN)
    string(REGEX REPLACE "_.*" "" set ${name})
    if(NOT set IN_LIST known)
      continue()
    endif()
    target_sources(souple PRIVATE ${name}.cpp)
    # A header compiled for another instruction set is of no use here.
    set_source_files_properties(${name}.cpp TARGET_DIRECTORY souple PROPERTIES SKIP_PRECOMPILE_HEADERS ON)
    if(DEFINED ${set})
      set_source_files_properties(${name}.cpp TARGET_DIRECTORY souple PROPERTIES COMPILE_OPTIONS "${${set}}")
    endif()
  endforeach()
endfunction()

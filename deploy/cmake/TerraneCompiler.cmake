# Flags every translation unit gets. Tiles must be the same bytes on every machine, so contraction is off and value-changing
# optimisations are never on; -fno-trapping-math and -fno-math-errno change no result and let plain loops vectorise.
add_library(terrane_flags INTERFACE)
add_library(terrane::flags ALIAS terrane_flags)
target_compile_options(terrane_flags INTERFACE
  -ffp-contract=off -fno-math-errno -fno-trapping-math
  -Wall -Wextra -Wconversion -Wshadow -Wno-sign-conversion -Werror)
target_compile_definitions(terrane_flags INTERFACE GLM_FORCE_XYZW_ONLY GLM_FORCE_EXPLICIT_CTOR)
target_include_directories(terrane_flags INTERFACE ${CMAKE_SOURCE_DIR})

if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  # GCC 12.2 from -O2 on: where three splits x - double(float(x)) stand side by side, its basic-block vectoriser joins two of them and then
  # drops the round trip through float, so that low words come out 0 (contraction_probe_test's LowWordsSurvive sees it). Loops are not affected.
  target_compile_options(terrane_flags INTERFACE -fno-tree-slp-vectorize)
  # GCC 12's optimiser warns of overlaps and overflows inside std::string and fmt that cannot happen (GCC bug 105329 and its kin), differently
  # at every optimisation level; the sanitizers look for the real ones.
  target_compile_options(terrane_flags INTERFACE -Wno-restrict -Wno-stringop-overflow -Wno-stringop-overread -Wno-array-bounds
    -Wno-maybe-uninitialized)
endif()
if(CMAKE_CXX_COMPILER_ID STREQUAL "Clang")
  target_compile_options(terrane_flags INTERFACE -Wno-shorten-64-to-32 -Wno-implicit-int-float-conversion)
endif()
if(TERRANE_SANITIZERS)
  target_compile_options(terrane_flags INTERFACE -fsanitize=${TERRANE_SANITIZERS} -fno-omit-frame-pointer)
  target_link_options(terrane_flags INTERFACE -fsanitize=${TERRANE_SANITIZERS})
  if(TERRANE_SANITIZERS MATCHES "undefined")
    # Clang's check of function pointers' types fails to assemble coroutines ("Cannot represent a difference across sections"); GCC has none.
    target_compile_options(terrane_flags INTERFACE -fno-sanitize-recover=all $<$<CXX_COMPILER_ID:Clang>:-fno-sanitize=function>)
  endif()
  if(TERRANE_SANITIZERS MATCHES "thread")
    # Beast's timeouts and Asio's fences are atomics that ThreadSanitizer models; its warning about fences is no finding.
    target_compile_options(terrane_flags INTERFACE $<$<CXX_COMPILER_ID:GNU>:-Wno-tsan>)
  endif()
endif()
# Linked last by what is tried by no one: undefined behaviour is looked for in what it calls, not in it.
add_library(terrane_defined INTERFACE)
add_library(terrane::defined ALIAS terrane_defined)
if(TERRANE_SANITIZERS MATCHES "undefined")
  target_compile_options(terrane_defined INTERFACE -fno-sanitize=undefined)
endif()

find_program(CCACHE_PROGRAM ccache)
if(CCACHE_PROGRAM AND NOT CMAKE_CXX_COMPILER_LAUNCHER)
  # Relative paths, so that another checkout of the same sources hits too; the rest is what precompiled headers ask for.
  set(CMAKE_CXX_COMPILER_LAUNCHER ${CMAKE_COMMAND} -E env CCACHE_BASEDIR=${CMAKE_SOURCE_DIR} CCACHE_NOHASHDIR=1
    CCACHE_SLOPPINESS=pch_defines,time_macros ${CCACHE_PROGRAM})
endif()

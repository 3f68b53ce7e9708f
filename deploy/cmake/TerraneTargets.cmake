# A library is a folder: every .cpp in it (and below it) belongs to it, except the ones that hold a main().
function(terrane_library name)
  cmake_parse_arguments(ARG "" "" "FOLDERS;PUBLIC;PRIVATE" ${ARGN})
  set(sources "")
  foreach(folder ${ARG_FOLDERS})
    file(GLOB_RECURSE found CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/${folder}/*.cpp)
    list(APPEND sources ${found})
  endforeach()
  add_library(${name} STATIC ${sources})
  target_link_libraries(${name} PUBLIC terrane::flags ${ARG_PUBLIC} PRIVATE ${ARG_PRIVATE})
  terrane_precompile_headers(${name})
endfunction()

# Headers that nearly every file includes are read once for all that are alike: one set for what ships, one for test
# programs. A file includes what it uses all the same: deploy/test.sh --full builds without this
# (CMAKE_DISABLE_PRECOMPILE_HEADERS).
function(terrane_precompile kind name)
  get_property(donor GLOBAL PROPERTY TERRANE_HEADERS_OF_${kind})
  if(donor)
    target_precompile_headers(${name} REUSE_FROM ${donor})
  else()
    set_property(GLOBAL PROPERTY TERRANE_HEADERS_OF_${kind} ${name})
    target_precompile_headers(${name} PRIVATE ${ARGN})
  endif()
endfunction()

function(terrane_precompile_headers name)
  target_link_libraries(${name} PRIVATE fmt::fmt)  # what is defined must be the same for all
  terrane_precompile(PROGRAMS ${name} <algorithm> <array> <chrono> <cmath> <cstdint> <functional> <memory> <mutex> <optional>
    <span> <string> <string_view> <unordered_map> <utility> <vector> <glm/glm.hpp> <fmt/format.h> <boost/system/result.hpp>)
endfunction()

function(terrane_precompile_test_headers kind name)
  terrane_precompile(${kind} ${name} <gmock/gmock.h> <gtest/gtest.h> <algorithm> <array> <chrono> <cmath> <functional> <map>
    <memory> <random> <string> <thread> <vector> <glm/glm.hpp> <fmt/format.h> <boost/system/result.hpp>)
endfunction()

# A test program is a folder under tests/. Its cases are listed one by one in ctest, under the given label. PROCESSORS: how many one of
# them keeps busy.
function(terrane_test name)
  cmake_parse_arguments(ARG "" "FOLDER;LABEL;TIMEOUT;PROCESSORS" "LIBRARIES" ${ARGN})
  if(NOT ARG_TIMEOUT)
    set(ARG_TIMEOUT 300)
  endif()
  if(NOT ARG_PROCESSORS)
    set(ARG_PROCESSORS 1)
  endif()
  file(GLOB_RECURSE sources CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/${ARG_FOLDER}/*.cpp)
  if(NOT sources)
    return()
  endif()
  add_executable(${name} ${sources})
  target_link_libraries(${name} PRIVATE ${ARG_LIBRARIES} terrane_test_folders GTest::gmock GTest::gtest_main)
  # What numeric tests try is inline and must be as fast programs have it; of other tests only what they call matters, and
  # optimising assertions takes a third of their compilation.
  if(ARG_LABEL STREQUAL "numeric")
    terrane_precompile_test_headers(NUMERIC_TESTS ${name})
  else()
    target_compile_options(${name} PRIVATE $<$<CONFIG:Release>:-O1>)
    target_link_libraries(${name} PRIVATE terrane::defined)
    terrane_precompile_test_headers(TESTS ${name})
  endif()
  gtest_discover_tests(${name} DISCOVERY_TIMEOUT 60 PROPERTIES LABELS ${ARG_LABEL} TIMEOUT ${ARG_TIMEOUT} PROCESSORS ${ARG_PROCESSORS})
endfunction()

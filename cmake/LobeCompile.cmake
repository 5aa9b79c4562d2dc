# One place for what every target of the project is compiled with.
if(PROJECT_IS_TOP_LEVEL)
  if(NOT CMAKE_BUILD_TYPE)
    set(CMAKE_BUILD_TYPE Release CACHE STRING "" FORCE)
  endif()
  set(CMAKE_RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/bin)
  set(CMAKE_EXPORT_COMPILE_COMMANDS ON)
endif()

# -ffp-contract=off: the same bits whatever the instruction set.
add_library(lobe_compile INTERFACE)
target_compile_features(lobe_compile INTERFACE cxx_std_20)
target_compile_options(lobe_compile INTERFACE -ffp-contract=off)
target_compile_definitions(lobe_compile INTERFACE EIGEN_MPL2_ONLY)
if(PROJECT_IS_TOP_LEVEL)
  target_compile_options(lobe_compile INTERFACE -Wall -Wextra -Wpedantic -Wshadow)
  # Recipes of package managers switch it off: their compilers may know more warnings.
  if(NOT DEFINED CMAKE_COMPILE_WARNING_AS_ERROR OR CMAKE_COMPILE_WARNING_AS_ERROR)
    target_compile_options(lobe_compile INTERFACE -Werror)
  endif()
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13)
    # False alarms in std::string (GCC bug 105651)
    target_compile_options(lobe_compile INTERFACE -Wno-restrict)
  endif()
endif()
# clang would read a number that was just written as a part of a vector, which waits until the write has
# left the processor's buffer: selective masses took six times as long. Results have the same bits.
if(CMAKE_CXX_COMPILER_ID STREQUAL "Clang")
  target_compile_options(lobe_compile INTERFACE "SHELL:-mllvm -disable-vector-combine")
endif()
if(LOBE_FUZZ)
  add_compile_options(-fsanitize=fuzzer-no-link)
endif()
if(LOBE_SANITIZE)
  add_compile_options(-fsanitize=address,undefined -fno-sanitize-recover=undefined -fno-omit-frame-pointer)
  add_link_options(-fsanitize=address,undefined)
  add_compile_definitions(LOBE_SANITIZED)  # clang tells nobody
endif()
if(LOBE_THREAD_SANITIZE)
  add_compile_options(-fsanitize=thread)
  add_link_options(-fsanitize=thread)
  add_compile_definitions(LOBE_SANITIZED)
endif()

# GCC collects its garbage from 128 MB on, which takes an eighth of the time of a unit; it changes nothing in
# the code. So it collects none below a quarter of what each core has of the memory, or 4 GB.
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  cmake_host_system_information(RESULT megabytes QUERY TOTAL_PHYSICAL_MEMORY)
  cmake_host_system_information(RESULT cores QUERY NUMBER_OF_LOGICAL_CORES)
  math(EXPR heap "1024 * ${megabytes} / (4 * ${cores})")  # [KiB]
  if(heap GREATER 4000000)
    set(heap 4000000)
  endif()
  target_compile_options(lobe_compile INTERFACE "SHELL:--param ggc-min-heapsize=${heap}")
endif()

# Headers that most units of a target include, precompiled: they take a second of each. None of the
# library's own, so that a change to one of them compiles what includes it and nothing else. ccache cannot
# look into precompiled headers.
if(CMAKE_CXX_COMPILER_LAUNCHER MATCHES "ccache")
  set(CMAKE_DISABLE_PRECOMPILE_HEADERS ON)
elseif(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13)
  # The same bug as above: a precompiled header of the system counts as one of ours, whose warnings are shown.
  target_compile_options(lobe_compile INTERFACE -Wno-stringop-overflow -Wno-stringop-overread -Wno-array-bounds)
endif()
# Files of a target that are compiled as one unit, so that headers are read and their templates made once for
# all of them: their names without linkage must differ. The headers' own includes are checked by the presets
# without it.
set(CMAKE_UNITY_BUILD ${LOBE_UNITY})
if(LOBE_UNITY)
  target_compile_options(lobe_compile INTERFACE -Wno-shadow)  # of a name in another file
endif()
function(lobe_precompile target)  # further headers…
  target_precompile_headers(${target} PRIVATE <algorithm> <array> <cmath> <cstdint> <filesystem> <functional> <future>
    <limits> <map> <memory> <numeric> <optional> <span> <sstream> <string> <vector> <Eigen/Geometry> <Eigen/LU>
    <Eigen/SparseCore> ${ARGN})
endfunction()
# For code that only calls the library, as tests do: the precompiled header of the tests, where there are any.
function(lobe_precompile_as_tests target)
  if(TARGET lobe_precompiled)
    target_precompile_headers(${target} REUSE_FROM lobe_precompiled)
  endif()
endfunction()
# Code that runs once per command or per frame, not per step: -O1 takes a third less to compile.
function(lobe_optimise_lightly target)
  target_compile_options(${target} PRIVATE $<$<CONFIG:Release>:-O1>)
endfunction()

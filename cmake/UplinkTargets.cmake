# One CMake target a folder. A target sees only what it links, so an include in the wrong direction
# finds its generated headers or link symbols missing; the tidy test says which rule it broke.
set(CMAKE_CXX_STANDARD 20)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_RUNTIME_OUTPUT_DIRECTORY "${CMAKE_BINARY_DIR}/bin")

find_program(UPLINK_CCACHE ccache)
if(UPLINK_CCACHE)
  # Precompiled headers and ccache agree only with the first of these settings. The others, with the
  # prefix map below, let every clone of the tree share one cache, wherever it lies.
  set(CMAKE_CXX_COMPILER_LAUNCHER
      "${CMAKE_COMMAND}" -E env "CCACHE_SLOPPINESS=pch_defines,time_macros,include_file_mtime,include_file_ctime"
      "CCACHE_BASEDIR=${PROJECT_SOURCE_DIR}" "CCACHE_NOHASHDIR=1"
      "${UPLINK_CCACHE}")
  add_compile_options("-ffile-prefix-map=${PROJECT_SOURCE_DIR}/=")
endif()

# g++ takes a precompiled header only where this is the same, and some packages ask for it.
add_compile_options(-pthread)

if(UPLINK_SANITIZE)
  add_compile_options("-fsanitize=${UPLINK_SANITIZE}" -fno-omit-frame-pointer)
  add_link_options("-fsanitize=${UPLINK_SANITIZE}")
  if(UPLINK_SANITIZE MATCHES "thread")
    # Asio's fences, which ThreadSanitizer does not see.
    add_compile_options(-Wno-tsan)
  endif()
  if(UPLINK_SANITIZE MATCHES "undefined")
    add_compile_options(-fno-sanitize-recover=undefined)
  endif()
endif()

# What is run and measured is hardened (see SECURITY.md); the sanitizers see more, and a
# debug build is for editing. The executables are bound whole at their start, so that no table of
# functions stays writable.
option(UPLINK_HARDEN "Harden optimised builds" ON)
if(UPLINK_HARDEN AND NOT UPLINK_SANITIZE)
  set(hardened $<CONFIG:RelWithDebInfo,Release,MinSizeRel>)
  add_compile_options("$<${hardened}:-fstack-protector-strong;-fstack-clash-protection;-fPIE>")
  add_compile_definitions("$<${hardened}:_FORTIFY_SOURCE=2;_GLIBCXX_ASSERTIONS>")
  add_link_options("$<${hardened}:-pie;-Wl,-z,relro;-Wl,-z,now;-Wl,-z,pack-relative-relocs>")
endif()

add_library(uplink_warnings INTERFACE)
target_compile_options(
  uplink_warnings
  INTERFACE -Wall -Wextra -Wconversion -Wsign-conversion -Wshadow -Wold-style-cast -Wnon-virtual-dtor
            # designated initialisers leave members to their defaults on purpose
            -Wno-missing-field-initializers
            $<$<BOOL:${UPLINK_WARNINGS_AS_ERRORS}>:-Werror>
            # g++ 12 reports these falsely inside std::string and std::variant at -O2
            $<$<CXX_COMPILER_ID:GNU>:-Wno-restrict -Wno-maybe-uninitialized -Wno-stringop-overflow>)

# The headers that most units take a second to read. No header whose meaning a define of some target
# changes, such as fmt's or Boost's: g++ would not take it there.
set(UPLINK_COMMON_HEADERS
    <algorithm>
    <array>
    <atomic>
    <chrono>
    <functional>
    <map>
    <memory>
    <mutex>
    <optional>
    <set>
    <span>
    <string>
    <unordered_map>
    <utility>
    <variant>
    <vector>
    <absl/status/statusor.h>)

# uplink_precompiled(name [TARGET | header ...]): precompiles the common headers and these, or takes
# what was precompiled for another target; without either, the common headers alone.
function(uplink_precompiled name)
  if(UPLINK_FUZZ)
    return() # what is fuzzed has flags of its own
  endif()
  if(NOT ARGN)
    target_precompile_headers(${name} REUSE_FROM uplink_common_header)
  elseif(TARGET "${ARGN}")
    target_precompile_headers(${name} REUSE_FROM ${ARGN})
  else()
    target_precompile_headers(${name} PRIVATE ${UPLINK_COMMON_HEADERS} ${ARGN})
  endif()
endfunction()

# uplink_library(name SOURCES a.cc ... [PUBLIC lib ...] [PRIVATE lib ...]
#                [PRECOMPILED target | header ...])
function(uplink_library name)
  cmake_parse_arguments(ARG "" "" "SOURCES;PUBLIC;PRIVATE;PRECOMPILED" ${ARGN})
  add_library(${name} STATIC ${ARG_SOURCES})
  target_include_directories(${name} PUBLIC "${PROJECT_SOURCE_DIR}")
  target_link_libraries(${name} PUBLIC ${ARG_PUBLIC} PRIVATE ${ARG_PRIVATE} uplink_warnings)
  uplink_precompiled(${name} ${ARG_PRECOMPILED})
endfunction()

# uplink_compact(name ...): compiled for size, which is what counts where a person waits; the image has a
# bound. What is precompiled is compiled for speed, and does not fit.
function(uplink_compact)
  set_target_properties(${ARGV} PROPERTIES DISABLE_PRECOMPILE_HEADERS ON)
  foreach(name ${ARGV})
    target_compile_options(${name} PRIVATE $<$<CONFIG:RelWithDebInfo>:-Os>)
  endforeach()
endfunction()

# uplink_interface(name [PUBLIC lib ...]): a folder of headers only
function(uplink_interface name)
  cmake_parse_arguments(ARG "" "" "PUBLIC" ${ARGN})
  add_library(${name} INTERFACE)
  target_include_directories(${name} INTERFACE "${PROJECT_SOURCE_DIR}")
  target_link_libraries(${name} INTERFACE ${ARG_PUBLIC})
endfunction()

# uplink_program(name SOURCES a.cc ... LINK lib ...)
function(uplink_program name)
  cmake_parse_arguments(ARG "" "" "SOURCES;LINK" ${ARGN})
  add_executable(${name} ${ARG_SOURCES})
  target_include_directories(${name} PRIVATE "${PROJECT_SOURCE_DIR}")
  target_link_libraries(${name} PRIVATE ${ARG_LINK} uplink_warnings)
  uplink_precompiled(${name})
endfunction()

# Where a private PostgreSQL cluster of the test run says what it is; tests/CMakeLists.txt starts it.
set(UPLINK_TEST_POSTGRES "${CMAKE_BINARY_DIR}/postgres.state")

# What every test's own files are compiled with: little optimisation, which costs more there than it
# saves (the product that they run has its own flags), and one precompiled header.
add_library(uplink_test_flags INTERFACE)
target_compile_options(
  uplink_test_flags
  INTERFACE $<$<CONFIG:RelWithDebInfo>:-O1>
            # g++ 12 reports these falsely inside std::string at -O1
            $<$<CXX_COMPILER_ID:GNU>:-Wno-array-bounds>)

# uplink_test(name RING unit|component|e2e SOURCES a.cc ... LINK lib ... [NEEDS postgres]
#             [TIMEOUT seconds] [COST seconds])
# Every test of the binary becomes a CTest test of that ring. NEEDS names what CTest starts before. COST is
# what its longest test takes: the longest start first, so that none runs alone at the end.
function(uplink_test name)
  cmake_parse_arguments(ARG "" "RING;TIMEOUT;COST" "SOURCES;LINK;NEEDS" ${ARGN})
  if(NOT ARG_TIMEOUT)
    set(ARG_TIMEOUT 120)
  endif()
  if(NOT ARG_COST)
    set(ARG_COST 0)
  endif()
  set(needs)
  if(ARG_NEEDS)
    set(needs FIXTURES_REQUIRED "${ARG_NEEDS}" ENVIRONMENT "UPLINK_TEST_POSTGRES=${UPLINK_TEST_POSTGRES}")
  endif()
  add_executable(${name} ${ARG_SOURCES})
  target_include_directories(${name} PRIVATE "${PROJECT_SOURCE_DIR}")
  target_link_libraries(${name} PRIVATE ${ARG_LINK} GTest::gtest GTest::gmock GTest::gtest_main
                                        uplink_test_flags uplink_warnings)
  target_precompile_headers(${name} REUSE_FROM uplink_test_header)
  include(GoogleTest)
  gtest_discover_tests(
    ${name}
    TEST_PREFIX "${name}."
    DISCOVERY_TIMEOUT 60
    PROPERTIES LABELS ${ARG_RING} TIMEOUT ${ARG_TIMEOUT} COST ${ARG_COST} PROCESSORS 2 ${needs}
    WORKING_DIRECTORY "${PROJECT_SOURCE_DIR}")
endfunction()

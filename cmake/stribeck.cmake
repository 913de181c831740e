# Compiler settings and the one function that turns a folder into a target.

set(CMAKE_CXX_STANDARD 20)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)
if(NOT EMSCRIPTEN)
  set(CMAKE_POSITION_INDEPENDENT_CODE ON)
endif()

if(NOT CMAKE_BUILD_TYPE)
  set(CMAKE_BUILD_TYPE Release)
endif()

find_program(CCACHE ccache)
if(CCACHE AND NOT CMAKE_CXX_COMPILER_LAUNCHER)
  # Sloppy only about what precompiled headers need; the base folder lets another checkout hit the same cache.
  set(CMAKE_CXX_COMPILER_LAUNCHER
      ${CMAKE_COMMAND} -E env CCACHE_BASEDIR=${PROJECT_SOURCE_DIR} CCACHE_NOHASHDIR=true
      CCACHE_SLOPPINESS=pch_defines,time_macros,include_file_mtime,include_file_ctime)
  # ccache does not make paths with a blank relative in the list of included files. Another checkout that got such a list from the
  # cache would watch this one's files, and not compile its own again when they change.
  if(PROJECT_SOURCE_DIR MATCHES " ")
    list(APPEND CMAKE_CXX_COMPILER_LAUNCHER CCACHE_READONLY=true)
  endif()
  if(STRIBECK_SANITIZE)
    list(APPEND CMAKE_CXX_COMPILER_LAUNCHER CCACHE_EXTRAFILES=${PROJECT_SOURCE_DIR}/cmake/sanitize_ignore.txt)
  endif()
  list(APPEND CMAKE_CXX_COMPILER_LAUNCHER ${CCACHE})
endif()

# One interface target carries the flags. No contraction and no fast-math: the same bytes everywhere.
# No math errno: square roots become one instruction; results are the same.
add_library(stribeck_flags INTERFACE)
target_compile_options(stribeck_flags INTERFACE
  -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wno-sign-conversion
  -ffp-contract=off -fno-math-errno)
if(STRIBECK_JOIN_TIMES GREATER 1)
  # A local name may be that of another file of a large group; each file by itself is looked at in the small groups.
  target_compile_options(stribeck_flags INTERFACE -Wno-shadow)
endif()
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  # GCC 12 reports false positives here for std::variant, std::optional and, behind a precompiled header, std::string.
  target_compile_options(stribeck_flags INTERFACE -Wno-maybe-uninitialized -Wno-array-bounds -Wno-restrict -Wno-stringop-overread
                         -Wno-stringop-overflow)
  # The compiler collects its garbage at 256 MB instead of 128 MB: a tenth less time in the large units, and no more memory at the peak.
  target_compile_options(stribeck_flags INTERFACE --param=ggc-min-expand=100 --param=ggc-min-heapsize=262144)
endif()
if(STRIBECK_SANITIZE)
  # Null pointers and what lies beyond an object are the address sanitizer's as well; these four checks are half the compile time.
  target_compile_options(stribeck_flags INTERFACE -fsanitize=${STRIBECK_SANITIZE} -fno-omit-frame-pointer
                         -fno-sanitize-recover=all -fno-sanitize=null,alignment,object-size,vptr)
  target_link_options(stribeck_flags INTERFACE -fsanitize=${STRIBECK_SANITIZE})
  if(CMAKE_CXX_COMPILER_ID MATCHES "Clang")
    # Relative to the build folder, where the compiler runs: the compiler cache knows the file in another checkout too.
    file(RELATIVE_PATH ignored ${CMAKE_BINARY_DIR} ${PROJECT_SOURCE_DIR}/cmake/sanitize_ignore.txt)
    target_compile_options(stribeck_flags INTERFACE -fsanitize-ignorelist=${ignored})
  endif()
endif()
if(STRIBECK_WERROR AND (NOT STRIBECK_SANITIZE OR CMAKE_CXX_COMPILER_ID MATCHES "Clang"))
  # Not with the sanitizers of GCC: the instrumentation sets off false warnings there.
  target_compile_options(stribeck_flags INTERFACE -Werror)
endif()

if(STRIBECK_TESTS AND NOT STRIBECK_RT_ONLY)
  find_package(GTest REQUIRED)
  include(GoogleTest)
  enable_testing()
endif()

# stribeck_join(<target> SIZE <n> [ALONE <file>...]): the compiler reads the sources of a folder in groups of n, which halves the time
# to compile everything (decision 0012). Names in anonymous namespaces must therefore differ within a folder. ALONE: files that are
# compiled by themselves. With STRIBECK_JOIN off every file is. STRIBECK_JOIN_TIMES makes groups that many times as large.
function(stribeck_join target)
  cmake_parse_arguments(J "" "SIZE" "ALONE" ${ARGN})
  if(NOT STRIBECK_JOIN)
    return()
  endif()
  get_target_property(sources ${target} SOURCES)
  foreach(source IN LISTS sources)
    file(RELATIVE_PATH name ${CMAKE_CURRENT_SOURCE_DIR} ${source})
    if(name IN_LIST J_ALONE)
      continue()
    endif()
    get_filename_component(folder ${name} DIRECTORY)
    string(MAKE_C_IDENTIFIER "room_${folder}" folder)
    math(EXPR count_${folder} "0${count_${folder}} + 1")
    math(EXPR group "${count_${folder}} / (${J_SIZE} * ${STRIBECK_JOIN_TIMES})")
    set_source_files_properties(${source} PROPERTIES UNITY_GROUP ${folder}_${group})
  endforeach()
  set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_MODE GROUP)
endfunction()

# stribeck_precompile(<target> <header>... | REUSE_FROM <target>): headers of other libraries that many files of the target
# include. Never a header of this project: a change of it would compile everything again.
function(stribeck_precompile target)
  cmake_parse_arguments(P "" "REUSE_FROM" "" ${ARGN})
  if(P_REUSE_FROM)
    target_precompile_headers(${target} REUSE_FROM ${P_REUSE_FROM})
  else()
    target_precompile_headers(${target} PRIVATE ${P_UNPARSED_ARGUMENTS})
  endif()
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    target_compile_options(${target} PRIVATE $<$<COMPILE_LANGUAGE:CXX>:-fpch-preprocess>)  # what ccache needs to see through the header
  endif()
endfunction()
set(STRIBECK_STANDARD_HEADERS <algorithm> <array> <cmath> <functional> <limits> <map> <numeric> <optional> <random> <span>
                              <stdexcept> <string> <string_view> <variant> <vector>)

# How far texts and tests are optimised. With sanitizers not at all: Clang would spend more than half of its time on optimising the
# checks.
set(STRIBECK_LIGHT $<$<CONFIG:Release>:-O1>)
if(STRIBECK_SANITIZE)
  set(STRIBECK_LIGHT -O0)
endif()

# stribeck_texts(<target> [HEADERS <header>...]): for what writes pages, tables and messages. -O1 costs a third less to compile than
# -O2 and nothing that a user feels. The headers that all of them include are compiled once, or with more HEADERS once more.
function(stribeck_texts target)
  cmake_parse_arguments(P "" "" "HEADERS" ${ARGN})
  set(headers ${STRIBECK_STANDARD_HEADERS} <fmt/format.h> <nlohmann/json.hpp>)
  target_compile_options(${target} PRIVATE ${STRIBECK_LIGHT})
  if(P_HEADERS)
    stribeck_precompile(${target} ${headers} ${P_HEADERS})
    return()
  endif()
  if(NOT TARGET stribeck_text_headers)
    file(CONFIGURE OUTPUT ${PROJECT_BINARY_DIR}/text_headers.cpp CONTENT "")
    add_library(stribeck_text_headers OBJECT EXCLUDE_FROM_ALL ${PROJECT_BINARY_DIR}/text_headers.cpp)
    target_link_libraries(stribeck_text_headers PRIVATE stribeck_flags fmt::fmt nlohmann_json::nlohmann_json)
    target_compile_options(stribeck_text_headers PRIVATE ${STRIBECK_LIGHT})
    stribeck_precompile(stribeck_text_headers ${headers})
  endif()
  stribeck_precompile(${target} REUSE_FROM stribeck_text_headers)
endfunction()

# stribeck_module(<folder> TIER rt|lab|app [LINKS <modules and libraries>...])
# Every .cpp of the folder and of its rooms (folders below it) is library or test: *_test.cpp goes to <folder>_test.
function(stribeck_module name)
  cmake_parse_arguments(M "" "TIER" "LINKS;TEST_LINKS" ${ARGN})
  file(GLOB_RECURSE sources CONFIGURE_DEPENDS *.cpp)
  set(tests ${sources})
  list(FILTER sources EXCLUDE REGEX "_test\\.cpp$")
  list(FILTER tests INCLUDE REGEX "_test\\.cpp$")
  set(target stribeck_${name})
  if(sources)
    add_library(${target} STATIC ${sources})
    set(scope PUBLIC)
    target_link_libraries(${target} PRIVATE $<BUILD_INTERFACE:stribeck_flags>)
  else()
    add_library(${target} INTERFACE)
    set(scope INTERFACE)
  endif()
  target_include_directories(${target} ${scope} $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/src> $<INSTALL_INTERFACE:include>)
  target_link_libraries(${target} ${scope} ${M_LINKS})
  if(M_TIER STREQUAL "rt" AND sources)
    # Frames of the optimised program: -O0 and the sanitizers blow them up.
    target_compile_options(${target} PRIVATE $<$<CONFIG:Release>:-Wframe-larger-than=2560>)
    if(STRIBECK_RT_ONLY)
      target_compile_options(${target} PRIVATE -fno-exceptions -fno-rtti)
    endif()
  endif()
  add_library(stribeck::${name} ALIAS ${target})
  set_target_properties(${target} PROPERTIES EXPORT_NAME ${name})
  if(M_TIER STREQUAL "rt" AND STRIBECK_RT_ONLY)
    # Most of the tier is templates in headers: each header is compiled by itself.
    file(GLOB_RECURSE headers RELATIVE ${PROJECT_SOURCE_DIR}/src CONFIGURE_DEPENDS *.hpp)
    set(probes "")
    foreach(header IN LISTS headers)
      set(probe ${CMAKE_CURRENT_BINARY_DIR}/headers/${header}.cpp)
      file(CONFIGURE OUTPUT ${probe} CONTENT "#include <${header}>\n")
      list(APPEND probes ${probe})
    endforeach()
    add_library(${target}_headers OBJECT ${probes})
    target_link_libraries(${target}_headers PRIVATE ${target} stribeck_flags)
    target_compile_options(${target}_headers PRIVATE -fno-exceptions -fno-rtti)
  endif()
  if(tests AND STRIBECK_TESTS AND NOT STRIBECK_RT_ONLY)
    stribeck_test(${name}_test SOURCES ${tests} LINKS stribeck::${name} ${M_TEST_LINKS})
  endif()
endfunction()

# stribeck_test(<name> SOURCES ... LINKS ... [LABELS slow] [COST <seconds>]): a GoogleTest program, each test known to CTest. COST: what its
# longest test takes, so that CTest begins with it and no processor waits at the end.
# ./check leaves out what is labelled slow; .ci/run runs it. The compiler reads eight files at a time (decision 0012): each test file
# has a namespace of its own, which is called like the file.
function(stribeck_test name)
  cmake_parse_arguments(T "" "COST" "SOURCES;LINKS;LABELS" ${ARGN})
  add_executable(${name} ${T_SOURCES})
  target_link_libraries(${name} PRIVATE ${T_LINKS} stribeck_flags GTest::gmock GTest::gtest GTest::gtest_main)
  # Tests are three fifths of everything that is compiled, and little of what runs in them is theirs: the libraries keep their -O2. With
  # -O0 the tests took longer than the compiler gained.
  target_compile_options(${name} PRIVATE ${STRIBECK_LIGHT})
  if(NOT TARGET stribeck_test_headers)
    # Compiled once for all test programs. A program, because position-independent code differs between one and a library.
    file(CONFIGURE OUTPUT ${PROJECT_BINARY_DIR}/test_headers.cpp CONTENT "")
    add_executable(stribeck_test_headers EXCLUDE_FROM_ALL ${PROJECT_BINARY_DIR}/test_headers.cpp)
    target_link_libraries(stribeck_test_headers PRIVATE stribeck_flags GTest::gmock GTest::gtest GTest::gtest_main)
    target_compile_options(stribeck_test_headers PRIVATE ${STRIBECK_LIGHT})
    stribeck_precompile(stribeck_test_headers <gtest/gtest.h> <gmock/gmock.h> ${STRIBECK_STANDARD_HEADERS})
  endif()
  stribeck_precompile(${name} REUSE_FROM stribeck_test_headers)
  if(STRIBECK_SANITIZE AND T_LINKS MATCHES "stribeck(::ident|::workflow|::targets|_verbs|_web)")
    # Where several objects hold the same function of Eigen, the linker takes the first one. That must be the optimised one of the library:
    # with that of the test, which is not optimised, a test of 6 s took 247 s.
    target_link_options(${name} PRIVATE LINKER:--whole-archive $<TARGET_FILE:stribeck_ident> LINKER:--no-whole-archive)
  endif()
  # STRIBECK_SOURCE_DIR comes from a header, not the command line: a path there, or in the precompiled header,
  # would keep the cache of one checkout from serving another.
  set(header ${PROJECT_BINARY_DIR}/source_dir.hpp)
  file(CONFIGURE OUTPUT ${header} CONTENT "#define STRIBECK_SOURCE_DIR \"${PROJECT_SOURCE_DIR}\"\n")
  target_compile_options(${name} PRIVATE $<$<COMPILE_LANGUAGE:CXX>:-include${header}>)
  if(STRIBECK_JOIN)
    math(EXPR size "8 * ${STRIBECK_JOIN_TIMES}")
    set_target_properties(${name} PROPERTIES UNITY_BUILD ON UNITY_BUILD_BATCH_SIZE ${size})
  endif()
  if(T_LABELS)
    list(APPEND properties LABELS "${T_LABELS}")
  endif()
  if(T_COST)
    list(APPEND properties COST ${T_COST})
  endif()
  if(properties)
    list(PREPEND properties PROPERTIES)
  endif()
  gtest_discover_tests(${name} DISCOVERY_TIMEOUT 60 ${properties})
endfunction()

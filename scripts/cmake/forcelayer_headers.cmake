# Precompiled headers: those of others, read once for all sources that are compiled with the same options.
# A source includes all that it uses, as the builds without them show: scripts/package.sh, and those of clang without
# sanitizers, whose precompiled headers bear no second optimization level.
include(CMakeDependentOption)
cmake_dependent_option(FORCELAYER_PRECOMPILED_HEADERS "Read the headers of others once for many sources" ON
                       "CMAKE_CXX_COMPILER_ID STREQUAL GNU OR CMAKE_CXX_FLAGS MATCHES fsanitize" OFF)

set(forcelayer_standard_headers
  <algorithm> <array> <atomic> <bit> <charconv> <chrono> <cmath> <cstdint> <cstdio> <cstring> <filesystem>
  <fstream> <functional> <limits> <map> <memory> <mutex> <numbers> <numeric> <optional> <random> <set>
  <span> <sstream> <stdexcept> <string> <string_view> <thread> <unordered_map> <utility> <vector>)

# forcelayer_headers(GROUP [LIBRARY] [OPTIONS ...] [HEADERS ...] [LIBRARIES ...]): a group of sources that
# are compiled with these options, for libraries or for executables. HEADERS, of LIBRARIES, stand
# beside the standard ones.
function(forcelayer_headers group)
  if(NOT FORCELAYER_PRECOMPILED_HEADERS)
    return()
  endif()
  cmake_parse_arguments(ARG "LIBRARY" "" "OPTIONS;HEADERS;LIBRARIES" ${ARGN})
  set(empty ${PROJECT_BINARY_DIR}/empty.cpp)
  file(CONFIGURE OUTPUT ${empty} CONTENT "")
  add_library(forcelayer_headers_${group} OBJECT ${empty})
  target_link_libraries(forcelayer_headers_${group} PRIVATE forcelayer_options ${ARG_LIBRARIES})
  target_compile_options(forcelayer_headers_${group} PRIVATE ${ARG_OPTIONS})
  if(NOT ARG_LIBRARY)
    set_target_properties(forcelayer_headers_${group} PROPERTIES POSITION_INDEPENDENT_CODE OFF)
    target_compile_options(forcelayer_headers_${group} PRIVATE ${CMAKE_CXX_COMPILE_OPTIONS_PIE})
  endif()
  forcelayer_own_headers(forcelayer_headers_${group} ${ARG_HEADERS})
endfunction()

# forcelayer_use_headers(TARGET GROUP): the target's sources belong to the group.
function(forcelayer_use_headers target group)
  if(FORCELAYER_PRECOMPILED_HEADERS)
    target_precompile_headers(${target} REUSE_FROM forcelayer_headers_${group})
  endif()
endfunction()

# forcelayer_own_headers(TARGET HEADERS ...): the target's sources are a group of their own.
function(forcelayer_own_headers target)
  if(FORCELAYER_PRECOMPILED_HEADERS)
    target_precompile_headers(${target} PRIVATE ${forcelayer_standard_headers} ${ARGN})
  endif()
endfunction()

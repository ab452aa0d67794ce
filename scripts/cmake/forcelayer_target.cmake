# Shared by every target of the project: warnings, floating-point rules, include paths, aliases.

add_library(forcelayer_options INTERFACE)
# No contraction into FMA: the scalar twins in the tests must agree with the fast paths bit for bit.
target_compile_options(forcelayer_options INTERFACE
  $<BUILD_INTERFACE:-Wall -Wextra -Wpedantic -Wshadow -ffp-contract=off>
  # Nobody reads errno after a square root, which is one instruction without it.
  $<BUILD_INTERFACE:-fno-math-errno>
  # gcc 12 wrongly sees overlapping copies in `"text" + std::string` (its bug 105651).
  $<$<CXX_COMPILER_ID:GNU>:$<BUILD_INTERFACE:-Wno-restrict>>
  $<$<BOOL:${FORCELAYER_WARNINGS_AS_ERRORS}>:-Werror>
  # The same bytes wherever the sources lie.
  $<BUILD_INTERFACE:-ffile-prefix-map=${PROJECT_SOURCE_DIR}/=>
  # Release builds are hardened: they read other people's files and hold a motor.
  $<$<CONFIG:Release>:$<BUILD_INTERFACE:-fstack-protector-strong;-fstack-clash-protection;-U_FORTIFY_SOURCE;-D_FORTIFY_SOURCE=2>>
  $<$<AND:$<CONFIG:Release>,$<STREQUAL:${CMAKE_SYSTEM_PROCESSOR},x86_64>>:$<BUILD_INTERFACE:-fcf-protection>>)
include(CheckPIESupported)
check_pie_supported()
include(forcelayer_headers)
if(FORCELAYER_PRECOMPILED_HEADERS AND CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  # More of that bug, which gcc 12 silences in headers of the system that are not precompiled.
  # scripts/package.sh builds with these warnings.
  target_compile_options(forcelayer_options INTERFACE
    $<BUILD_INTERFACE:-Wno-array-bounds -Wno-stringop-overflow -Wno-stringop-overread>)
endif()
set(forcelayer_once)
if(CMAKE_CXX_FLAGS MATCHES "-fsanitize" AND NOT FORCELAYER_FUZZERS)
  # A command's own code runs once, and takes three fifths of the time of -O1 to compile.
  set(forcelayer_once -O0)
  # Only AVX2 and the baseline of the vector targets: each takes up to half a minute a kernel.
  add_compile_definitions(
    "HWY_DISABLED_TARGETS=(HWY_SSSE3|HWY_SSE4|HWY_AVX3|HWY_AVX3_DL|HWY_SVE|HWY_SVE2|HWY_SVE_256|HWY_SVE2_128|HWY_RVV)")
endif()
forcelayer_headers(library LIBRARY)
forcelayer_headers(command OPTIONS ${forcelayer_once})

# forcelayer_library(NAME SOURCES ... [PUBLIC libs] [PRIVATE libs] [HEADERS ...] [INSTALL])
# makes the static library forcelayer_NAME with the alias forcelayer::NAME. HEADERS are precompiled for SOURCES beside
# the standard ones.
function(forcelayer_library name)
  cmake_parse_arguments(ARG "INSTALL" "" "SOURCES;PUBLIC;PRIVATE;HEADERS" ${ARGN})
  add_library(forcelayer_${name} STATIC ${ARG_SOURCES})
  add_library(forcelayer::${name} ALIAS forcelayer_${name})
  set_target_properties(forcelayer_${name} PROPERTIES EXPORT_NAME ${name})
  target_include_directories(forcelayer_${name} PUBLIC
    $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}>
    $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/runtime>  # "forcelayer/pose.h", as when installed
    $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>              # <forcelayer/run.h>
    $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}/forcelayer>)  # "formats/result.h"
  target_compile_features(forcelayer_${name} PUBLIC cxx_std_20)
  target_link_libraries(forcelayer_${name} PUBLIC ${ARG_PUBLIC}
                        PRIVATE $<BUILD_INTERFACE:forcelayer_options> ${ARG_PRIVATE})
  if(ARG_HEADERS)
    forcelayer_own_headers(forcelayer_${name} ${ARG_HEADERS})
  else()
    forcelayer_use_headers(forcelayer_${name} library)
  endif()
  if(ARG_INSTALL)
    install(TARGETS forcelayer_${name} EXPORT forcelayer COMPONENT development)
  endif()
endfunction()

# forcelayer_command(NAME [INTERNAL] COMPONENT package SOURCES ... LIBRARIES ...)
# makes and installs the executable NAME, and adds it to the target `commands`. A command that users start
# themselves (not INTERNAL) gets a man page where help2man is installed.
find_program(HELP2MAN help2man)
add_custom_target(commands)
function(forcelayer_command name)
  cmake_parse_arguments(ARG "INTERNAL" "COMPONENT" "SOURCES;LIBRARIES" ${ARGN})
  add_executable(${name} ${ARG_SOURCES})
  add_dependencies(commands ${name})
  target_link_libraries(${name} PRIVATE forcelayer_options ${ARG_LIBRARIES})
  target_compile_options(${name} PRIVATE ${forcelayer_once})
  forcelayer_use_headers(${name} command)
  target_link_options(${name} PRIVATE $<$<CONFIG:Release>:LINKER:-z,relro,-z,now>)
  install(TARGETS ${name} COMPONENT ${ARG_COMPONENT})
  if(NOT ARG_INTERNAL)
    install(FILES ${PROJECT_SOURCE_DIR}/scripts/completion.bash RENAME ${name} COMPONENT ${ARG_COMPONENT}
            DESTINATION ${CMAKE_INSTALL_DATAROOTDIR}/bash-completion/completions)
  endif()
  if(HELP2MAN AND FORCELAYER_MAN_PAGES AND NOT ARG_INTERNAL)
    set(page ${CMAKE_BINARY_DIR}/man/${name}.1.gz)
    add_custom_command(OUTPUT ${page} DEPENDS ${name} ${PROJECT_SOURCE_DIR}/scripts/man_page.sh VERBATIM
      COMMAND ${PROJECT_SOURCE_DIR}/scripts/man_page.sh $<TARGET_FILE:${name}> ${page})
    add_custom_target(${name}_man ALL DEPENDS ${page})
    install(FILES ${page} DESTINATION ${CMAKE_INSTALL_MANDIR}/man1 COMPONENT ${ARG_COMPONENT})
  endif()
endfunction()

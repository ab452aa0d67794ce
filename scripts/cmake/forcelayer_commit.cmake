# FORCELAYER_COMMIT: the commit that is built, as `--version` and reports name it. It follows the checkout;
# -DFORCELAYER_COMMIT=... names it where the sources are no checkout (scripts/package.sh).
set(FORCELAYER_COMMIT "" CACHE STRING "Commit that the commands name; empty: that of the checkout")
set(forcelayer_commit "${FORCELAYER_COMMIT}")
find_package(Git QUIET)
if(forcelayer_commit STREQUAL "" AND GIT_FOUND)
  execute_process(COMMAND ${GIT_EXECUTABLE} rev-parse --show-prefix --short=12 HEAD
    WORKING_DIRECTORY ${PROJECT_SOURCE_DIR} OUTPUT_VARIABLE answer ERROR_QUIET OUTPUT_STRIP_TRAILING_WHITESPACE)
  execute_process(COMMAND ${GIT_EXECUTABLE} rev-parse --git-path logs/HEAD
    WORKING_DIRECTORY ${PROJECT_SOURCE_DIR} OUTPUT_VARIABLE log ERROR_QUIET OUTPUT_STRIP_TRAILING_WHITESPACE)
  # A first line that is not empty: the sources lie in a folder of some other checkout.
  if(answer MATCHES "^\n([0-9a-f]+)$")
    set(forcelayer_commit ${CMAKE_MATCH_1})
    get_filename_component(log "${log}" ABSOLUTE BASE_DIR ${PROJECT_SOURCE_DIR})
    if(EXISTS "${log}")
      set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS "${log}")
    endif()
  endif()
endif()

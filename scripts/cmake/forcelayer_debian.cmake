# Debian packages by `cpack -G DEB` (scripts/package.sh): one for the workstation, one for the CI
# machine that bakes, the viewer apart for its libraries, and two to run with and to build against.
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME forcelayer)
set(CPACK_PACKAGE_CONTACT "The Forcelayer authors <maintainers@forcelayer.example>")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_PACKAGE_RELEASE 1)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
set(CPACK_COMPONENTS_ALL)

# debian_package(COMPONENT NAME SECTION SUMMARY TEXT): the package NAME holds the component.
function(debian_package component name section summary text)
  string(TOUPPER ${component} key)
  list(APPEND CPACK_COMPONENTS_ALL ${component})
  set(CPACK_COMPONENTS_ALL ${CPACK_COMPONENTS_ALL} PARENT_SCOPE)
  set(CPACK_DEBIAN_${key}_PACKAGE_NAME ${name} PARENT_SCOPE)
  set(CPACK_DEBIAN_${key}_PACKAGE_SECTION ${section} PARENT_SCOPE)
  set(CPACK_DEBIAN_${key}_DESCRIPTION "${summary}\n${text}" PARENT_SCOPE)
  set(documents ${CMAKE_BINARY_DIR}/debian/${name})
  file(READ ${PROJECT_SOURCE_DIR}/LICENSE license)
  file(WRITE ${documents}/copyright "Forcelayer\n\n${license}")
  file(WRITE ${documents}/changelog
       "forcelayer (${PROJECT_VERSION}-1) unstable; urgency=medium\n\n"
       "  * Release ${PROJECT_VERSION}.\n\n"
       " -- ${CPACK_PACKAGE_CONTACT}  Thu, 01 Jan 2026 00:00:00 +0000\n")
  execute_process(COMMAND gzip -9nf ${documents}/changelog)  # n: no time in it
  file(RENAME ${documents}/changelog.gz ${documents}/changelog.Debian.gz)
  install(FILES ${documents}/copyright ${documents}/changelog.Debian.gz
          DESTINATION ${CMAKE_INSTALL_DATAROOTDIR}/doc/${name} COMPONENT ${component}
          EXCLUDE_FROM_ALL)
endfunction()

if(TARGET voxelize)
  debian_package(tools forcelayer-tools science "bakes CAD scenes and parts for haptic rendering"
    "voxelize turns static meshes into a voxmap with an offset force layer,\npointshell turns a moving part into a covering set of surface points, and\nvoxinfo checks and exports what they wrote. voxplan finds a way for the part\nout of where it is installed.")
  set(pipelines ${PROJECT_SOURCE_DIR}/scripts/pipelines)
  install(FILES ${pipelines}/github.yml ${pipelines}/gitlab.yml ${pipelines}/slurm.sh COMPONENT tools EXCLUDE_FROM_ALL
          DESTINATION ${CMAKE_INSTALL_DATAROOTDIR}/doc/forcelayer-tools/examples/pipelines)
endif()
# Packages of the programs that a command starts, or names where they are missing.
set(CPACK_DEBIAN_TOOLS_PACKAGE_SUGGESTS "forcelayer-runtime, forcelayer-viewer")
set(CPACK_DEBIAN_RUNTIME_PACKAGE_SUGGESTS "forcelayer-tools, forcelayer-viewer")
set(CPACK_DEBIAN_VIEWER_PACKAGE_RECOMMENDS "xauth, xvfb")
set(CPACK_DEBIAN_VIEWER_PACKAGE_SUGGESTS "forcelayer-runtime, forcelayer-tools")
set(CPACK_DEBIAN_PYTHON_PACKAGE_SUGGESTS "forcelayer-runtime, forcelayer-tools, python3-matplotlib")
debian_package(runtime forcelayer-runtime science "six-degree-of-freedom haptic rendering at 1 kHz"
  "voxrun maps a baked scene and a baked part into memory and drives a haptic\ndevice with the contact forces between them. voxcheck proves the clearance\nalong a path. Neither needs the libraries that baking needs.")
if(TARGET voxview)
  debian_package(viewer forcelayer-viewer science "shows haptic scenes, baked files and runs"
    "voxview draws meshes, voxmaps, point shells and recorded or live runs of\nvoxrun.")
endif()
if(TARGET forcelayer_python)
  debian_package(python python3-forcelayer python "proven clearance and haptic simulation from Python"
    "import forcelayer opens baked scenes and parts, tells the proven clearance at\nmany poses at once, and steps and replays the haptic simulation.")
  get_target_property(CPACK_DEBIAN_PYTHON_PACKAGE_DEPENDS forcelayer_python FORCELAYER_DEBIAN_DEPENDS)
endif()
debian_package(library libforcelayer0 libs "haptic rendering by voxel sampling for programs in C"
  "libforcelayer.so.0 opens a baked scene and a baked part, and answers the\npose of a handle with the wrench that the hand shall feel, from within a\nservo loop.")
file(WRITE ${CMAKE_BINARY_DIR}/debian/libforcelayer0/triggers "activate-noawait ldconfig\n")
set(CPACK_DEBIAN_LIBRARY_PACKAGE_CONTROL_EXTRA ${CMAKE_BINARY_DIR}/debian/libforcelayer0/triggers)
set(CPACK_DEBIAN_PACKAGE_GENERATE_SHLIBS ON)
debian_package(development libforcelayer-dev libdevel "library for haptic rendering by voxel sampling"
  "Headers, libraries and files for CMake and pkg-config to embed the runtime\nin a servo loop of your own, and to read and write its files.")
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_DEPENDS
    "libforcelayer0 (= ${PROJECT_VERSION}-${CPACK_DEBIAN_PACKAGE_RELEASE}), libglm-dev, libhwy-dev, libhidapi-dev, nettle-dev")

include(CPack)

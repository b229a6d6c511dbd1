# Debian packages, which `cpack` makes in a build folder: slamdb, the command; libslamdb-dev, the library; libslamdb-live-dev,
# the live map, so that nobody else gets OpenCV; python3-slamdb, the module for Python. Of shared libraries one package of all.
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME slamdb)
set(CPACK_DEBIAN_PACKAGE_RELEASE 1)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_STRIP_FILES ON)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
# Who makes a package stands for it, as Debian's own tools have it.
set(CPACK_PACKAGE_CONTACT "the slamdb authors")
if(DEFINED ENV{DEBFULLNAME} AND DEFINED ENV{DEBEMAIL})
  set(CPACK_PACKAGE_CONTACT "$ENV{DEBFULLNAME} <$ENV{DEBEMAIL}>")
endif()
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS
  OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)

set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
if(NOT BUILD_SHARED_LIBS)
  set(CPACK_DEB_COMPONENT_INSTALL ON)
  set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "")  # each has its own
  set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS OFF)
  set(CPACK_COMPONENTS_ALL library)

  set(release "${PROJECT_VERSION}-${CPACK_DEBIAN_PACKAGE_RELEASE}")
  if(SLAMDB_BUILD_CLI)
    list(APPEND CPACK_COMPONENTS_ALL command)
    set(CPACK_DEBIAN_COMMAND_PACKAGE_NAME slamdb)
    set(CPACK_DEBIAN_COMMAND_PACKAGE_SHLIBDEPS ON)
    set(CPACK_COMPONENT_COMMAND_DESCRIPTION "map database for visual SLAM
The command slamdb opens, checks, repairs, merges, keeps and converts the maps
that SLAM systems save, among them ORB-SLAM3's atlas files, byte for byte.")
  endif()

  if(TARGET slamdb_python)
    list(APPEND CPACK_COMPONENTS_ALL python)
    set(CPACK_DEBIAN_PYTHON_PACKAGE_NAME python3-slamdb)
    set(CPACK_DEBIAN_PYTHON_PACKAGE_SECTION python)
    set(CPACK_DEBIAN_PYTHON_PACKAGE_SHLIBDEPS ON)
    # The module is of one version of Python.
    math(EXPR after "${SLAMDB_PYTHON_MINOR} + 1")
    set(CPACK_DEBIAN_PYTHON_PACKAGE_DEPENDS
      "python3 (>= 3.${SLAMDB_PYTHON_MINOR}), python3 (<< 3.${after}), python3-numpy")
    set(CPACK_DEBIAN_PYTHON_PACKAGE_CONTROL_EXTRA
      "${CMAKE_CURRENT_LIST_DIR}/python3-slamdb/postinst;${CMAKE_CURRENT_LIST_DIR}/python3-slamdb/prerm")
    set(CPACK_DEBIAN_PYTHON_PACKAGE_CONTROL_STRICT_PERMISSION ON)
    set(CPACK_DEBIAN_PYTHON_PACKAGE_SUGGESTS "python3-pandas, python3-scipy")
    set(CPACK_COMPONENT_PYTHON_DESCRIPTION "map database for visual SLAM (Python)
The module slamdb reads, checks, changes and writes the maps of SLAM systems,
whose points and keyframes are numpy arrays in it.")
  endif()

  set(CPACK_DEBIAN_LIBRARY_PACKAGE_NAME libslamdb-dev)
  set(CPACK_DEBIAN_LIBRARY_PACKAGE_SECTION libdevel)
  set(CPACK_DEBIAN_LIBRARY_PACKAGE_DEPENDS "libeigen3-dev (>= 3.4), libsqlite3-dev (>= 3.37), zlib1g-dev, libmd-dev")
  if(SLAMDB_CAIRO)
    string(APPEND CPACK_DEBIAN_LIBRARY_PACKAGE_DEPENDS ", libcairo2-dev")
    set(CPACK_DEBIAN_COMMAND_PACKAGE_RECOMMENDS "fonts-dejavu-core")  # the typeface of plots
  endif()
  if(SLAMDB_CERES)
    string(APPEND CPACK_DEBIAN_LIBRARY_PACKAGE_DEPENDS ", libceres-dev (>= 2.1)")
  endif()
  if(SLAMDB_POSTGRESQL)
    string(APPEND CPACK_DEBIAN_LIBRARY_PACKAGE_DEPENDS ", libpq-dev")
  endif()
  if(SLAMDB_PICTURES)
    string(APPEND CPACK_DEBIAN_LIBRARY_PACKAGE_DEPENDS ", libopencv-features2d-dev, libopencv-imgproc-dev, libpng-dev, libturbojpeg0-dev")
  endif()
  set(CPACK_DEBIAN_LIBRARY_PACKAGE_SUGGESTS "libboost-serialization-dev, libslamdb-live-dev, slamdb")
  set(CPACK_COMPONENT_LIBRARY_DESCRIPTION "map database for visual SLAM (library)
A C++20 library that reads, checks, changes and writes the maps of SLAM
systems: headers, the library to link, and what CMake and pkg-config find.")

  if(SLAMDB_BUILD_LIVE)
    list(APPEND CPACK_COMPONENTS_ALL live)
    set(CPACK_DEBIAN_LIVE_PACKAGE_NAME libslamdb-live-dev)
    set(CPACK_DEBIAN_LIVE_PACKAGE_SECTION libdevel)
    set(CPACK_DEBIAN_LIVE_PACKAGE_DEPENDS "libslamdb-dev (= ${release}), libopencv-core-dev")
    set(CPACK_COMPONENT_LIVE_DESCRIPTION "map database for visual SLAM (live map)
The map while it is built: ORB-SLAM3's classes over the library of
libslamdb-dev, thread-safe and saved while SLAM goes on.")
  endif()
endif()

# What Debian's policy wants besides: see there.
set(CPACK_PRE_BUILD_SCRIPTS ${CMAKE_CURRENT_LIST_DIR}/DebianFiles.cmake)
set(CPACK_SLAMDB_SOURCE ${PROJECT_SOURCE_DIR})
include(CPack)

# What `cmake --install` and the Debian packages hold: the command, its man pages and completions (cli/), the library with
# its headers, and the package that find_package(slamdb) finds.
include(CMakePackageConfigHelpers)

# Three components: the command (see cli/), the library, and the live map, which alone needs OpenCV.
set(package_folder ${CMAKE_INSTALL_LIBDIR}/cmake/slamdb)
install(TARGETS slamdb slamdb_boost EXPORT slamdbTargets
  ARCHIVE COMPONENT library LIBRARY COMPONENT library FILE_SET HEADERS COMPONENT library)
install(EXPORT slamdbTargets NAMESPACE slamdb:: DESTINATION ${package_folder} COMPONENT library)
set(SLAMDB_NEEDS_CERES OFF)
if(SLAMDB_CERES AND NOT BUILD_SHARED_LIBS)
  set(SLAMDB_NEEDS_CERES ON)
endif()
set(SLAMDB_NEEDS_POSTGRESQL OFF)
if(SLAMDB_POSTGRESQL AND NOT BUILD_SHARED_LIBS)
  set(SLAMDB_NEEDS_POSTGRESQL ON)
endif()
configure_package_config_file(cmake/slamdbConfig.cmake.in slamdbConfig.cmake INSTALL_DESTINATION ${package_folder})
if(SLAMDB_BUILD_LIVE)
  install(TARGETS slamdb_live_library EXPORT slamdbLiveTargets
    ARCHIVE COMPONENT live LIBRARY COMPONENT live FILE_SET HEADERS COMPONENT live)
  install(EXPORT slamdbLiveTargets NAMESPACE slamdb:: DESTINATION ${package_folder} COMPONENT live)
  install(FILES cmake/FindOpenCVCore.cmake DESTINATION ${package_folder} COMPONENT live)
endif()
write_basic_package_version_file(slamdbConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/slamdbConfig.cmake ${PROJECT_BINARY_DIR}/slamdbConfigVersion.cmake
  DESTINATION ${package_folder} COMPONENT library)

# For builds without CMake: pkg-config --cflags --libs slamdb
if(NOT BUILD_SHARED_LIBS)
  set(pc_static_libs " -lsqlite3 -lz -lmd -pthread")
  if(SLAMDB_CAIRO)
    string(APPEND pc_static_libs " -lcairo")
  endif()
  if(SLAMDB_CERES)
    string(APPEND pc_static_libs " -lceres -lglog")
  endif()
  if(SLAMDB_POSTGRESQL)
    string(APPEND pc_static_libs " -lpq")
  endif()
  foreach(module IN LISTS SLAMDB_PICTURES)
    string(APPEND pc_static_libs " -l${module}")
  endforeach()
endif()
# Relative to the file itself, so that the whole may be moved.
file(RELATIVE_PATH pc_to_prefix /prefix/${CMAKE_INSTALL_LIBDIR}/pkgconfig /prefix)
configure_file(cmake/slamdb.pc.in slamdb.pc @ONLY)
install(FILES ${PROJECT_BINARY_DIR}/slamdb.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig COMPONENT library)
if(SLAMDB_BUILD_LIVE)
  configure_file(cmake/slamdb-live.pc.in slamdb-live.pc @ONLY)
  install(FILES ${PROJECT_BINARY_DIR}/slamdb-live.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig COMPONENT live)
endif()

include(cmake/Package.cmake)

# What the owner of a store on a server runs once: docs/postgresql.md.
if(SLAMDB_POSTGRESQL)
  install(FILES schema/postgresql/roles.sql schema/postgresql/row_level_security.sql
    DESTINATION ${CMAKE_INSTALL_DATADIR}/slamdb/postgresql COMPONENT command)
endif()

# Finds the core module of OpenCV 4 alone, which distributions package without OpenCV's own CMake files:
# OpenCVCore::core. Installed beside slamdbConfig.cmake.
find_path(OpenCVCore_INCLUDE_DIR opencv2/core.hpp PATH_SUFFIXES opencv4)
find_library(OpenCVCore_LIBRARY opencv_core)
include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(OpenCVCore REQUIRED_VARS OpenCVCore_LIBRARY OpenCVCore_INCLUDE_DIR)
mark_as_advanced(OpenCVCore_INCLUDE_DIR OpenCVCore_LIBRARY)
if(OpenCVCore_FOUND AND NOT TARGET OpenCVCore::core)
  add_library(OpenCVCore::core UNKNOWN IMPORTED)
  set_target_properties(OpenCVCore::core PROPERTIES
    IMPORTED_LOCATION ${OpenCVCore_LIBRARY} INTERFACE_INCLUDE_DIRECTORIES ${OpenCVCore_INCLUDE_DIR})
endif()

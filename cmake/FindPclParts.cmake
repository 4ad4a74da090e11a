# SPDX-License-Identifier: MIT
# PCL's libraries one by one, as targets PclParts::<name>. PCL's own package file insists on finding
# VTK, Qt and MPI and links 29 of their libraries; batten needs four of PCL's and none of those.
#   find_package(PclParts COMPONENTS common io ...)
#   PclParts_ROOT: where else to look for the headers, such as an unpacked libpcl-dev whose libraries are installed.
file(GLOB _pcl_roots /usr/include/pcl-* /usr/local/include/pcl-* ${PclParts_ROOT}/include/pcl-*)
find_path(PclParts_INCLUDE_DIR pcl/point_types.h HINTS ${_pcl_roots})
find_library(PclParts_LZ4_LIBRARY NAMES lz4 liblz4.so.1)  # FLANN's headers, which PCL's searches take, call it
set(_required PclParts_INCLUDE_DIR PclParts_LZ4_LIBRARY)
# Without libpcl-dev libraries have their versions in their names, which is that of the headers' folder.
string(REGEX MATCH "[0-9.]+$" _pcl_version "${PclParts_INCLUDE_DIR}")
foreach(_part IN LISTS PclParts_FIND_COMPONENTS)
  find_library(PclParts_${_part}_LIBRARY NAMES pcl_${_part} libpcl_${_part}.so.${_pcl_version})
  list(APPEND _required PclParts_${_part}_LIBRARY)
  if(PclParts_${_part}_LIBRARY AND NOT TARGET PclParts::${_part})
    add_library(PclParts::${_part} UNKNOWN IMPORTED)
    set_target_properties(PclParts::${_part} PROPERTIES
      IMPORTED_LOCATION ${PclParts_${_part}_LIBRARY}
      INTERFACE_INCLUDE_DIRECTORIES ${PclParts_INCLUDE_DIR}
      INTERFACE_LINK_LIBRARIES "Eigen3::Eigen;${PclParts_LZ4_LIBRARY}")
  endif()
endforeach()
include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(PclParts REQUIRED_VARS ${_required})
mark_as_advanced(PclParts_INCLUDE_DIR PclParts_LZ4_LIBRARY)

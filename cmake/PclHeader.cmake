# SPDX-License-Identifier: MIT
# batten::pcl, the header <batten/pcl.h> and what it needs of PCL.
add_library(batten_pcl INTERFACE)
add_library(batten::pcl ALIAS batten_pcl)
target_sources(batten_pcl INTERFACE FILE_SET HEADERS BASE_DIRS ${PROJECT_SOURCE_DIR}/include
               FILES ${PROJECT_SOURCE_DIR}/include/batten/pcl.h)
target_link_libraries(batten_pcl INTERFACE batten::batten PclParts::common)

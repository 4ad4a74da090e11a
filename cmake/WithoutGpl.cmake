# SPDX-License-Identifier: MIT
# BATTEN_WITHOUT_GPL: nothing that batten links is under the GPL. What was is SuiteSparse, which Debian's Ceres calls; a
# Ceres built without it says so in its configuration. tests/house/without_gpl.cmake reads the link map.
get_target_property(ceres_includes Ceres::ceres INTERFACE_INCLUDE_DIRECTORIES)
find_file(ceres_config ceres/internal/config.h PATHS ${ceres_includes} NO_CACHE NO_DEFAULT_PATH REQUIRED)
file(STRINGS ${ceres_config} without_suitesparse REGEX "^#define CERES_NO_SUITESPARSE")
if(NOT without_suitesparse)
  message(FATAL_ERROR "BATTEN_WITHOUT_GPL: the Ceres of ${Ceres_DIR} links SuiteSparse, whose CHOLMOD and SPQR are under the "
                      "GPL. Run scripts/ceres-without-gpl, and configure anew with "
                      "-DCMAKE_PREFIX_PATH=${PROJECT_SOURCE_DIR}/build/ceres-without-gpl")
endif()

# SPDX-License-Identifier: MIT
# What every target of batten shares: warnings, include root, and how a library folder becomes
# batten::<folder>.

add_library(batten_flags INTERFACE)
target_compile_options(batten_flags INTERFACE -Wall -Wextra -Wpedantic -Wshadow -Wnon-virtual-dtor
                       -Woverloaded-virtual -Wcast-qual -Wno-psabi
                       $<$<CXX_COMPILER_ID:GNU>:-Wno-restrict>  # GCC bug 105651: false alarms in std::string
                       $<$<BOOL:${BATTEN_WARNINGS_AS_ERRORS}>:-Werror>)

# batten_library(NAME source...): the library of one folder. In the build tree its headers are
# included as "batten/<folder>/x.h" through a link to the source folder; installed, the same.
function(batten_library NAME)
  add_library(batten_${NAME} ${ARGN})
  add_library(batten::${NAME} ALIAS batten_${NAME})
  set_target_properties(batten_${NAME} PROPERTIES EXPORT_NAME ${NAME})
  target_compile_features(batten_${NAME} PUBLIC cxx_std_20)
  target_include_directories(batten_${NAME} PUBLIC
    $<BUILD_INTERFACE:${PROJECT_BINARY_DIR}/include> $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
  target_link_libraries(batten_${NAME} PRIVATE $<BUILD_INTERFACE:batten_flags>)
  file(MAKE_DIRECTORY ${PROJECT_BINARY_DIR}/include/batten)
  file(CREATE_LINK ${PROJECT_SOURCE_DIR}/${NAME} ${PROJECT_BINARY_DIR}/include/batten/${NAME} SYMBOLIC)
endfunction()

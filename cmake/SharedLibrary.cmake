# SPDX-License-Identifier: MIT
# batten::batten, all of batten in one library: libbatten.so with BATTEN_SHARED, else the static ones together.
if(NOT BATTEN_SHARED)
  add_library(batten_all INTERFACE)
  add_library(batten::batten ALIAS batten_all)
  target_link_libraries(batten_all INTERFACE batten_io batten_fitting batten_geometry)
  return()
endif()

# The objects of the static libraries, linked once more: only public symbols show (batten.map), and third parties link
# privately, so that a program that links it needs Eigen's headers and no other library.
add_library(batten_shared SHARED)
add_library(batten::batten ALIAS batten_shared)
foreach(folder geometry fitting io)
  target_sources(batten_shared PRIVATE $<TARGET_OBJECTS:batten_${folder}_first> $<TARGET_OBJECTS:batten_${folder}>)
endforeach()
set(symbols ${PROJECT_SOURCE_DIR}/cmake/batten.map)
set_target_properties(batten_shared PROPERTIES OUTPUT_NAME batten EXPORT_NAME batten LINKER_LANGUAGE CXX
  VERSION ${PROJECT_VERSION} SOVERSION ${PROJECT_VERSION_MAJOR} LINK_DEPENDS ${symbols}
  LIBRARY_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/lib)
target_compile_features(batten_shared PUBLIC cxx_std_20)
target_include_directories(batten_shared INTERFACE $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/include>
                                                   $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
target_link_options(batten_shared PRIVATE LINKER:--version-script=${symbols} LINKER:--no-undefined LINKER:--as-needed)
target_link_libraries(batten_shared PUBLIC Eigen3::Eigen PRIVATE ${CMAKE_DL_LIBS})
foreach(private Threads::Threads Ceres::ceres PclParts::common fmt::fmt liblzf::liblzf)
  target_link_libraries(batten_shared PRIVATE $<BUILD_INTERFACE:${private}>)
endforeach()

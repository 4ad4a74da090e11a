# SPDX-License-Identifier: MIT
# What every target of batten shares: warnings, include roots, and how the rooms of a folder become batten::<folder>.

add_library(batten_flags INTERFACE)
target_compile_options(batten_flags INTERFACE -Wall -Wextra -Wpedantic -Wnon-virtual-dtor
                       -Woverloaded-virtual -Wcast-qual -Wno-psabi
                       # In one translation unit a local name of one file hides that of another: no mistake there.
                       $<IF:$<BOOL:${BATTEN_UNITY}>,-Wno-subobject-linkage,-Wshadow>
                       $<$<CXX_COMPILER_ID:GNU>:-Wno-restrict>  # GCC bug 105651: false alarms in std::string
                       $<$<BOOL:${BATTEN_WARNINGS_AS_ERRORS}>:-Werror>)
# GCC collects its garbage again and again on the way to a gigabyte: with memory for each core it need not (4 % of a build's time).
cmake_host_system_information(RESULT memory QUERY TOTAL_PHYSICAL_MEMORY)  # MB
cmake_host_system_information(RESULT cores QUERY NUMBER_OF_LOGICAL_CORES)
if(EXISTS /sys/fs/cgroup/memory.max)  # of a container
  file(STRINGS /sys/fs/cgroup/memory.max limit)
  if(limit MATCHES "^[0-9]+$")
    math(EXPR limit "${limit} / 1000000")
    if(limit LESS memory)
      set(memory ${limit})
    endif()
  endif()
endif()
math(EXPR least "4000 * ${cores}")
if(CMAKE_CXX_COMPILER_ID STREQUAL GNU AND memory GREATER least)
  target_compile_options(batten_flags INTERFACE
    $<$<CONFIG:Release>:--param=ggc-min-expand=1000> $<$<CONFIG:Release>:--param=ggc-min-heapsize=4000000>)
endif()
target_include_directories(batten_flags INTERFACE ${PROJECT_SOURCE_DIR} ${PROJECT_SOURCE_DIR}/include)
# An executable maps the libraries it calls and no others.
target_link_options(batten_flags INTERFACE LINKER:--as-needed)

# Where the modules that are loaded when needed are installed.
set(BATTEN_MODULE_DIR ${CMAKE_INSTALL_LIBDIR}/batten)

# Lines of source that one unity file takes at most: a translation unit stays under half a minute, most of them.
set(BATTEN_UNITY_LINES 2600)

# Rooms whose lines take two to five times as long as others': small matrices of fixed sizes, or bindings.
set(BATTEN_DENSE_ROOMS python primitives wings least_squares ordering flattening regions interpolation intersection)

# batten_unite(TARGET NAME source...): compiles the sources of one room in a few translation units, in alphabetical
# order, so that the headers of Eigen are read and its templates instantiated once for all of them. Kernels
# (*_kernel.cc, *_kernels.cc) stay alone: what is inlined into them depends on nothing else.
function(batten_unite TARGET NAME)
  set(group 0)
  set(most ${BATTEN_UNITY_LINES})
  string(REGEX REPLACE "_first$" "" room ${NAME})
  if(room IN_LIST BATTEN_DENSE_ROOMS)
    math(EXPR most "${most} / 3")
  endif()
  set(lines ${most})
  foreach(source IN LISTS ARGN)
    if(source MATCHES "_kernels?\\.cc$")
      set_source_files_properties(${source} PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
      continue()
    endif()
    file(STRINGS ${source} text)
    list(LENGTH text length)
    math(EXPR lines "${lines} + ${length}")
    if(lines GREATER most)
      math(EXPR group "${group} + 1")
      set(lines ${length})
    endif()
    set_source_files_properties(${source} PROPERTIES UNITY_GROUP ${NAME}_${group})
  endforeach()
  target_sources(${TARGET} PRIVATE ${ARGN})
  if(BATTEN_UNITY)
    set_target_properties(${TARGET} PROPERTIES UNITY_BUILD ON UNITY_BUILD_MODE GROUP)
  endif()
endfunction()

# batten_rooms(TARGET room...): adds the sources of the rooms, folders beside the calling CMakeLists.txt; to TARGET_first, where
# there is such a target, those that the first surface takes.
function(batten_rooms TARGET)
  foreach(room IN LISTS ARGN)
    file(GLOB sources CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/${room}/*.cc)
    if(NOT sources)
      message(FATAL_ERROR "${CMAKE_CURRENT_SOURCE_DIR}/${room}: no sources")
    endif()
    set(first "")
    if(TARGET ${TARGET}_first)
      foreach(source IN LISTS sources)
        if(source IN_LIST BATTEN_FIRST_SOURCES)
          list(APPEND first ${source})
        endif()
      endforeach()
      list(REMOVE_ITEM sources ${first})
      batten_unite(${TARGET}_first ${room}_first ${first})
    endif()
    batten_unite(${TARGET} ${room} ${sources})
  endforeach()
endfunction()

# batten_in_two(TARGET private...): the static library TARGET, and TARGET_first, the part of it that the first surface takes,
# which TARGET has in itself as well. Both are compiled against the private libraries.
function(batten_in_two TARGET)
  add_library(${TARGET}_first STATIC)
  add_library(${TARGET} STATIC $<TARGET_OBJECTS:${TARGET}_first>)
  foreach(part ${TARGET}_first ${TARGET})
    target_compile_features(${part} PUBLIC cxx_std_20)
    target_link_libraries(${part} PRIVATE $<BUILD_INTERFACE:batten_flags>)
    foreach(private IN LISTS ARGN)
      target_link_libraries(${part} PRIVATE ${private})
    endforeach()
  endforeach()
endfunction()

# batten_library(NAME ROOMS room... PUBLIC library... PRIVATE library...): the static library of one folder, its rooms in their
# order, lowest first. Its public headers are the files of include/batten/NAME: what is installed, each of which compiles alone.
function(batten_library NAME)
  cmake_parse_arguments(PARSE_ARGV 1 arg "" "" "ROOMS;PUBLIC;PRIVATE")
  batten_in_two(batten_${NAME} ${arg_PRIVATE})
  add_library(batten::${NAME} ALIAS batten_${NAME})
  set_target_properties(batten_${NAME} PROPERTIES EXPORT_NAME ${NAME})
  batten_rooms(batten_${NAME} ${arg_ROOMS})
  foreach(library IN LISTS arg_PUBLIC)
    target_link_libraries(batten_${NAME} PUBLIC ${library})
    if(TARGET ${library}_first)
      set(library ${library}_first)
    endif()
    target_link_libraries(batten_${NAME}_first PUBLIC ${library})
  endforeach()
  file(GLOB headers CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/include/batten/${NAME}/*.h)
  target_sources(batten_${NAME} PUBLIC FILE_SET HEADERS BASE_DIRS ${PROJECT_SOURCE_DIR}/include FILES ${headers})
endfunction()

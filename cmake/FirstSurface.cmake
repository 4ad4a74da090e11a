# SPDX-License-Identifier: MIT
# What the first surface needs. A newcomer waits for the compiler before anything else, so the program's first commands are
# built, run and shown before the rest (target batten_first, scripts/start). Which sources those take is read from what they
# include: a header's definitions are in the source of its name. What is listed by hand: the commands, and sources that define what
# a header of another name declares (the linker tells of one that is missing).

# The commands of batten_first, those that cli/commands/all_commands.cc has in both builds.
set(BATTEN_FIRST_COMMANDS fit_surface convert evaluate tessellate)
set(BATTEN_FIRST_ALSO
  geometry/editing/trim_check.cc geometry/evaluation/grid_kernel.cc geometry/foot_points/local_foot_point.cc
  geometry/forms/power_surface.cc fitting/grid/grid_tolerance.cc fitting/grid/local_grid.cc
  fitting/joint/eliminated_problem_forms.cc fitting/joint/eliminated_problem_sums.cc fitting/primitives/surface_consensus.cc
  fitting/primitives/surface_foot_points.cc fitting/uncertainty/uncertainty_map.cc io/cloud/input_format.cc
  io/exchange/opencascade_module.cc)

# batten_find_first(OUT): the sources, absolute, that batten_first and the module of OpenCASCADE are made of.
function(batten_find_first OUT)
  foreach(folder geometry fitting io cli)
    file(GLOB sources CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/${folder}/*/*.cc)
    foreach(source IN LISTS sources)
      get_filename_component(name ${source} NAME_WE)
      list(APPEND defines_${folder}_${name} ${source})
    endforeach()
  endforeach()
  file(GLOB todo CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/io/opencascade/*.cc)
  foreach(source cli/main.cc ${BATTEN_FIRST_ALSO})
    list(APPEND todo ${PROJECT_SOURCE_DIR}/${source})
  endforeach()
  foreach(command IN LISTS BATTEN_FIRST_COMMANDS)
    list(APPEND todo ${PROJECT_SOURCE_DIR}/cli/commands/${command}_command.cc)
  endforeach()
  set(first "")
  while(todo)
    list(POP_FRONT todo file)
    if(seen_${file} OR NOT EXISTS ${file})  # the compiler tells of a header that is not there
      continue()
    endif()
    set(seen_${file} TRUE)
    if(file MATCHES "\\.cc$")
      list(APPEND first ${file})
    endif()
    file(STRINGS ${file} includes REGEX "^#include \"(batten|geometry|fitting|io|cli)/")
    foreach(include IN LISTS includes)
      string(REGEX REPLACE "^#include \"([^\"]+)\".*" "\\1" header ${include})
      string(REGEX REPLACE "\\.h$" "" stem ${header})
      if(header MATCHES "^batten/([a-z]+)/")  # public: in whichever room of its folder the source is
        list(APPEND todo ${PROJECT_SOURCE_DIR}/include/${header})
        get_filename_component(name ${stem} NAME)
        list(APPEND todo ${defines_${CMAKE_MATCH_1}_${name}})
      elseif(NOT header MATCHES "^batten/")
        list(APPEND todo ${PROJECT_SOURCE_DIR}/${header})
        if(EXISTS ${PROJECT_SOURCE_DIR}/${stem}.cc)
          list(APPEND todo ${PROJECT_SOURCE_DIR}/${stem}.cc)
        endif()
      endif()
    endforeach()
  endwhile()
  set(${OUT} ${first} PARENT_SCOPE)
endfunction()

batten_find_first(BATTEN_FIRST_SOURCES)

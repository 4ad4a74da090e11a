# SPDX-License-Identifier: MIT
# Doxygen makes the reference without a warning (an error by the Doxyfile), and it says what the headers say.
file(REMOVE_RECURSE ${BUILD}/reference)
execute_process(COMMAND ${DOXYGEN} ${BUILD}/Doxyfile RESULT_VARIABLE result OUTPUT_VARIABLE output ERROR_VARIABLE output)
if(NOT result EQUAL 0 OR output)
  message(FATAL_ERROR "doxygen (${result}):\n${output}")
endif()
foreach(claim "index.html|this is the reference of the headers" "step__writer_8h.html|Writes AP214"
        "structbatten_1_1SewingReport.html|between surfaces along a shared edge" "classbatten_1_1SplineBasis.html|B-spline functions")
  string(REGEX MATCH "^(.*)\\|(.*)$" whole "${claim}")
  file(READ ${BUILD}/reference/html/${CMAKE_MATCH_1} page)
  if(NOT page MATCHES "${CMAKE_MATCH_2}")
    message(FATAL_ERROR "${CMAKE_MATCH_1} does not say \"${CMAKE_MATCH_2}\"")
  endif()
endforeach()

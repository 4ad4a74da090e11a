# SPDX-License-Identifier: MIT
# Puts the page of the HTML report, its style, its viewer and Debian's three.js into a library.

# The viewer's files, in the order in which they are joined.
set(BATTEN_VIEWER_FILES
  numbers.js view_data.js svg.js colours.js histogram.js charts.js figures.js checks.js orbit.js
  materials.js lines.js picking.js space_parts.js space_overlay.js space_view.js plan.js
  plan_view.js controls.js picture.js stage.js side_by_side.js report.js)

# batten_report_assets(TARGET FOLDER): adds a source with the assets in FOLDER to TARGET.
function(batten_report_assets TARGET FOLDER)
  find_file(BATTEN_THREE_JS three.min.js PATHS /usr/share/javascript/three NO_DEFAULT_PATH REQUIRED
            DOC "three.js to put into HTML reports (package libjs-three)")
  list(TRANSFORM BATTEN_VIEWER_FILES PREPEND ${FOLDER}/ OUTPUT_VARIABLE viewer)
  set(template ${FOLDER}/report.html)
  set(style ${FOLDER}/report.css)
  set(three ${BATTEN_THREE_JS})
  set(all "")
  foreach(asset template style three viewer)
    string(TOUPPER ${asset} upper)
    set(BATTEN_INCBIN_${upper} "")
    foreach(file IN LISTS ${asset})
      string(APPEND BATTEN_INCBIN_${upper} "\".incbin \\\"${file}\\\"\\n\" ")
    endforeach()
    list(APPEND all ${${asset}})
  endforeach()
  set(source ${CMAKE_CURRENT_BINARY_DIR}/report_assets.cc)
  configure_file(${FOLDER}/../report_assets.cc.in ${source} @ONLY)
  set_source_files_properties(${source} PROPERTIES OBJECT_DEPENDS "${all}")
  target_sources(${TARGET} PRIVATE ${source})
endfunction()

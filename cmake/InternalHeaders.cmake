# SPDX-License-Identifier: MIT
# Headers that serve their own folder only: not installed, and free to name third parties.
set(BATTEN_INTERNAL_HEADERS
  fitting/joint_cells.h
  io/binary_column.h io/byte_source.h io/cloud_columns.h io/cloud_filter.h io/json_document.h
  io/occt_convert.h io/occt_session.h io/parameter_rectangle.h io/pcd_reader.h io/ply_reader.h
  io/row_batch.h io/step_model.h io/step_syntax.h io/step_units.h io/text_reader.h io/text_rows.h
  io/whole_file.h)

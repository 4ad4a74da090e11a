# SPDX-License-Identifier: MIT
# Headers that serve their own folder only: not installed, and free to name third parties.
set(BATTEN_INTERNAL_HEADERS
  fitting/alpha_shape.h fitting/angle_extent.h fitting/band_kernels.h fitting/banded_lu.h
  fitting/base_profile.h fitting/base_score.h fitting/bezier_chain.h fitting/block_choice.h
  fitting/border_corners.h fitting/border_holding.h fitting/border_loop.h fitting/border_polygon.h
  fitting/border_spline.h fitting/bordered_system.h fitting/cell_moments.h fitting/choose_base.h
  fitting/circle_fit.h fitting/closed_bases.h fitting/cloud_outliers.h fitting/coefficient_order.h
  fitting/collocation.h fitting/company.h fitting/cone_axis.h fitting/corner_data.h
  fitting/corner_noise.h fitting/corner_screen.h fitting/corner_turns.h fitting/corner_windows.h
  fitting/curve_accuracy.h fitting/curve_calm.h fitting/curve_cut.h fitting/curve_ends.h
  fitting/curve_feet.h fitting/curve_fitter.h fitting/curve_foot_kernel.h fitting/curve_guide.h
  fitting/curve_nodes.h fitting/curve_outcome.h fitting/curve_pieces.h fitting/curve_primitive.h
  fitting/curve_robustness.h fitting/curve_strangers.h fitting/distributions.h fitting/edge_energy.h
  fitting/edge_products.h fitting/edge_rows.h fitting/edge_values.h fitting/empty_discs.h
  fitting/empty_share.h fitting/fill_cells.h fitting/fine_axis.h fitting/finish_draft.h
  fitting/fit_corners.h fitting/fitted_surface.h fitting/fitting_bases.h fitting/given_parameters.h
  fitting/graph_winding.h fitting/grid_input.h fitting/halving.h fitting/independent_rows.h
  fitting/joint_cells.h fitting/joint_ceres.h fitting/joint_descent.h fitting/joint_feet.h
  fitting/joint_kernels.h fitting/joint_system.h fitting/joint_watch.h fitting/kink_window.h
  fitting/knot_descent.h fitting/knot_gaps.h fitting/knot_projection.h fitting/knot_search.h
  fitting/line_breaks.h fitting/line_fit.h fitting/line_interpolation.h fitting/line_least_squares.h
  fitting/local_bend.h fitting/local_projection.h fitting/local_quadric.h fitting/local_spacing.h
  fitting/moment_kernels.h fitting/nearest_kernel.h fitting/nearest_sample.h
  fitting/net_conditions.h fitting/net_distance.h fitting/net_kernel.h fitting/net_system.h
  fitting/net_values.h fitting/node_paths.h fitting/node_ring.h fitting/node_sphere.h
  fitting/normal_axes.h fitting/oriented_points.h fitting/outline_edges.h fitting/outline_ghosts.h
  fitting/path_branches.h fitting/penalised_system.h fitting/piece_fit.h fitting/place_kernels.h
  fitting/place_screen.h fitting/plan_layers.h fitting/plan_parts.h fitting/planar_edges.h
  fitting/point_grid.h fitting/point_rank.h fitting/pole_kinds.h fitting/pole_rows.h
  fitting/primitive_input.h fitting/rational_spans.h fitting/residual_structure.h
  fitting/revolution_axis.h fitting/revolution_shape.h fitting/round_base.h fitting/round_chart.h
  fitting/round_nodes.h fitting/row_means.h fitting/sample_consensus.h fitting/settled_parameters.h
  fitting/shape_data.h fitting/shape_estimate.h fitting/shape_extent.h fitting/shape_fitter.h
  fitting/shape_scores.h fitting/shapes_through.h fitting/sheet_cells.h fitting/sheet_graph.h
  fitting/sheet_nodes.h fitting/sheet_spread.h fitting/sheet_unfolding.h
  fitting/smallest_rectangle.h fitting/snap.h fitting/sphere_patch.h fitting/surface_base.h
  fitting/surface_choice.h fitting/surface_distance.h fitting/surface_fitter.h
  fitting/surface_minimum.h fitting/surface_outcome.h fitting/surface_patch.h
  fitting/surface_places.h fitting/surface_preparation.h fitting/surface_primitive.h
  fitting/surface_starts.h fitting/tangent_pieces.h fitting/term_cost.h fitting/thin_axis.h
  fitting/tied_system.h fitting/tube_chart.h fitting/tube_ends.h fitting/tube_loops.h
  fitting/tube_settling.h fitting/tube_unfolding.h fitting/unit_of.h fitting/void_bounds.h
  fitting/void_map.h fitting/warm_feet.h geometry/adaptive_sum.h geometry/bernstein_polynomial.h
  geometry/box_minimum.h geometry/box_tree.h geometry/checked_parameter.h
  geometry/composed_blossom.h geometry/conic_fit.h geometry/construction_checks.h
  geometry/control_rows.h geometry/evaluation_lanes.h geometry/evaluation_table.h
  geometry/foot_kernels.h geometry/foot_proof.h geometry/foot_reach.h geometry/foot_reach_kernel.h
  geometry/foot_search.h geometry/foot_table.h geometry/gauss_rule.h geometry/homogeneous.h
  geometry/join_tolerances.h geometry/knot_groups.h geometry/knot_refinement.h
  geometry/knot_removal.h geometry/lattice_mesh.h geometry/limit_series.h
  geometry/local_feet_kernel.h geometry/local_points.h geometry/loop_curves.h geometry/loop_cut.h
  geometry/mesh_domain.h geometry/monotone_arcs.h geometry/number_text.h
  geometry/plane_curve_crossings.h geometry/polar_form.h geometry/rational_patch.h
  geometry/revolved_circle.h geometry/run_time_dispatch.h geometry/sample_tree.h
  geometry/section_fit.h geometry/section_trace.h geometry/spline_pieces.h
  geometry/steady_sections.h geometry/triangle_error.h geometry/triangle_proof.h
  geometry/trim_clip.h geometry/trim_maps.h geometry/trimmed_area.h geometry/trimmed_box.h
  geometry/trimmed_foot_search.h geometry/unit_arc.h geometry/weighted_means.h io/base64.h
  io/binary_column.h io/byte_source.h io/closed_form.h io/cloud_columns.h io/cloud_filter.h
  io/distinct_points.h io/face_loops.h io/file_loops.h io/geometry_names.h io/glb_writer.h
  io/iges_header.h io/iges_shapes.h io/iges_text.h io/iges_types.h io/json_document.h
  io/json_field.h io/json_splines.h io/json_trims.h io/las_reader.h io/little_endian.h
  io/obj_reader.h io/occt_convert.h io/occt_exact.h io/occt_face.h io/occt_session.h
  io/occt_shapes.h io/off_reader.h io/only_lines.h io/parameter_map.h io/parameter_rectangle.h
  io/pcd_reader.h io/plain_decimal.h io/ply_reader.h io/polyline.h io/report_assets.h
  io/report_curve.h io/report_data.h io/report_points.h io/report_surface.h io/row_batch.h
  io/space_curve.h io/step_model.h io/step_names.h io/step_syntax.h io/step_units.h io/stl_reader.h
  io/text_names.h io/text_reader.h io/text_rows.h io/time_stamp.h io/trim_pieces.h io/trimmed_face.h
  io/vertex_rows.h io/whole_file.h)

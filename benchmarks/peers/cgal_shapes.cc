// SPDX-License-Identifier: MIT
// The shapes that CGAL's efficient RANSAC finds in points: the seconds, then the number and the
// kind of the shape of each point, -1 where it has none. EPSILON is the distance of points from
// their shape, CLUSTER that of points of one shape from one another; MIN points make a shape. Links
// CGAL (GPL) and nothing of batten; built on request only.
// Of planes, cylinders and spheres or, where ALL is not 0, cones and tori, too.
// Usage: cgal_shapes POINTS.f64 EPSILON CLUSTER MIN NEIGHBOURS ALL
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Shape_detection/Efficient_RANSAC.h>
#include <CGAL/jet_estimate_normals.h>
#include <CGAL/mst_orient_normals.h>
#include <CGAL/property_map.h>

#include <cstdio>
#include <cstdlib>
#include <tuple>
#include <vector>

#include "comparator.h"

namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
// CGAL changes the order of samples: each knows its number.
using Sample = std::tuple<Kernel::Point_3, Kernel::Vector_3, std::size_t>;
using Samples = std::vector<Sample>;
using PointMap = CGAL::Nth_of_tuple_property_map<0, Sample>;
using NormalMap = CGAL::Nth_of_tuple_property_map<1, Sample>;
using Traits = CGAL::Shape_detection::Efficient_RANSAC_traits<Kernel, Samples, PointMap, NormalMap>;
using Ransac = CGAL::Shape_detection::Efficient_RANSAC<Traits>;

const char* KindOf(const Ransac::Shape* shape) {
  if (dynamic_cast<const CGAL::Shape_detection::Plane<Traits>*>(shape)) return "plane";
  if (dynamic_cast<const CGAL::Shape_detection::Cylinder<Traits>*>(shape)) return "cylinder";
  if (dynamic_cast<const CGAL::Shape_detection::Cone<Traits>*>(shape)) return "cone";
  if (dynamic_cast<const CGAL::Shape_detection::Sphere<Traits>*>(shape)) return "sphere";
  return "torus";
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 7) {
    std::fprintf(stderr, "usage: cgal_shapes POINTS.f64 EPSILON CLUSTER MIN NEIGHBOURS ALL\n");
    return 2;
  }
  std::size_t numbers = 0;
  const double* const points = ReadDoubles(argv[1], &numbers);
  if (!points || numbers % 3 != 0) {
    std::fprintf(stderr, "cgal_shapes: can't use %s\n", argv[1]);
    return 1;
  }
  const Seconds begin = Now();
  Samples samples;
  for (std::size_t k = 0; k < numbers; k += 3)
    samples.emplace_back(
        Kernel::Point_3(points[k], points[k + 1], points[k + 2]), Kernel::Vector_3(), k / 3);
  CGAL::jet_estimate_normals<CGAL::Sequential_tag>(
      samples,
      unsigned(std::atoi(argv[5])),
      CGAL::parameters::point_map(PointMap()).normal_map(NormalMap()));
  CGAL::mst_orient_normals(samples,
                           unsigned(std::atoi(argv[5])),
                           CGAL::parameters::point_map(PointMap()).normal_map(NormalMap()));
  Ransac ransac;
  ransac.set_input(samples);
  ransac.add_shape_factory<CGAL::Shape_detection::Plane<Traits>>();
  ransac.add_shape_factory<CGAL::Shape_detection::Cylinder<Traits>>();
  ransac.add_shape_factory<CGAL::Shape_detection::Sphere<Traits>>();
  if (std::atoi(argv[6]) != 0) {
    ransac.add_shape_factory<CGAL::Shape_detection::Cone<Traits>>();
    ransac.add_shape_factory<CGAL::Shape_detection::Torus<Traits>>();
  }
  Ransac::Parameters parameters;
  parameters.probability = 0.01;
  parameters.epsilon = std::atof(argv[2]);
  parameters.cluster_epsilon = std::atof(argv[3]);
  parameters.min_points = std::size_t(std::atoi(argv[4]));
  parameters.normal_threshold = 0.9;
  ransac.detect(parameters);
  std::vector<int> number(samples.size(), -1);
  std::vector<const char*> kinds;
  for (const auto& shape : ransac.shapes()) {
    for (const std::size_t k : shape->indices_of_assigned_points())
      number[std::get<2>(samples[k])] = static_cast<int>(kinds.size());
    kinds.push_back(KindOf(shape.get()));
  }
  std::printf("%g\n", Since(begin).cpu);
  for (const int k : number) std::printf("%d %s\n", k, k < 0 ? "none" : kinds[std::size_t(k)]);
}

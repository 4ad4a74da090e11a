// SPDX-License-Identifier: MIT
#include "fitting/streaming/first_look.h"

#include <Eigen/Geometry>
#include <vector>

#include "batten/fitting/refused_data.h"
#include "fitting/streaming/point_sample.h"

namespace batten::internal {

FirstLook TakeFirstLook(PointSource& source,
                        Eigen::Index size,
                        std::uint64_t seed,
                        const Progress& progress) {
  FirstLook look;
  PointSample own(size, seed);
  Eigen::AlignedBox3d box;
  source.Pass([&](const Eigen::Matrix3Xd& points) {
    if (points.cols() == 0) return;
    look.count += static_cast<double>(points.cols());
    box.extend(points.rowwise().minCoeff().eval());
    box.extend(points.rowwise().maxCoeff().eval());
    own.Add(points);
    Report(progress, "read", 0);
  });
  source.Sum({&look.count, 1});
  if (look.count == 0) throw RefusedData("the cloud holds no points");
  const Eigen::Matrix3Xd mine = own.Points();
  const std::vector<double> samples =
      source.Gathered(std::vector<double>(mine.data(), mine.data() + mine.size()));
  const std::vector<double> boxes = source.Gathered(
      {box.min()[0], box.min()[1], box.min()[2], box.max()[0], box.max()[1], box.max()[2]});
  for (std::size_t at = 0; at < boxes.size(); at += 6) {
    const double* one = boxes.data() + at;
    if (one[0] > one[3]) continue;  // no points there
    box.extend(Eigen::Vector3d(one[0], one[1], one[2]));
    box.extend(Eigen::Vector3d(one[3], one[4], one[5]));
  }
  look.low = box.min();
  look.high = box.max();
  PointSample all(size, seed);
  all.Add(Eigen::Map<const Eigen::Matrix3Xd>(
      samples.data(), 3, static_cast<Eigen::Index>(samples.size() / 3)));
  look.different = source.shared() ? all.Different() : own.Different();
  look.sample = all.Points();
  return look;
}

}  // namespace batten::internal

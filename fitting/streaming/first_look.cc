// SPDX-License-Identifier: MIT
#include "fitting/streaming/first_look.h"

#include <Eigen/Geometry>
#include <vector>

#include "batten/fitting/refused_data.h"
#include "fitting/streaming/point_sample.h"

namespace batten::internal {

namespace {

// Of all processes.
FirstLook Seen(PointPasses& passes,
               Eigen::Index size,
               std::uint64_t seed,
               const Progress& progress) {
  PointSource& source = passes.source();
  FirstLook look;
  PointSample own(size, seed);
  Eigen::AlignedBox3d box;
  passes.Over([&](const Eigen::Matrix3Xd& points) {
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

}  // namespace

FirstLook TakeFirstLook(PointPasses& passes,
                        Eigen::Index size,
                        std::uint64_t seed,
                        const Progress& progress) {
  // Counts, size of the sample, box; then the sample, with room for all of it.
  constexpr Eigen::Index kBefore = 9;
  Eigen::VectorXd numbers = Eigen::VectorXd::Zero(kBefore + 3 * size);
  passes.Next({{numbers.data(), static_cast<std::size_t>(numbers.size())}}, [&] {
    const FirstLook look = Seen(passes, size, seed, progress);
    numbers.head<kBefore>() << look.count, look.different, static_cast<double>(look.sample.cols()),
        look.low, look.high;
    numbers.segment(kBefore, look.sample.size()) = look.sample.reshaped();
  });
  const auto kept = static_cast<Eigen::Index>(numbers[2]);
  return {numbers[0],
          numbers[1],
          numbers.segment<3>(3),
          numbers.segment<3>(6),
          numbers.segment(kBefore, 3 * kept).reshaped(3, kept)};
}

}  // namespace batten::internal

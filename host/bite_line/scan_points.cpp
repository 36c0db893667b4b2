// SPDX-License-Identifier: MIT
#include "host/bite_line/scan_points.hpp"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

namespace biteline::bite_line {

Large<Eigen::Vector3f> points_behind(const ScanPoints& scan, const Shoe& shoe,
                                     std::span<const std::uint32_t> of_shoe) {
  const auto run_of = [&](std::size_t i) { return scan.run(shoe.index[of_shoe[i]]); };
  Large<std::size_t> first(of_shoe.size() + 1, 0);
  for (std::size_t i = 0; i < of_shoe.size(); ++i) first[i + 1] = first[i] + run_of(i).size();
  Large<Eigen::Vector3f> points;
  points.resize(first.back());
  const Eigen::Isometry3f T_shoe_base = shoe.T_base_shoe.inverse().cast<float>();
  tbb::parallel_for(tbb::blocked_range<std::size_t>{0, of_shoe.size(), 4096}, [&](const auto& range) {
    for (std::size_t i = range.begin(); i != range.end(); ++i) {
      Eigen::Vector3f* to = points.data() + first[i];
      for (const Eigen::Vector3f& p : run_of(i)) *to++ = T_shoe_base * p;
    }
  });
  return points;
}

}  // namespace biteline::bite_line

// SPDX-License-Identifier: MIT
#include <CGAL/Fuzzy_sphere.h>
#include <CGAL/Monge_via_jet_fitting.h>
#include <CGAL/Orthogonal_k_neighbor_search.h>
#include <CGAL/Search_traits_3.h>
#include <CGAL/Simple_cartesian.h>

#include <iterator>

#include "tests/bench/line/peers.hpp"

namespace biteline::bench::peers {

bool has_cgal() {
  return true;
}

Values cgal_curvature(std::span<const Eigen::Vector3f> points, std::size_t neighbours, float radius_mm,
                      std::span<const Eigen::Vector3f> outward) {
  using Kernel = CGAL::Simple_cartesian<double>;
  using Traits = CGAL::Search_traits_3<Kernel>;
  using Search = CGAL::Orthogonal_k_neighbor_search<Traits>;
  using Fit = CGAL::Monge_via_jet_fitting<Kernel>;
  std::vector<Kernel::Point_3> cloud;
  cloud.reserve(points.size());
  for (const Eigen::Vector3f& p : points) cloud.emplace_back(p.x(), p.y(), p.z());
  Search::Tree tree(cloud.begin(), cloud.end());
  tree.build();
  Values values;
  std::vector<Kernel::Point_3> around;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    around.assign(1, cloud[i]);
    if (radius_mm > 0) {
      std::vector<Kernel::Point_3> found;
      tree.search(std::back_inserter(found),
                  CGAL::Fuzzy_sphere<Traits>{cloud[i], static_cast<double>(radius_mm)});
      for (const auto& p : found) {
        if (p != cloud[i]) around.push_back(p);
      }
    } else {
      const Search search(tree, cloud[i], static_cast<unsigned>(neighbours));
      for (const auto& [p, distance] : search) {
        if (p != cloud[i]) around.push_back(p);
      }
    }
    if (around.size() < 6) {
      values.mean_per_mm.push_back(0);
      values.gaussian_per_mm2.push_back(0);
      continue;
    }
    Fit fit;
    auto monge = fit(around.begin(), around.end(), 2, 2);
    if (!outward.empty()) monge.comply_wrt_given_normal({outward[i].x(), outward[i].y(), outward[i].z()});
    // Monge's height grows along the normal: convex seen from outside is negative there.
    const double k1 = -monge.principal_curvatures(0);
    const double k2 = -monge.principal_curvatures(1);
    values.mean_per_mm.push_back(static_cast<float>(0.5 * (k1 + k2)));
    values.gaussian_per_mm2.push_back(static_cast<float>(k1 * k2));
  }
  return values;
}

}  // namespace biteline::bench::peers

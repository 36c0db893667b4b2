// SPDX-License-Identifier: MIT
#include "host/bite_line/published/orient.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <queue>
#include <vector>

#include "host/bite_line/published/neighbour_search.hpp"

namespace biteline::published {

namespace {

struct Link {
  float bend;  ///< 1 - |n . n'|: the flatter, the surer
  std::uint32_t from;
  std::uint32_t to;
  bool operator<(const Link& other) const { return bend > other.bend; }
};

}  // namespace

void orient_consistently(const NeighbourGrid& grid, std::span<Eigen::Vector3f> normals) {
  constexpr std::size_t k_links = 8;
  const std::size_t count = grid.size();
  const auto at = [&](std::uint32_t i) { return Eigen::Vector3f{grid.x()[i], grid.y()[i], grid.z()[i]}; };
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  for (std::uint32_t i = 0; i < count; ++i) middle += at(i).cast<double>() / static_cast<double>(count);
  const Eigen::Vector3f centre = middle.cast<float>();

  std::vector<std::uint32_t> seeds(count);
  std::iota(seeds.begin(), seeds.end(), 0U);
  std::vector<float> distance2(count);
  for (std::uint32_t i = 0; i < count; ++i) distance2[i] = (at(i) - centre).squaredNorm();
  std::sort(seeds.begin(), seeds.end(),
            [&](std::uint32_t a, std::uint32_t b) { return distance2[a] > distance2[b]; });

  std::vector<bool> done(count, false);
  std::priority_queue<Link> links;
  NeighbourSearch search{grid};
  const auto spread_from = [&](std::uint32_t i) {
    for (const std::uint32_t to : search.nearest(i, k_links).index) {
      if (!done[to]) links.push({1.0F - std::abs(normals[i].dot(normals[to])), i, to});
    }
  };
  for (const std::uint32_t seed : seeds) {
    if (done[seed]) continue;
    // Nearest neighbours are not mutual: a part that nobody counted among theirs may still have oriented ones
    // of its own.
    float flattest = 0;
    for (const std::uint32_t other : search.nearest(seed, k_links).index) {
      const float agreement = done[other] ? normals[seed].dot(normals[other]) : 0.0F;
      if (std::abs(agreement) > std::abs(flattest)) flattest = agreement;
    }
    if (flattest < 0 || (flattest == 0 && normals[seed].dot(at(seed) - centre) < 0))
      normals[seed] = -normals[seed];
    done[seed] = true;
    spread_from(seed);
    while (!links.empty()) {
      const Link link = links.top();
      links.pop();
      if (done[link.to]) continue;
      if (normals[link.from].dot(normals[link.to]) < 0) normals[link.to] = -normals[link.to];
      done[link.to] = true;
      spread_from(link.to);
    }
  }
}

}  // namespace biteline::published

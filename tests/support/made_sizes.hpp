// SPDX-License-Identifier: MIT
#pragma once
/// \file One made model in many sizes and both feet, graded by a law of its factory.

#include <cstdint>
#include <optional>
#include <random>

#include "host/transfer/sample_folder.hpp"
#include "tests/support/made_pair.hpp"

namespace biteline::test {

/// Of a size whose length is changed by `c` (0.05: 5 % longer): each factor is 1 + share * c * (1 + bend *
/// c).
struct FactoryLaw {
  struct Rule {
    double share, bend{0};
    [[nodiscard]] double at(double c) const { return 1 + share * c * (1 + bend * c); }
  };
  Rule width{0.8}, height{0.5};
};

/// Each share within 30 % of the usual one; one of the two bends by 30 % of what it takes over a tenth.
inline FactoryLaw drawn_law(std::uint64_t seed) {
  std::mt19937_64 random{seed};
  std::uniform_real_distribution<double> part{-0.3, 0.3};
  FactoryLaw law;
  law.width.share *= 1 + part(random);
  law.height.share *= 1 + part(random);
  (seed % 2 == 0 ? law.width : law.height).bend = 3 * (part(random) > 0 ? 1 : -1);
  return law;
}

class MadeModel {
 public:
  MadeModel(sim::ShoeClass shoe_class, std::uint64_t seed, FactoryLaw law, sim::ScanSettings scan)
      : shoe_{sim::draw_shoe(shoe_class, seed)}, seed_{seed}, law_{law}, scan_{scan} {
    truth_ = sim::true_line(sim::MadeShoe{shoe_}, 1.0);
  }

  [[nodiscard]] double length_mm() const { return shoe_.outline.length_mm; }
  [[nodiscard]] double length_mm(double change) const { return length_mm() * (1 + change); }

  [[nodiscard]] transfer::SampleFiles sample(double change) const {
    sim::ScanSettings scan = scan_;
    scan.seed = seed_ + 1;
    transfer::SampleFiles files{.cloud = scanned(shoe_, SE3::Identity(), scan),
                                .line = as_line(truth_, SE3::Identity())};
    move(files.cloud, files.line, change, false, SE3::Identity());
    return files;
  }

  /// The next upper, of a last of its own, with its true line.
  [[nodiscard]] transfer::SampleFiles upper(double change, bool other_foot, std::uint64_t last,
                                            const SE3& T_base_upper) const {
    constexpr double k_last_difference_mm = 0.15;
    const sim::ShoeParameters upper = sim::bare_upper_of(shoe_, k_last_difference_mm, last);
    sim::ScanSettings scan = scan_;
    scan.seed = last;
    transfer::SampleFiles files{
        .cloud = scanned(upper, SE3::Identity(), scan),
        .line = as_line(sim::carried_line(truth_, sim::MadeShoe{upper}), SE3::Identity())};
    move(files.cloud, files.line, change, other_foot, T_base_upper);
    return files;
  }

 private:
  void move(cloud::PointCloud& cloud, cloud::ClosedLine& line, double change, bool other_foot,
            const SE3& T_base_shoe) const {
    const Vec3 factors{1 + change, (other_foot ? -1 : 1) * law_.width.at(change), law_.height.at(change)};
    for (Eigen::Vector3f& p : cloud.points)
      p = (T_base_shoe * p.cast<double>().cwiseProduct(factors)).cast<float>();
    for (cloud::LinePoint& p : line.points) {
      p.position = T_base_shoe * p.position.cwiseProduct(factors);
      p.normal = T_base_shoe.linear() * p.normal.cwiseQuotient(factors).normalized();
      p.tangent = T_base_shoe.linear() * p.tangent.cwiseProduct(factors).normalized();
    }
    if (!other_foot) return;
    // Anticlockwise again.
    std::reverse(line.points.begin(), line.points.end());
    for (cloud::LinePoint& p : line.points) p.tangent = -p.tangent;
  }

  sim::ShoeParameters shoe_;
  std::uint64_t seed_;
  FactoryLaw law_;
  sim::ScanSettings scan_;
  std::vector<sim::TrueLinePoint> truth_;
};

}  // namespace biteline::test

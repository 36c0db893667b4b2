// SPDX-License-Identifier: MIT
// Neighbours, normals and level-set curvature beside PCL (normals, principal curvatures) and CGAL (jets):
// speed on one cloud with one thread, and error of the principal curvatures, H and K on surfaces whose
// curvature is known.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <functional>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include <tbb/global_control.h>

#include "host/bite_line/published/level_set.hpp"
#include "tests/bench/line/peers.hpp"

namespace biteline::bench {
namespace {

using Points = std::vector<Eigen::Vector3f>;

struct Shape {
  std::string name;
  Points points;
  Points outward;
  std::vector<float> mean_per_mm;  ///< the truth per point
  std::vector<float> gaussian_per_mm2;
  std::vector<bool> judged;  ///< away from borders
};

constexpr float k_noise_mm = 0.03F;
constexpr float k_radius_mm = 1.5F;
constexpr std::size_t k_neighbours = 20;

class Maker {
 public:
  float uniform(float low, float high) { return std::uniform_real_distribution<float>{low, high}(random_); }
  float normal() { return normal_(random_); }
  void add(Shape& shape, const Eigen::Vector3f& p, const Eigen::Vector3f& n, float mean, float gaussian,
           bool judged) {
    const Eigen::Vector3f noise{normal(), normal(), normal()};
    shape.points.emplace_back(p + k_noise_mm * noise);
    shape.outward.push_back(n);
    shape.mean_per_mm.push_back(mean);
    shape.gaussian_per_mm2.push_back(gaussian);
    shape.judged.push_back(judged);
  }

 private:
  std::mt19937 random_{1};
  std::normal_distribution<float> normal_;
};

/// About `density` points per mm^2 everywhere: by radius of 1.5 mm some 35 neighbours at 5 per mm^2.
std::vector<Shape> shapes(float density) {
  Maker make;
  std::vector<Shape> all;
  const auto count = [&](double area_mm2) {
    return static_cast<int>(area_mm2 * static_cast<double>(density));
  };
  constexpr float k_pi = std::numbers::pi_v<float>;

  Shape ball{"sphere R 5 mm", {}, {}, {}, {}, {}};
  for (int i = count(4 * 3.14159 * 25 * 10); i-- > 0;) {
    const Eigen::Vector3f n = Eigen::Vector3f{make.normal(), make.normal(), make.normal()}.normalized();
    const Eigen::Vector3f centre{30.0F * static_cast<float>(i % 10), 0, 0};
    make.add(ball, centre + 5 * n, n, 0.2F, 0.04F, true);
  }
  all.push_back(std::move(ball));

  Shape tube{"cylinder R 4 mm", {}, {}, {}, {}, {}};
  for (int i = count(2 * 3.14159 * 4 * 120); i-- > 0;) {
    const float a = make.uniform(0, 2 * k_pi);
    const float z = make.uniform(0, 120);
    const Eigen::Vector3f n{std::cos(a), std::sin(a), 0};
    make.add(tube, 4 * n + Eigen::Vector3f{0, 0, z}, n, 0.125F, 0.0F, z > 2 && z < 118);
  }
  all.push_back(std::move(tube));

  Shape torus{"torus 12 / 4 mm", {}, {}, {}, {}, {}};
  for (int i = count(4 * 3.14159 * 3.14159 * 12 * 4); i-- > 0;) {
    float a = 0;
    float b = 0;
    do {
      a = make.uniform(0, 2 * k_pi);
      b = make.uniform(0, 2 * k_pi);
    } while (make.uniform(0, 16) > 12 + 4 * std::cos(b));
    const Eigen::Vector3f n{std::cos(a) * std::cos(b), std::sin(a) * std::cos(b), std::sin(b)};
    const float other = std::cos(b) / (12 + 4 * std::cos(b));
    make.add(torus, Eigen::Vector3f{12 * std::cos(a), 12 * std::sin(a), 0} + 4 * n, n, 0.5F * (0.25F + other),
             0.25F * other, true);
  }
  all.push_back(std::move(torus));

  Shape valley{"valley r 1.5 mm", {}, {}, {}, {}, {}};
  constexpr float k_valley_mm = 1.5F;
  constexpr float k_half_turn = k_pi / 3;  // flanks at 60 degrees
  for (int i = count(2 * 7.0 * 200); i-- > 0;) {
    const float s = make.uniform(-7, 7);
    const float y = make.uniform(0, 200);
    const float arc = k_valley_mm * k_half_turn;
    const float a = std::clamp(s / k_valley_mm, -k_half_turn, k_half_turn);
    const float beyond = s > arc ? s - arc : s < -arc ? s + arc : 0.0F;
    const Eigen::Vector3f n{-std::sin(a), 0, std::cos(a)};
    const Eigen::Vector3f p{k_valley_mm * std::sin(a) + beyond * std::cos(a), y,
                            k_valley_mm * (1 - std::cos(a)) + beyond * std::sin(a)};
    make.add(valley, p, n, -1 / (2 * k_valley_mm), 0.0F, std::abs(s) < 0.3F && y > 2 && y < 198);
  }
  all.push_back(std::move(valley));
  return all;
}

double rms(const Shape& shape, const std::vector<float>& value, const std::vector<float>& truth) {
  double sum = 0;
  double count = 0;
  for (std::size_t i = 0; i < value.size(); ++i) {
    if (!shape.judged[i]) continue;
    sum += std::pow(static_cast<double>(value[i] - truth[i]), 2);
    count += 1;
  }
  return std::sqrt(sum / std::max(count, 1.0));
}

double typical_bend(const Shape& shape, const std::vector<float>& mean, const std::vector<float>& gaussian) {
  std::vector<float> bends;
  for (std::size_t i = 0; i < mean.size(); ++i) {
    if (shape.judged[i]) bends.push_back(published::principal(mean[i], gaussian[i]).smaller_per_mm);
  }
  std::nth_element(bends.begin(), bends.begin() + static_cast<std::ptrdiff_t>(bends.size() / 2), bends.end());
  return static_cast<double>(bends[bends.size() / 2]);
}

/// Processor time of this process: with one thread, what a quiet machine's clock would show.
template <class Work>
double best_of(int rounds, Work&& work) {
  double best = 1e9;
  for (int i = 0; i < rounds; ++i) {
    const std::clock_t begin = std::clock();
    work();
    best = std::min(best, static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC);
  }
  return best;
}

void row(const std::string& bench, const std::string& what, double ours, const char* unit, const char* peer,
         double peer_value, double target) {
  std::printf("{\"bench\":\"%s\",\"what\":\"%s\",\"ours\":%.5g,\"unit\":\"%s\"", bench.c_str(), what.c_str(),
              ours, unit);
  if (peer != nullptr)
    std::printf(",\"peer\":\"%s\",\"peer_value\":%.5g,\"ratio\":%.4g", peer, peer_value, ours / peer_value);
  if (target > 0) std::printf(",\"target\":%.4g", target);
  std::printf("}\n");
  std::fflush(stdout);
}

/// A shoe's side as a scan gives it: 650 mm round, 60 mm high, a groove; profile by profile.
Points side(std::size_t count) {
  Maker make;
  Points points;
  const auto columns = static_cast<std::size_t>(std::sqrt(static_cast<double>(count) * 60.0 / 650.0 * 4.0));
  const std::size_t profiles = count / columns;
  for (std::size_t p = 0; p < profiles; ++p) {
    const float a = 2 * std::numbers::pi_v<float> * static_cast<float>(p) / static_cast<float>(profiles);
    for (std::size_t c = 0; c < columns; ++c) {
      const float z = 60.0F * static_cast<float>(c) / static_cast<float>(columns);
      const float u = (z - 26.0F) / 0.8F;
      const float o =
          -2.5F * std::exp(-0.5F * u * u) - 0.004F * (z - 26.0F) * (z - 26.0F) + 0.015F * make.normal();
      points.emplace_back((140 + o) * std::cos(a), (60 + o) * std::sin(a), z);
    }
  }
  return points;
}

void speed() {
  const Points points = side(200'000);
  Points outward(points.size());
  for (std::size_t i = 0; i < points.size(); ++i)
    outward[i] = Eigen::Vector3f{points[i].x() / (140 * 140), points[i].y() / (60 * 60), 0};
  std::vector<std::uint32_t> order(points.size());
  for (std::uint32_t i = 0; i < order.size(); ++i) order[i] = i;
  std::shuffle(order.begin(), order.end(), std::mt19937{3});
  Points shuffled;
  Points shuffled_outward;
  for (const std::uint32_t i : order) {
    shuffled.push_back(points[i]);
    shuffled_outward.push_back(outward[i]);
  }
  const tbb::global_control one{tbb::global_control::max_allowed_parallelism, 1};
  for (const bool scan_order : {true, false}) {
    const Points& cloud = scan_order ? points : shuffled;
    const Points& hints = scan_order ? outward : shuffled_outward;
    const std::string what =
        std::string{"200 000 points, k = 20, one thread, "} + (scan_order ? "scan order" : "shuffled");
    const double ours =
        best_of(3, [&] { (void)published::estimate_curvature(cloud, hints, {.neighbours = k_neighbours}); });
    if (peers::has_pcl()) {
      row("curvature.speed", what, ours, "s", "PCL",
          best_of(2, [&] { (void)peers::pcl_curvature(cloud, k_neighbours, 0); }), 0.2);
    } else {
      row("curvature.speed", what + " (PCL not in this build)", ours, "s", nullptr, 0, 0);
    }
    if (peers::has_cgal()) {
      row("curvature.speed", what, ours, "s", "CGAL jets",
          best_of(1, [&] { (void)peers::cgal_curvature(cloud, k_neighbours); }), 1.0 / 15);
    } else {
      row("curvature.speed", what + " (CGAL not in this build)", ours, "s", nullptr, 0, 0);
    }
  }
}

void accuracy() {
  for (const Shape& shape : shapes(5.0F)) {
    struct Way {
      const char* name;
      published::CurvatureConfig config;
    };
    // By count: as many as the radius holds here, so that both see the same neighbourhoods.
    const std::size_t held = 35;
    for (const Way& way :
         {Way{"r = 1.5 mm", {.radius_mm = k_radius_mm}}, Way{"k = 35", {.neighbours = held}}}) {
      const published::Curvature ours =
          published::estimate_curvature(shape.points, shape.outward, way.config);
      const std::string what = shape.name + ", noise 0.03 mm, " + way.name;
      const double h = rms(shape, ours.mean_per_mm, shape.mean_per_mm);
      const double k = rms(shape, ours.gaussian_per_mm2, shape.gaussian_per_mm2);
      if (peers::has_cgal()) {
        const peers::Values jets = peers::cgal_curvature(
            shape.points, held, way.config.neighbours > 0 ? 0.0F : k_radius_mm, shape.outward);
        row("curvature.error H", what, h, "1/mm rms", "CGAL jets",
            rms(shape, jets.mean_per_mm, shape.mean_per_mm), 1.0);
        row("curvature.error K", what, k, "1/mm2 rms", "CGAL jets",
            rms(shape, jets.gaussian_per_mm2, shape.gaussian_per_mm2), 1.0);
        if (shape.name.starts_with("valley")) {
          row("curvature.valley", what + ", true -0.667",
              typical_bend(shape, ours.mean_per_mm, ours.gaussian_per_mm2), "1/mm", "CGAL jets",
              typical_bend(shape, jets.mean_per_mm, jets.gaussian_per_mm2), 0);
        }
      } else {
        row("curvature.error H", what, h, "1/mm rms", nullptr, 0, 0);
        row("curvature.error K", what, k, "1/mm2 rms", nullptr, 0, 0);
      }
      if (peers::has_pcl()) {
        const peers::Values pcl =
            peers::pcl_curvature(shape.points, held, way.config.neighbours > 0 ? 0.0F : k_radius_mm);
        row("curvature.error H", what, h, "1/mm rms", "PCL", rms(shape, pcl.mean_per_mm, shape.mean_per_mm),
            1.0);
      }
    }
  }
}

/// The published Figure 12 as a number: feature points (H < -0.06 / mm) on a flat wall that has none.
void false_features() {
  Maker make;
  Points wall;
  Points outward;
  for (int i = 0; i < 40'000; ++i) {
    wall.emplace_back(make.uniform(0, 100), make.uniform(0, 80), 0.03F * make.normal());
    outward.emplace_back(0, 0, 1);
  }
  const auto share = [&](published::Solver solver, float weight_ratio) {
    const published::Curvature c = published::estimate_curvature(
        wall, outward, {.solver = solver, .radius_mm = 1.5F, .weight_ratio = weight_ratio});
    double count = 0;
    for (const float mean : c.mean_per_mm) count += mean < -0.06F ? 1 : 0;
    return count / static_cast<double>(wall.size());
  };
  const double svd = share(published::Solver::PlainSvd, 0.0F);
  row("curvature.false features", "weighted PCA beside plain SVD, flat wall, noise 0.03 mm",
      share(published::Solver::WeightedPca, 0.6F), "share", "plain SVD", svd, 0);
  row("curvature.false features", "ours beside plain SVD, flat wall, noise 0.03 mm",
      share(published::Solver::LeastSquares, 0.6F), "share", "plain SVD", svd, 0);
}

}  // namespace
}  // namespace biteline::bench

int main() {
  std::fprintf(stderr, "vectors: %s\n", biteline::curvature::vector_target());
  biteline::bench::speed();
  biteline::bench::accuracy();
  biteline::bench::false_features();
}

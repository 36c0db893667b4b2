// SPDX-License-Identifier: MIT
#include "hal/sim/record/ring_target.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "hal/sim/shoe/random.hpp"

namespace biteline::sim {

namespace {

enum class Shade : std::uint8_t { Background, White, Black };

constexpr int k_edge_samples = 6;
/// A board's straight edges run along rows of samples for many pixels.  These lie on a Fibonacci lattice, no
/// two in a row or column.
constexpr int k_board_samples = 89, k_board_step = 55;

Shade shade_on(const RingGrid& grid, double x_mm, double y_mm) {
  if (std::abs(x_mm) > grid.width_mm() / 2 || std::abs(y_mm) > grid.height_mm() / 2) return Shade::Background;
  if (grid.chessboard) {
    const double col = std::floor(x_mm / grid.pitch_mm + 0.5 * (grid.cols + 1));
    const double row = std::floor(y_mm / grid.pitch_mm + 0.5 * (grid.rows + 1));
    if (col < 0 || row < 0 || col > grid.cols || row > grid.rows) return Shade::White;
    return std::fmod(col + row, 2) == 0 ? Shade::Black : Shade::White;
  }
  const double col = std::round(x_mm / grid.pitch_mm + 0.5 * (grid.cols - 1));
  const double row = std::round(y_mm / grid.pitch_mm + 0.5 * (grid.rows - 1));
  if (col < 0 || row < 0 || col >= grid.cols || row >= grid.rows) return Shade::White;
  const Vec3 centre = grid.centre(static_cast<int>(row), static_cast<int>(col));
  const double radius_mm = std::hypot(x_mm - centre.x(), y_mm - centre.y());
  const bool ring = radius_mm < grid.outer_diameter_mm / 2 && radius_mm > grid.inner_diameter_mm / 2;
  return ring ? Shade::Black : Shade::White;
}

/// Sheets with their way back from camera coordinates worked out.
class Sheets {
 public:
  explicit Sheets(std::span<const PlacedGrid> sheets) {
    for (const auto& sheet : sheets)
      sheets_.push_back({sheet.grid, sheet.T_cam_sheet.inverse(Eigen::Isometry)});
  }
  [[nodiscard]] Shade seen_along(const Vec3& ray) const {
    Shade shade = Shade::Background;
    double nearest = std::numeric_limits<double>::max();
    for (const auto& [grid, T_sheet_cam] : sheets_) {
      const Vec3 origin = T_sheet_cam.translation(), direction = T_sheet_cam.linear() * ray;
      if (std::abs(direction.z()) < 1e-9) continue;
      const double distance = -origin.z() / direction.z();
      if (distance <= 0 || distance >= nearest) continue;
      const Shade here =
          shade_on(grid, origin.x() + distance * direction.x(), origin.y() + distance * direction.y());
      if (here == Shade::Background) continue;  // beyond the sheet
      shade = here;
      nearest = distance;
    }
    return shade;
  }

 private:
  struct Sheet {
    RingGrid grid;
    SE3 T_sheet_cam;
  };
  std::vector<Sheet> sheets_;
};

/// Viewing rays of all pixel centres; between them rays bend so little that the neighbours' difference
/// serves.
class Rays {
 public:
  Rays(const MadeHead& head)
      : width_(head.sensor_width_px + 1),
        rays_(static_cast<std::size_t>(width_) * static_cast<std::size_t>(head.sensor_height_px + 1)) {
    for (int v = 0; v <= head.sensor_height_px; ++v) {
      for (int u = 0; u <= head.sensor_width_px; ++u)
        rays_[index(u, v)] = head.model.camera.ray({u, v}).head<2>();
    }
  }
  [[nodiscard]] Vec3 at(int u, int v, double du, double dv) const {
    const Vec2 ray = rays_[index(u, v)] + du * (rays_[index(u + 1, v)] - rays_[index(u, v)]) +
                     dv * (rays_[index(u, v + 1)] - rays_[index(u, v)]);
    return {ray.x(), ray.y(), 1};
  }

 private:
  [[nodiscard]] std::size_t index(int u, int v) const {
    return static_cast<std::size_t>(v) * static_cast<std::size_t>(width_) + static_cast<std::size_t>(u);
  }
  int width_;
  std::vector<Vec2> rays_;
};

/// Places within a pixel.
std::vector<Vec2> edge_samples(bool chessboard) {
  std::vector<Vec2> samples;
  if (chessboard) {
    for (int i = 0; i < k_board_samples; ++i) {
      samples.emplace_back((i + 0.5) / k_board_samples - 0.5,
                           (i * k_board_step % k_board_samples + 0.5) / k_board_samples - 0.5);
    }
    return samples;
  }
  for (int i = 0; i < k_edge_samples; ++i) {
    for (int k = 0; k < k_edge_samples; ++k)
      samples.emplace_back((i + 0.5) / k_edge_samples - 0.5, (k + 0.5) / k_edge_samples - 0.5);
  }
  return samples;
}

/// Separable Gaussian blur; the border repeats.
void blur(std::vector<float>& picture, int width, int height, double sigma_px) {
  const int reach = static_cast<int>(std::ceil(4 * sigma_px));
  std::vector<float> kernel;
  float sum = 0;
  for (int i = -reach; i <= reach; ++i) {
    kernel.push_back(static_cast<float>(std::exp(-0.5 * i * i / (sigma_px * sigma_px))));
    sum += kernel.back();
  }
  for (float& weight : kernel) weight /= sum;
  const auto pass = [&](int lines, int length, std::size_t line_step, std::size_t step) {
    std::vector<float> line(static_cast<std::size_t>(length));
    for (int l = 0; l < lines; ++l) {
      float* begin = picture.data() + static_cast<std::size_t>(l) * line_step;
      for (int i = 0; i < length; ++i)
        line[static_cast<std::size_t>(i)] = begin[static_cast<std::size_t>(i) * step];
      for (int i = 0; i < length; ++i) {
        float value = 0;
        for (int k = -reach; k <= reach; ++k)
          value += kernel[static_cast<std::size_t>(k + reach)] *
                   line[static_cast<std::size_t>(std::clamp(i + k, 0, length - 1))];
        begin[static_cast<std::size_t>(i) * step] = value;
      }
    }
  };
  pass(height, width, static_cast<std::size_t>(width), 1);
  pass(width, height, 1, static_cast<std::size_t>(width));
}

}  // namespace

image::GreyImage render_rings(const MadeHead& head, std::span<const PlacedGrid> placed,
                              const LampLight& light, std::uint64_t noise_seed) {
  const int width = head.sensor_width_px, height = head.sensor_height_px;
  const Sheets sheets(placed);
  const Rays rays(head);
  const auto index = [&](int u, int v) {
    return static_cast<std::size_t>(v) * static_cast<std::size_t>(width) + static_cast<std::size_t>(u);
  };
  const auto ratio_of = [&](Shade shade) {
    return shade == Shade::White ? 1.0 : shade == Shade::Black ? light.black_ratio : light.background_ratio;
  };

  // How far from a column or row the one lies that it is filled from.
  const auto shift = [&](int place) {
    return std::round(light.scaled_ratio * place) / light.scaled_ratio - place;
  };
  const auto seen_from = [&](int u, int v, double du, double dv) {
    return ratio_of(sheets.seen_along(rays.at(u, v, shift(u) + du, shift(v) + dv)));
  };

  const std::vector<Vec2> samples = edge_samples(!placed.empty() && placed.front().grid.chessboard);
  std::vector<Shade> middles(index(0, height));
  for (int v = 0; v < height; ++v) {
    for (int u = 0; u < width; ++u)
      middles[index(u, v)] = sheets.seen_along(rays.at(u, v, shift(u), shift(v)));
  }
  const auto crossed = [&](int u, int v) {
    for (int dv = -1; dv <= 1; ++dv) {
      for (int du = -1; du <= 1; ++du) {
        if (middles[index(std::clamp(u + du, 0, width - 1), std::clamp(v + dv, 0, height - 1))] !=
            middles[index(u, v)])
          return true;
      }
    }
    return false;
  };
  std::vector<float> picture(middles.size());
  for (int v = 0; v < height; ++v) {
    for (int u = 0; u < width; ++u) {
      double ratio = ratio_of(middles[index(u, v)]);
      if (crossed(u, v)) {
        ratio = 0;
        for (const Vec2& sample : samples) ratio += seen_from(u, v, sample.x(), sample.y());
        ratio /= static_cast<double>(samples.size());
      }
      const double across = (u - 0.5 * width) / width * std::cos(light.slope_rad) +
                            (v - 0.5 * height) / width * std::sin(light.slope_rad);
      picture[index(u, v)] = static_cast<float>(light.white_grey * ratio * (1 + light.slope_ratio * across));
    }
  }
  blur(picture, width, height, head.faults.blur_px);

  Random random(noise_seed);
  image::GreyImage developed{.width_px = width, .height_px = height, .pixels = {}};
  developed.pixels.reserve(picture.size());
  for (const float level : picture) {
    const double sigma =
        std::hypot(head.faults.read_noise_grey, std::sqrt(level / head.faults.electrons_per_grey));
    developed.pixels.push_back(
        static_cast<std::uint8_t>(std::clamp(std::lround(level + sigma * random.gaussian()), 0L, 255L)));
  }
  return developed;
}

bool all_rings_visible(const MadeHead& head, const PlacedGrid& sheet, double margin_px) {
  for (int row = 0; row < sheet.grid.rows; ++row) {
    for (int col = 0; col < sheet.grid.cols; ++col) {
      for (int side = 0; side < 8; ++side) {
        const double angle = side * std::numbers::pi / 4;
        const Vec3 rim = sheet.grid.centre(row, col) +
                         0.5 * sheet.grid.outer_diameter_mm * Vec3(std::cos(angle), std::sin(angle), 0);
        const Vec3 rim_cam = sheet.T_cam_sheet * rim;
        if (rim_cam.z() < 20) return false;
        const Vec2 pixel = head.model.camera.project(rim_cam);
        if (pixel.x() < margin_px || pixel.y() < margin_px ||
            pixel.x() > head.sensor_width_px - 1 - margin_px ||
            pixel.y() > head.sensor_height_px - 1 - margin_px)
          return false;
      }
    }
  }
  return true;
}

}  // namespace biteline::sim

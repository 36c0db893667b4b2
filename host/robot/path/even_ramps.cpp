// SPDX-License-Identifier: MIT
#include "host/robot/path/even_ramps.hpp"

#include <algorithm>
#include <cmath>

namespace biteline::path {
namespace {

constexpr double k_sample_s = 1e-3;

/// The place at every k_sample_s of the motion, the first 0.
std::vector<double> places_in_time(std::span<const double> arc_mm, std::span<const double> speed_mm_s) {
  std::vector<double> out;
  double begin_s = 0;
  for (std::size_t i = 0; i + 1 < arc_mm.size(); ++i) {
    const double a = speed_mm_s[i], b = speed_mm_s[i + 1];
    const double whole_s = 2 * (arc_mm[i + 1] - arc_mm[i]) / (a + b);
    for (auto t = static_cast<double>(out.size()) * k_sample_s - begin_s; t < whole_s;
         t = static_cast<double>(out.size()) * k_sample_s - begin_s)
      out.push_back(arc_mm[i] - arc_mm[0] + (a + 0.5 * (b - a) * t / whole_s) * t);
    begin_s += whole_s;
  }
  out.push_back(arc_mm.back() - arc_mm[0]);
  return out;
}

}  // namespace

std::vector<double> lowered_for_mean(std::span<const double> arc_mm, std::span<const double> speed_mm_s,
                                     double window_s) {
  std::vector<double> out(speed_mm_s.begin(), speed_mm_s.end());
  for (std::size_t i = 1; i + 1 < out.size(); ++i) {
    const double reach_mm = 0.5 * window_s * speed_mm_s[i];
    for (const int direction : {-1, 1}) {
      for (std::size_t k = i + static_cast<std::size_t>(direction);
           k > 0 && k + 1 < out.size() && std::abs(arc_mm[k] - arc_mm[i]) <= reach_mm;
           k += static_cast<std::size_t>(direction))
        out[i] = std::min(out[i], speed_mm_s[k]);
    }
  }
  return out;
}

TimeLaw averaged(std::span<const double> arc_mm, std::span<const double> speed_mm_s, double window_s) {
  const std::vector<double> places_mm = places_in_time(arc_mm, speed_mm_s);
  const std::size_t window = std::max<std::size_t>(1, static_cast<std::size_t>(window_s / k_sample_s));
  const double window_mean = 1.0 / static_cast<double>(window);
  const double end_mm = places_mm.back();
  const std::size_t last = arc_mm.size() - 1;
  TimeLaw law{.time_s = std::vector<double>(last + 1), .speed_mm_s = std::vector<double>(last + 1)};
  // Place and speed at the end of a window that slides from before the motion to behind it.
  double place_mm = 0;
  std::size_t next = 1;
  for (std::size_t n = 1; next < last; ++n) {
    const double in_mm = n < places_mm.size() ? places_mm[n] : end_mm;
    const double out_mm = n > window ? places_mm[std::min(n - window, places_mm.size() - 1)] : 0;
    const double step_mm = (in_mm - out_mm) * window_mean;
    for (; next < last && arc_mm[next] - arc_mm[0] <= place_mm + step_mm; ++next) {
      const double part = step_mm > 0 ? (arc_mm[next] - arc_mm[0] - place_mm) / step_mm : 0;
      law.time_s[next] = (static_cast<double>(n - 1) + part) * k_sample_s;
      law.speed_mm_s[next] = step_mm / k_sample_s;
    }
    place_mm += step_mm;
  }
  law.time_s[last] = static_cast<double>(places_mm.size() - 1 + window) * k_sample_s;
  return law;
}

}  // namespace biteline::path

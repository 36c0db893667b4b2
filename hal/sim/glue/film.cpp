// SPDX-License-Identifier: MIT
#include "hal/sim/glue/film.hpp"

#include <cstdint>

#include "hal/sim/robot/program_threads.hpp"

namespace biteline::sim {
namespace {

/// The controller's outputs: the program's until a thread sets one, and again when the program does.
struct Terminals {
  bool gun{false};
  double analog_ratio{0};
  bool programs_gun{false};
  double programs_ratio{0};

  void take(bool gun_now, double ratio_now) {
    if (gun_now != programs_gun) gun = programs_gun = gun_now;
    if (ratio_now != programs_ratio) analog_ratio = programs_ratio = ratio_now;
  }
};

}  // namespace

std::vector<FilmStep> lay_film(const std::shared_ptr<const Program>& program, const FilmTool& tool,
                               double step_s) {
  ProgramThreads threads{program};
  GlueGun gun{tool.gun};
  Terminals terminals;
  double time_s = 0;
  const auto T_base_tcp = [&] {
    return program->T_base_flange_at(time_s) * program->T_flange_tcp_at(time_s);
  };
  const ScriptWorld world{.input_register = [](int) { return 0; },
                          .T_base_tcp = [&](bool) { return SE3{T_base_tcp()}; },
                          .step_s = step_s,
                          .set_output =
                              [&](int number, bool on) {
                                if (number == tool.digital_output) terminals.gun = on;
                              },
                          .set_analog =
                              [&](int number, double ratio) {
                                if (number == tool.analog_output) terminals.analog_ratio = ratio;
                              }};
  const auto spot = [&] {
    const SE3 T = T_base_tcp();
    return Vec3{T.translation() + tool.standoff_mm * T.linear().col(2)};
  };
  std::vector<FilmStep> steps;
  Vec3 before = spot();
  for (; time_s < program->duration_s(); time_s += step_s) {
    const bool wanted = ((program->outputs_at(time_s) >> tool.digital_output) & 1) != 0;
    const double ratio =
        tool.analog_output < 0 ? 0 : program->analog_at(time_s)[static_cast<std::size_t>(tool.analog_output)];
    terminals.take(wanted, ratio);
    static_cast<void>(threads.tell_until(time_s, time_s));
    static_cast<void>(threads.step(time_s, world));
    const Vec3 now = spot();
    const double out = gun.step(step_s, terminals.gun, terminals.analog_ratio);
    steps.push_back({.time_s = time_s,
                     .spot_base = now,
                     .way_mm = (now - before).norm(),
                     .film_mm = out * tool.full_mm_s * step_s,
                     .gun_wanted = wanted});
    before = now;
  }
  return steps;
}

}  // namespace biteline::sim

// SPDX-License-Identifier: MIT
#include "hal/sim/robot/press_run.hpp"

#include <map>

#include "hal/sim/robot/program_threads.hpp"

namespace biteline::sim {

PressRun press_along(const std::shared_ptr<const Program>& program, const ForceFacts& facts,
                     const Touch& touch, int output_register, double step_s) {
  ProgramThreads threads{program};
  ForceControl force{facts, touch};
  std::map<int, int> registers;
  double time_s = 0;
  SE3 T_base_tcp = SE3::Identity();
  const ScriptWorld outside{.input_register = [](int) { return 0; },
                            .T_base_tcp =
                                [&](bool) {
                                  SE3 T = T_base_tcp;
                                  T.translation() += force.off_base_mm();
                                  return T;
                                },
                            .step_s = step_s,
                            .set_output = [](int, bool) {},
                            .set_analog = [](int, double) {},
                            .tcp_force =
                                [&] {
                                  const Vec3& f = force.told_newton();
                                  return ScriptPose{f.x(), f.y(), f.z(), 0, 0, 0};
                                },
                            .act =
                                [&](std::string_view function, std::span<const ScriptValue> values) {
                                  if (function != "write_output_integer_register")
                                    return force.act(function, values);
                                  registers[static_cast<int>(std::get<double>(values[0]))] =
                                      static_cast<int>(std::get<double>(values[1]));
                                  return true;
                                }};
  PressRun run;
  for (; time_s < program->duration_s() && !run.halted; time_s += step_s) {
    T_base_tcp = program->T_base_flange_at(time_s) * program->T_flange_tcp_at(time_s);
    static_cast<void>(threads.tell_until(time_s, time_s));
    run.halted = !threads.step(time_s, outside).empty();
    force.step(T_base_tcp, step_s);
    run.steps.push_back({.time_s = time_s,
                         .tip_base = T_base_tcp.translation(),
                         .off_base = force.off_base_mm(),
                         .true_newton = force.true_newton(),
                         .told_newton = force.told_newton(),
                         .force_mode = force.is_on(),
                         .told = registers[output_register]});
  }
  return run;
}

PressRun press_along(const std::shared_ptr<const Program>& program, const FlangeFacts& facts,
                     const Touch& touch, int output_register, double step_s) {
  ProgramThreads threads{program};
  ContactFlange flange{facts, touch};
  std::map<int, int> registers;
  std::uint64_t outputs = 0;
  std::array<double, 2> analog_ratio{};
  SE3 T_base_tcp = SE3::Identity();
  const ScriptWorld outside{
      .input_register = [](int) { return 0; },
      .T_base_tcp = [&](bool) { return T_base_tcp; },
      .step_s = step_s,
      .set_output =
          [&](int number, bool on) {
            const std::uint64_t bit = std::uint64_t{1} << static_cast<unsigned>(number);
            outputs = on ? outputs | bit : outputs & ~bit;
          },
      .set_analog = [&](int number,
                        double ratio) { analog_ratio.at(static_cast<std::size_t>(number)) = ratio; },
      .digital_in = [&](int number) { return number == facts.ready_input && flange.ready(); },
      .analog_in = [&](int number) { return flange.volts(number); },
      .act =
          [&](std::string_view function, std::span<const ScriptValue> values) {
            if (function != "write_output_integer_register") return false;
            registers[static_cast<int>(std::get<double>(values[0]))] =
                static_cast<int>(std::get<double>(values[1]));
            return true;
          }};
  PressRun run;
  for (double time_s = 0; time_s < program->duration_s() && !run.halted; time_s += step_s) {
    T_base_tcp = program->T_base_flange_at(time_s) * program->T_flange_tcp_at(time_s);
    static_cast<void>(threads.tell_until(time_s, time_s));
    run.halted = !threads.step(time_s, outside).empty();
    flange.step(T_base_tcp, outputs, analog_ratio, step_s);
    const Vec3 axis_base = T_base_tcp.linear() * facts.axis_tcp;
    const double volts = flange.volts(facts.analog_input);
    run.steps.push_back({.time_s = time_s,
                         .tip_base = T_base_tcp.translation(),
                         .off_base = flange.out_mm() * axis_base,
                         .true_newton = flange.true_newton(),
                         .told_newton = -0.1 * volts * facts.full_newton * axis_base,
                         .force_mode = flange.is_on(),
                         .volts = volts,
                         .told = registers[output_register]});
  }
  return run;
}

}  // namespace biteline::sim

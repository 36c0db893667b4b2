// SPDX-License-Identifier: MIT
#include "host/robot/path/process.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <numbers>

#include "common/config/yaml_reader.hpp"
#include "common/core/fixed_text.hpp"
#include "common/core/plain_number.hpp"
#include "common/core/text_bounds.hpp"

namespace biteline::path {
namespace {

using config::YamlReader;

/// Points that claim as much hold to 0.95 and more (docs/line-figures.md, bench of the confidence).
constexpr double k_automatic_above = 0.95;
constexpr double k_rad_per_deg = std::numbers::pi / 180;

/// By which others call it, or nothing.
std::string read_name_or_none(YamlReader& reader, const char* key) {
  std::string name = reader.text_or(key, "");
  if (name.empty() || is_name(name)) return name;
  reader.fault(Errc::BadValue, key,
               "letters, digits, '.', '_' and '-', at most 64, the first a letter or a digit");
  return {};
}

Tool read_tool(YamlReader reader) {
  Tool tool;
  tool.name = read_name_or_none(reader, "name");
  const std::vector<double> position_mm = reader.numbers("tcp_position_mm", 3);
  const std::vector<double> rotation_deg = reader.numbers("tcp_rotation_deg", 3);
  tool.T_flange_tcp.translation() = Vec3{position_mm[0], position_mm[1], position_mm[2]};
  tool.T_flange_tcp.linear() =
      geometry::exp_so3(Vec3{rotation_deg[0], rotation_deg[1], rotation_deg[2]} * k_rad_per_deg);
  tool.body_radius_mm = reader.number("body_radius_mm", {.minimum = 1, .maximum = 200});
  tool.contact_length_mm = reader.number("contact_length_mm", {.minimum = 0, .maximum = 300});
  tool.free_turn_rad = reader.number("free_turn_deg", {.minimum = 0, .maximum = 180}) * k_rad_per_deg;
  const std::vector<double> centre_mm = reader.numbers("payload_centre_mm", 3);
  tool.payload = Payload{.mass_kg = reader.number("payload_kg", {.minimum = 0, .maximum = 20}),
                         .centre_flange_mm = {centre_mm[0], centre_mm[1], centre_mm[2]}};
  if (!(tool.payload->centre_flange_mm.norm() <= 1000)) {
    reader.fault(Errc::BadValue, "payload_centre_mm", "a centre of mass within 1000 mm of the flange");
  }
  if (tool.T_flange_tcp.translation().norm() > 1000) {
    reader.fault(Errc::BadValue, "tcp_position_mm", "a tip within 1000 mm of the flange");
  }
  return tool;
}

Outwards read_outwards(YamlReader& reader) {
  return reader.choice_or_first("outwards", {"level", "normal"}) == "normal" ? Outwards::Normal
                                                                             : Outwards::Level;
}

TipPlacement read_placement(YamlReader reader) {
  return {.outwards = read_outwards(reader),
          .outward_mm = reader.number("outward_mm", {.minimum = -50, .maximum = 200}),
          .up_mm = reader.number("up_mm", {.minimum = -50, .maximum = 200}),
          .standoff_mm = reader.number_or("standoff_mm", 0, {.minimum = 0, .maximum = 500}),
          .tilt_rad = reader.number("tilt_deg", {.minimum = -45, .maximum = 90}) * k_rad_per_deg,
          .lead_rad = reader.number("lead_deg", {.minimum = -60, .maximum = 60}) * k_rad_per_deg};
}

Coverage read_coverage(YamlReader reader) {
  return {.contact_width_mm = reader.number_or("contact_width_mm", 0, {.minimum = 0, .maximum = 200}),
          .cone_rad = reader.number_or("cone_deg", 0, {.minimum = 0, .maximum = 120}) * k_rad_per_deg};
}

Motion read_motion(YamlReader reader) {
  const Motion d;
  Motion m;
  m.speed_mm_s = reader.number("speed_mm_s", {.minimum = 0.1, .maximum = k_most_speed_mm_s});
  m.minimum_speed_mm_s =
      reader.number_or("minimum_speed_mm_s", std::min(d.minimum_speed_mm_s, m.speed_mm_s / 10),
                       {.minimum = 0.01, .maximum = 1000});
  m.acceleration_mm_s2 =
      reader.number_or("acceleration_mm_s2", d.acceleration_mm_s2, {.minimum = 1, .maximum = 10000});
  m.cross_acceleration_mm_s2 = reader.number_or("cross_acceleration_mm_s2", d.cross_acceleration_mm_s2,
                                                {.minimum = 1, .maximum = 10000});
  m.joint_speed_ratio =
      reader.number_or("joint_speed_ratio", d.joint_speed_ratio, {.minimum = 0.01, .maximum = 1});
  const double give_mm = reader.number_or("give_mm", 0, {.minimum = 0, .maximum = 10});
  if (give_mm > 0) m.give_mm = give_mm;
  m.spacing_mm = reader.number_or("spacing_mm", d.spacing_mm, {.minimum = 0.5, .maximum = 10});
  m.blend_mm = reader.number_or("blend_mm", d.blend_mm, {.minimum = k_least_blend_mm, .maximum = 5});
  m.chord_error_mm = reader.number_or("chord_error_mm", d.chord_error_mm, {.minimum = 0.01, .maximum = 5});
  m.overlap_mm = reader.number_or("overlap_mm", d.overlap_mm, {.minimum = 0, .maximum = 100});
  m.approach_mm = reader.number_or("approach_mm", d.approach_mm, {.minimum = 1, .maximum = 300});
  m.approach_speed_mm_s =
      reader.number_or("approach_speed_mm_s", d.approach_speed_mm_s, {.minimum = 1, .maximum = 500});
  m.draw_back_mm = reader.number_or("draw_back_mm", d.draw_back_mm, {.minimum = 0, .maximum = 300});
  m.lift_mm = reader.number_or("lift_mm", d.lift_mm, {.minimum = 0, .maximum = 500});
  m.transfer_speed_mm_s =
      reader.number_or("transfer_speed_mm_s", d.transfer_speed_mm_s, {.minimum = 1, .maximum = 1000});
  if (m.minimum_speed_mm_s > m.speed_mm_s)
    reader.fault(Errc::BadValue, "minimum_speed_mm_s", "at most speed_mm_s");
  return m;
}

FollowLimits read_follow(YamlReader reader) {
  const FollowLimits d;
  const auto degrees = [&](const char* key, double unless_rad) {
    return reader.number_or(key, unless_rad / k_rad_per_deg, {.minimum = 0.05, .maximum = 30}) *
           k_rad_per_deg;
  };
  return {.off_path_mm = reader.number_or("off_path_mm", d.off_path_mm, {.minimum = 0.1, .maximum = 50}),
          .off_path_rad = degrees("off_path_deg", d.off_path_rad),
          .off_way_rad = degrees("off_way_deg", d.off_way_rad),
          .late_s = reader.number_or("late_s", d.late_s, {.minimum = 0.1, .maximum = 600}),
          .stall_s = reader.number_or("stall_s", d.stall_s, {.minimum = 0.1, .maximum = 60}),
          .silence_s = reader.number_or("silence_s", d.silence_s, {.minimum = 0.05, .maximum = 5}),
          .covered = reader.number_or("covered", d.covered, {.minimum = 0.5, .maximum = 1})};
}

GateLimits read_gate(YamlReader reader) {
  const GateLimits d;
  GateLimits gate;
  gate.scan_age_s = reader.number_or("scan_age_s", d.scan_age_s, {.minimum = 1, .maximum = 3600});
  gate.lost_in_a_row =
      static_cast<int>(reader.integer_or("lost_in_a_row", d.lost_in_a_row, {.minimum = 0, .maximum = 1000}));
  gate.start_rad =
      reader.number_or("start_deg", d.start_rad / k_rad_per_deg, {.minimum = 0.01, .maximum = 5}) *
      k_rad_per_deg;
  const std::string approval = reader.choice_or_first("approval", {"none", "person", "automatic"});
  gate.approval = approval != "none";
  const double above = reader.number_or("automatic_above", k_automatic_above, {.minimum = 0, .maximum = 1});
  if (approval == "automatic") gate.automatic_above = above;
  const double tolerance_mm = reader.number_or("tolerance_mm", 0, {.minimum = 0, .maximum = 20});
  if (tolerance_mm > 0) gate.tolerance_mm = tolerance_mm;
  const double tip_tolerance_mm = reader.number_or("tip_tolerance_mm", 0, {.minimum = 0, .maximum = 20});
  if (tip_tolerance_mm > 0) gate.tip_tolerance_mm = tip_tolerance_mm;
  return gate;
}

/// The process's own value and a zone's addition stay within what the process itself may have.
void check_sum(YamlReader& reader, const char* key, double sum, double minimum, double maximum) {
  // So that the last digit of a turn into radians and back refuses nothing.
  constexpr double k_rounding = 1e-9;
  if (sum >= minimum - k_rounding && sum <= maximum + k_rounding) return;
  reader.fault(Errc::BadValue, key,
               FixedText<120>::format("with the placement's own %.6g, expected from %.6g to %.6g", sum,
                                      minimum, maximum)
                   .c_str());
}

/// For people, on pages and in every row of the memory.
std::string read_title(YamlReader& reader, std::size_t most_bytes) {
  std::string title = reader.text("name");
  if (bounds::fits(title, most_bytes)) return title;
  reader.fault(Errc::BadValue, "name", bounds::expected(most_bytes));
  return {};
}

Zone read_zone(YamlReader& reader, const Process& process) {
  const Zone d;
  Zone zone;
  zone.name = read_title(reader, bounds::k_name);
  const std::string where = reader.choice_or_first("where", {"stretch", "heel", "toe"});
  if (where == "heel") zone.where = Zone::Where::Heel;
  if (where == "toe") zone.where = Zone::Where::Toe;
  const NumberRange percent{.minimum = 0, .maximum = 100};
  zone.from_ratio = reader.number_or("from_percent", 0, percent) / 100;
  zone.to_ratio = reader.number_or("to_percent", 0, percent) / 100;
  zone.reach_ratio =
      reader.number_or("reach_percent", 100 * d.reach_ratio, {.minimum = 1, .maximum = 50}) / 100;
  zone.left_out = reader.choice_or_first("work", {"worked", "left_out"}) == "left_out";
  const NumberRange offset{.minimum = -50, .maximum = 50}, angle{.minimum = -60, .maximum = 60};
  zone.outward_by_mm = reader.number_or("outward_by_mm", 0, offset);
  zone.up_by_mm = reader.number_or("up_by_mm", 0, offset);
  zone.tilt_by_rad = reader.number_or("tilt_by_deg", 0, angle) * k_rad_per_deg;
  zone.lead_by_rad = reader.number_or("lead_by_deg", 0, angle) * k_rad_per_deg;
  zone.speed_ratio = reader.number_or("speed_ratio", 1, {.minimum = 0.05, .maximum = k_most_speed_ratio});
  zone.passes = static_cast<int>(reader.integer_or("passes", 1, {.minimum = 1, .maximum = 10}));
  zone.ramp_mm = reader.number_or("ramp_mm", d.ramp_mm, {.minimum = 1, .maximum = 50});
  if (zone.where == Zone::Where::Stretch && zone.from_ratio == zone.to_ratio)
    reader.fault(Errc::BadValue, "to_percent", "a stretch ends elsewhere than it begins");
  const TipPlacement& own = process.placement;
  check_sum(reader, "outward_by_mm", own.outward_mm + zone.outward_by_mm, -50, 200);
  check_sum(reader, "up_by_mm", own.up_mm + zone.up_by_mm, -50, 200);
  check_sum(reader, "tilt_by_deg", (own.tilt_rad + zone.tilt_by_rad) / k_rad_per_deg, -45, 90);
  check_sum(reader, "lead_by_deg", (own.lead_rad + zone.lead_by_rad) / k_rad_per_deg, -60, 60);
  if (zone.speed_ratio * process.motion.speed_mm_s < process.motion.minimum_speed_mm_s)
    reader.fault(Errc::BadValue, "speed_ratio", "a speed of at least motion.minimum_speed_mm_s");
  if (zone.speed_ratio * process.motion.speed_mm_s > k_most_speed_mm_s)
    reader.fault(Errc::BadValue, "speed_ratio", "a speed of at most 1000 mm/s");
  return zone;
}

/// From the beginning of force mode until the tip must have touched.
double seek_s(const Force& force) {
  return force.reach_mm / force.approach_mm_s;
}

/// A tip that works slowly must not be taken for one that stands.
void check_stall(YamlReader& reader, const Process& process) {
  double slowest_mm_s = process.motion.speed_mm_s;
  for (const Zone& zone : process.zones)
    slowest_mm_s = std::min(slowest_mm_s, zone.speed_ratio * process.motion.speed_mm_s);
  if (process.placement.standoff_mm > 0) slowest_mm_s *= k_least_tip_ratio;
  const double waits_s = process.flow ? process.flow->gun_on_s + process.flow->dwell_s : 0;
  if (process.force && seek_s(*process.force) > process.follow.stall_s / 2)
    reader.fault(Errc::BadValue, "force.approach_mm_s",
                 "with reach_mm so fast that the tool touches within half of follow.stall_s");
  if (waits_s > process.follow.stall_s / 2)
    reader.fault(Errc::BadValue, "flow.dwell_ms",
                 "with gun_on_ms at most half of follow.stall_s, or the tip seems to stand");
  // Without a speed there is a fault already.
  if (!(slowest_mm_s > 0)) return;
  const double least_s = 2 * k_least_advance_mm / slowest_mm_s;
  if (process.follow.stall_s >= least_s) return;
  reader.fault(Errc::BadValue, "follow.stall_s",
               FixedText<120>::format("at %s mm/s at least %s s, or the tip seems to stand",
                                      plain_number(slowest_mm_s).c_str(), plain_number(least_s).c_str())
                   .c_str());
}

/// Along the line, by process and zones.
double fastest_mm_s(const Process& process) {
  double ratio = 1;
  for (const Zone& zone : process.zones) ratio = std::max(ratio, zone.speed_ratio);
  return ratio * process.motion.speed_mm_s;
}

Flow read_flow(YamlReader reader, const Process& process) {
  constexpr double k_s_per_ms = 1e-3;
  const NumberRange time_ms{.minimum = 0, .maximum = 2000};
  const double overlap_mm = process.motion.overlap_mm, fastest = fastest_mm_s(process);
  Flow flow{
      .gun_on_s = reader.number_or("gun_on_ms", 0, time_ms) * k_s_per_ms,
      .gun_off_s = reader.number_or("gun_off_ms", 0, time_ms) * k_s_per_ms,
      .dwell_s = reader.number_or("dwell_ms", 0, time_ms) * k_s_per_ms,
      .film_overlap_mm = reader.number_or("film_overlap_mm", overlap_mm, {.minimum = 0, .maximum = 100}),
      .analog_output =
          static_cast<int>(reader.integer_or("analog_output", -1, {.minimum = -1, .maximum = 1})),
      .full_mm_s = reader.number_or("full_mm_s", 0, {.minimum = 0, .maximum = 5000}),
      .lag_s = reader.number_or("lag_ms", 0, {.minimum = 0, .maximum = 500}) * k_s_per_ms,
      .purge_s = reader.number_or("purge_ms", 0, {.minimum = 0, .maximum = 10000}) * k_s_per_ms};
  int axis = 0;
  for (const char* key : {"purge_x_mm", "purge_y_mm", "purge_z_mm"})
    flow.purge_at_base[axis++] = reader.number_or(key, 0, {.minimum = -2000, .maximum = 2000});
  if (flow.film_overlap_mm > overlap_mm)
    reader.fault(Errc::BadValue, "film_overlap_mm", "at most motion.overlap_mm");
  if (flow.full_mm_s == 0) flow.full_mm_s = fastest;
  if (flow.full_mm_s < fastest)
    reader.fault(Errc::BadValue, "full_mm_s",
                 FixedText<120>::format("at least the line's fastest, %s mm/s", plain_number(fastest).c_str())
                     .c_str());
  return flow;
}

/// A form that was filled in and emptied leaves a flow without a word.
bool says_anything(const Flow& flow, double overlap_mm) {
  return flow.gun_on_s > 0 || flow.gun_off_s > 0 || flow.dwell_s > 0 || flow.analog_output >= 0 ||
         flow.purge_s > 0 || flow.film_overlap_mm < overlap_mm;
}

/// Lines that another part of the process switches would let the flange go.
void check_flange(YamlReader& reader, const Process& process) {
  if (!process.force || !process.force->flange) return;
  const Flange& flange = *process.force->flange;
  if (flange.on_output == process.digital_output)
    reader.fault(Errc::BadValue, "force.flange_on_output", "another one than digital_output");
  if (process.flow && process.flow->analog_output == flange.analog_output)
    reader.fault(Errc::BadValue, "force.flange_analog_output", "another one than flow.analog_output");
}

Flange read_flange(YamlReader& reader, double tilt_rad) {
  const NumberRange line{.minimum = 0, .maximum = 7}, analog{.minimum = 0, .maximum = 1};
  const Flange d;
  return {
      .analog_output = static_cast<int>(reader.integer_or("flange_analog_output", d.analog_output, analog)),
      .analog_input = static_cast<int>(reader.integer_or("flange_analog_input", d.analog_input, analog)),
      .on_output = static_cast<int>(reader.integer_or("flange_on_output", 4, line)),
      .ready_input = static_cast<int>(reader.integer_or("flange_ready_input", 4, line)),
      .full_newton = reader.number_or("flange_full_n", d.full_newton, {.minimum = 10, .maximum = 1000}),
      .stroke_mm = reader.number_or("flange_stroke_mm", d.stroke_mm, {.minimum = 2, .maximum = 100}),
      .tilt_rad =
          reader.number_or("flange_tilt_deg", tilt_rad / k_rad_per_deg, {.minimum = -90, .maximum = 90}) *
          k_rad_per_deg};
}

std::optional<Force> read_force(YamlReader reader, double tilt_rad) {
  constexpr double k_s_per_ms = 1e-3, k_per_percent = 1e-2;
  const Force d;
  const double set_newton = reader.number_or("set_n", 0, {.minimum = 0, .maximum = 200});
  const bool by_flange = reader.choice_or_first("by", {"arm", "flange"}) == "flange";
  const Flange flange = read_flange(reader, tilt_rad);
  const Force force{
      .set_newton = set_newton,
      .contact_newton = reader.number_or("contact_n", d.contact_newton, {.minimum = 1, .maximum = 50}),
      .approach_mm_s = reader.number_or("approach_mm_s", d.approach_mm_s, {.minimum = 0.5, .maximum = 50}),
      .reach_mm = reader.number_or("reach_mm", d.reach_mm, {.minimum = 0.2, .maximum = 10}),
      .ramp_mm = reader.number_or("ramp_mm", d.ramp_mm, {.minimum = 0.5, .maximum = 50}),
      .limit_mm_s = reader.number_or("limit_mm_s", d.limit_mm_s, {.minimum = 1, .maximum = 100}),
      .damping_ratio = reader.number_or("damping", d.damping_ratio, {.minimum = 0, .maximum = 1}),
      .gain_ratio = reader.number_or("gain", d.gain_ratio, {.minimum = 0.05, .maximum = 2}),
      .most_newton = reader.number_or("most_n", d.most_newton, {.minimum = 2, .maximum = 250}),
      .lost_s =
          reader.number_or("lost_ms", d.lost_s / k_s_per_ms, {.minimum = 20, .maximum = 2000}) * k_s_per_ms,
      .tolerance_ratio = reader.number_or("tolerance_percent", d.tolerance_ratio / k_per_percent,
                                          {.minimum = 0, .maximum = 200}) *
                         k_per_percent,
      .flange = by_flange ? std::optional{flange} : std::nullopt};
  if (set_newton == 0) return std::nullopt;
  if (set_newton < 2 * force.contact_newton)
    reader.fault(Errc::BadValue, "set_n", "0, or at least twice contact_n");
  if (force.most_newton < 1.2 * set_newton)
    reader.fault(Errc::BadValue, "most_n", "at least 1.2 times set_n");
  if (by_flange && force.reach_mm > flange.stroke_mm / 2)
    reader.fault(Errc::BadValue, "flange_stroke_mm", "at least twice reach_mm");
  return force;
}

Start read_start(YamlReader& reader) {
  const std::string word = reader.choice_or_first("start", {"auto", "nearest", "farthest"});
  if (word == "nearest") return Start::Nearest;
  return word == "farthest" ? Start::Farthest : Start::Auto;
}

AfterWork read_after_work(YamlReader& reader) {
  const std::string word = reader.choice_or_first("after_work", {"nothing", "look", "rework"});
  if (word == "look") return AfterWork::Look;
  return word == "rework" ? AfterWork::Rework : AfterWork::None;
}

Process read_all(YamlReader& reader) {
  Process process;
  process.name = read_title(reader, bounds::k_title);
  process.tool = read_tool(reader.child("tool", true));
  process.placement = read_placement(reader.child("placement", true));
  process.coverage = read_coverage(reader.child("coverage", true));
  process.motion = read_motion(reader.child("motion", true));
  process.follow = read_follow(reader.child("follow", false));
  process.gate = read_gate(reader.child("gate", false));
  process.start = read_start(reader);
  process.after_work = read_after_work(reader);
  process.look_tolerance_mm =
      reader.number_or("look_tolerance_mm", process.look_tolerance_mm, {.minimum = 0.1, .maximum = 20});
  process.next_process = read_name_or_none(reader, "next_process");
  process.digital_output =
      static_cast<int>(reader.integer_or("digital_output", -1, {.minimum = -1, .maximum = 7}));
  if (const std::string foot = reader.choice_or_first("foot", {"any", "left", "right"}); foot != "any")
    process.foot = foot;
  for (YamlReader& zone : reader.children("zones", k_most_zones))
    process.zones.push_back(read_zone(zone, process));
  const Flow flow = read_flow(reader.child("flow", false), process);
  if (says_anything(flow, process.motion.overlap_mm)) {
    process.flow = flow;
    if (process.digital_output < 0)
      reader.fault(Errc::BadValue, "digital_output", "the gun's output, 0 to 7, where there is a flow");
  }
  process.force = read_force(reader.child("force", false), process.placement.tilt_rad);
  if (process.force && process.placement.standoff_mm > 0)
    reader.fault(Errc::BadValue, "force.set_n", "0 where the tool stands off (placement.standoff_mm)");
  check_flange(reader, process);
  if (process.after_work != AfterWork::None && !(covered_width_mm(process) > 0))
    reader.fault(Errc::BadValue, "after_work", "a look needs the band's width: coverage expected");
  check_stall(reader, process);
  return process;
}

}  // namespace

bool is_name(const std::string& text) {
  const auto in_a_name = [](unsigned char c) {
    return c < 128 && (std::isalnum(c) != 0 || c == '.' || c == '_' || c == '-');
  };
  return text.size() <= bounds::k_name && std::ranges::all_of(text, in_a_name) && !text.empty() &&
         text.front() != '.' && text.front() != '_' && text.front() != '-';
}

Vec3 axis_tcp(const Flange& flange) {
  return {0, -std::sin(flange.tilt_rad), std::cos(flange.tilt_rad)};
}

double covered_width_mm(const Process& process) {
  const Coverage& coverage = process.coverage;
  if (coverage.cone_rad > 0) return 2 * process.placement.standoff_mm * std::tan(coverage.cone_rad / 2);
  return coverage.contact_width_mm;
}

Result<Process> read_process(const std::filesystem::path& file) {
  BITELINE_ASSIGN(YamlReader reader, YamlReader::open(file));
  Process process = read_all(reader);
  BITELINE_TRY(reader.finish());
  return process;
}

Result<ProcessText> parse_process(const std::string& text, const std::string& name) {
  BITELINE_ASSIGN(YamlReader reader, YamlReader::parse(text, name));
  ProcessText parsed;
  reader.note_keys(parsed.keys);
  parsed.process = read_all(reader);
  BITELINE_TRY(reader.finish());
  return parsed;
}

config::KeysAsked process_keys() {
  config::KeysAsked keys;
  Result<YamlReader> reader = YamlReader::parse("{zones: [{}]}", "process");
  reader->note_keys(keys);
  static_cast<void>(read_all(*reader));
  return keys;
}

}  // namespace biteline::path

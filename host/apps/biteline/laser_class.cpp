// SPDX-License-Identifier: MIT
// biteline laser-class: the class of a head's laser with its strobe, without it, and after a fault.
#include "common/optics/laser_class.hpp"

#include <algorithm>
#include <initializer_list>
#include <memory>
#include <numbers>
#include <optional>
#include <vector>

#include "common/core/fixed_text.hpp"
#include "host/apps/biteline/command.hpp"

namespace biteline::app {
namespace {

/// What the laser guard needs at most (docs/laser-safety.md).
constexpr double k_guard_s = 0.1;

struct LaserQuestion {
  optics::LineLaser laser{};
  double fan_deg{48};
  std::optional<double> exposure_us, rate_hz, fault_mw;
};

struct LaserCase {
  const char *name, *words;
  bool counts;  ///< for the product's class
  optics::LineLaser laser;
  optics::LaserJudgement judged;
};

Result<std::vector<LaserCase>> cases_of(const LaserQuestion& question) {
  optics::LineLaser laser = question.laser;
  laser.fan_rad = question.fan_deg * std::numbers::pi / 180;
  optics::LineLaser broken = laser;
  broken.power_mw = question.fault_mw.value_or(laser.power_mw);
  if (broken.power_mw < laser.power_mw)
    return fail(Errc::InvalidArgument, "--fault-mw %.4g: a fault makes no less light than --laser-mw %.4g",
                broken.power_mw, laser.power_mw);
  std::vector<LaserCase> cases;
  const auto add = [&](const char* name, const char* words, bool counts, const optics::LineLaser& of,
                       const optics::Emission& emission) {
    cases.push_back({name, words, counts, of, optics::judge(of, emission)});
  };
  if (question.rate_hz) {
    const double length_s = *question.exposure_us * 1e-6;
    if (length_s * *question.rate_hz >= 1)
      return fail(Errc::InvalidArgument,
                  "--exposure-us %.6g at --rate-hz %.6g: pulses shorter than their distance expected",
                  *question.exposure_us, *question.rate_hz);
    add("strobe", "with the strobe", true, laser, {.length_s = length_s, .rate_hz = *question.rate_hz});
  }
  add("continuous", "without the strobe", !question.rate_hz, laser, optics::k_continuous);
  add("fault_until_guard", "fault, dark after 0.1 s", false, broken, {.length_s = k_guard_s});
  add("fault", "fault, nothing cuts", true, broken, optics::k_continuous);
  return cases;
}

nlohmann::ordered_json json_of(const optics::LimitShare& share) {
  return {{"share", share.share}, {"rule", optics::name_of(share.rule)}};
}

nlohmann::ordered_json json_of(const LaserCase& one) {
  nlohmann::ordered_json json{{"case", one.name},
                              {"laser_class", optics::name_of(one.judged.laser_class)},
                              {"counts", one.counts},
                              {"laser_mw", one.laser.power_mw},
                              {"eye_mw", one.judged.eye_mw},
                              {"binoculars_mw", one.judged.binoculars_mw},
                              {"of_class_1", json_of(one.judged.one)}};
  if (optics::visible(one.laser.wavelength_nm)) json["of_class_2"] = json_of(one.judged.two);
  json["of_class_3R"] = json_of(one.judged.three_r);
  json["of_class_3B"] = json_of(one.judged.three_b);
  return json;
}

/// Of a limit.
std::string times(double share) {
  return share > 0 ? std::string{FixedText<24>::format("%.3g", share).view()} : "-";
}

std::string words_of(const std::vector<LaserCase>& cases, optics::LaserClass of_all) {
  using Text = FixedText<300>;
  std::string words = Text::format("%-24s %10s %8s %8s %8s %8s  %-5s %s", "", "in the eye", "of 1", "of 2",
                                   "of 3R", "of 3B", "class", "strictest for class 1")
                          .c_str();
  for (const LaserCase& one : cases)
    words += Text::format("\n%-24s %7.3f mW %8s %8s %8s %8s  %-5s %s", one.words, one.judged.eye_mw,
                          times(one.judged.one.share).c_str(), times(one.judged.two.share).c_str(),
                          times(one.judged.three_r.share).c_str(), times(one.judged.three_b.share).c_str(),
                          optics::name_of(one.judged.laser_class), optics::name_of(one.judged.one.rule))
                 .c_str();
  words += std::string("\nclass ") + optics::name_of(of_all) +
           ", by what shines on purpose and by a fault that nothing cuts: the guard is no certified part.";
  words +=
      "\nBy IEC 60825-1:2014 for a source that is a point to the eye. A judgement, no certificate: a test "
      "house "
      "measures.";
  return words;
}

Result<ExitStatus> run_laser_class(const LaserQuestion& question, const GlobalOptions& global) {
  BITELINE_ASSIGN(const std::vector<LaserCase> cases, cases_of(question));
  optics::LaserClass of_all = optics::LaserClass::One;
  report::Report report;
  auto rows = nlohmann::ordered_json::array();
  for (const LaserCase& one : cases) {
    if (one.counts) of_all = std::max(of_all, one.judged.laser_class);
    rows.push_back(json_of(one));
  }
  report.fields["wavelength_nm"] = question.laser.wavelength_nm;
  report.fields["fan_deg"] = question.fan_deg;
  report.fields["laser_class"] = optics::name_of(of_all);
  report.fields["cases"] = std::move(rows);
  // The table is the result: --quiet leaves it.
  return tell(report, {.quiet = false, .json = global.json}, words_of(cases, of_all));
}

}  // namespace

void add_laser_class(options::Command& app, Context& context) {
  auto question = std::make_shared<LaserQuestion>();
  options::Command* command = app.add_subcommand(
      "laser-class", "The class of a line laser by IEC 60825-1:2014: with strobe, without, after a fault");
  struct Measure {
    const char *name, *help, *unit;
    double* value;
    NumberRange interval;
  };
  optics::LineLaser& laser = question->laser;
  for (const Measure& measure : std::initializer_list<Measure>{
           {"--laser-mw",
            "All of the line's power, while it is on",
            "mW",
            &laser.power_mw,
            {.minimum = 0.001, .maximum = 10000}},
           {"--wavelength-nm", "Of the laser", "nm", &laser.wavelength_nm, {.minimum = 400, .maximum = 1050}},
           {"--fan-deg",
            "Full angle of the line; 0: a parallel beam",
            "degrees",
            &question->fan_deg,
            {.minimum = 0, .maximum = 150}},
           {"--line-peak",
            "The line's brightest place over its mean; 1: even",
            "",
            &laser.peak_ratio,
            {.minimum = 1, .maximum = 100}},
           {"--line-width-mm",
            "Of the line where it leaves its optics",
            "mm",
            &laser.width_mm,
            {.minimum = 0, .maximum = 1000}},
           {"--nearest-mm",
            "From where the line fans out to the nearest place of an eye",
            "mm",
            &laser.nearest_mm,
            {.minimum = 0, .maximum = 10000}},
       }) {
    command->add_option(measure.name, *measure.value, measure.help)
        ->check(options::number(measure.interval, measure.unit))
        ->capture_default_str();
  }
  options::Option* exposure =
      command->add_option("--exposure-us", question->exposure_us, "The strobe's pulse; absent: no strobe")
          ->check(options::number({.minimum = 1, .maximum = 1e6}, "us"));
  options::Option* rate = command->add_option("--rate-hz", question->rate_hz, "Pulses a second")
                              ->check(options::number({.minimum = 0.01, .maximum = 100000}, "Hz"));
  exposure->needs(rate);
  rate->needs(exposure);
  command
      ->add_option("--fault-mw", question->fault_mw,
                   "The line's power when the laser's own driver fails; else --laser-mw")
      ->check(options::number({.minimum = 0.001, .maximum = 100000}, "mW"));
  command->callback([question, &context] {
    context.run = [question, &context] { return run_laser_class(*question, context.options); };
  });
}

}  // namespace biteline::app

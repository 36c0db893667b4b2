// SPDX-License-Identifier: MIT
#include "host/apps/biteline/doctor_light.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <initializer_list>
#include <nlohmann/json.hpp>

#include "common/config/sensor_yaml.hpp"
#include "common/optics/laser_class.hpp"
#include "host/records/batch/json_fields.hpp"

namespace biteline::app {
namespace {

const char* name_of(optics::NoiseLimit limit) {
  switch (limit) {
    case optics::NoiseLimit::Speckle:
      return "speckle";
    case optics::NoiseLimit::Camera:
      return "camera";
    case optics::NoiseLimit::Pixels:
      return "pixels";
    case optics::NoiseLimit::Motion:
      return "motion";
    case optics::NoiseLimit::DepthOfField:
      return "depth_of_field";
  }
  return "";
}

const char* sentence_of(optics::NoiseLimit limit) {
  switch (limit) {
    case optics::NoiseLimit::Speckle:
      return "the laser's speckle limits a point";
    case optics::NoiseLimit::Camera:
      return "the camera's own noise limits a point: more light helps";
    case optics::NoiseLimit::Pixels:
      return "the stripe is too thin for these pixels: widen it";
    case optics::NoiseLimit::Motion:
      return "the surface moves on by more than the stripe within one exposure: details are lost";
    case optics::NoiseLimit::DepthOfField:
      return "depth of field limits it: the range's ends are out of focus";
  }
  return "";
}

/// As doctor knows it: even, continuous, seen from 100 mm.
optics::LaserJudgement judged(const optics::ScanLight& light) {
  return optics::judge(
      {.power_mw = light.laser_mw, .wavelength_nm = light.wavelength_nm, .fan_rad = light.fan_rad},
      optics::k_continuous);
}

std::string text(const char* format, double value) {
  char line[80];
  std::snprintf(line, sizeof line, format, value);
  return line;
}

/// Forecasts agree with rendered pictures so far, and a measured contrast with the true one.
constexpr double k_agreement_ratio = 0.15;

/// "0.45 measured, 0.47 forecast", and whether they agree within both tolerances.
std::string beside(const char* when, double measured, double forecast) {
  char line[160];
  std::snprintf(line, sizeof line, "%s: contrast %.2f measured, %.2f forecast", when, measured, forecast);
  std::string words = line;
  if (std::abs(measured - forecast) <= 2 * k_agreement_ratio * forecast) return words + ".";
  return words + (measured > forecast ? ": more than this light has. Is the lens stopped down farther?"
                                      : ": less than this light has. Is it out of focus, or wider open?");
}

/// The worst of the range.
double worst_mm(const LightChoice& choice) {
  return std::max(choice.noise.middle_mm, choice.noise.end_mm);
}

}  // namespace

std::vector<LightChoice> light_choices(const optics::ScanLight& light) {
  std::vector<LightChoice> choices;
  const auto add = [&](std::string what, const optics::ScanLight& other) {
    choices.push_back({std::move(what), other, optics::stripe_noise(other)});
  };
  add("as it is", light);
  for (const double f_number : {2.8, 4.0, 5.6, 8.0})
    if (f_number != light.f_number)
      add(text("f/%.1f, same brightness", f_number), optics::with_f_number(light, f_number));
  for (const double ratio : {0.5, 2.0}) {
    optics::ScanLight other = light;
    other.speed_mm_s *= ratio;
    add(text("%.0f mm/s", other.speed_mm_s), other);
  }
  for (const double ratio : {0.5, 2.0})
    add(text("laser of %.3g mW, same brightness", ratio * light.laser_mw),
        optics::with_laser_mw(light, ratio * light.laser_mw));
  const double half_mm = 0.5 * light.stripe_mm;
  add(text("sheet of %.3g mm, same brightness", half_mm), optics::with_stripe_mm(light, half_mm));
  optics::ScanLight blue = light;
  blue.wavelength_nm = 450;
  if (light.wavelength_nm > blue.wavelength_nm) add("450 nm, same brightness", blue);
  return choices;
}

std::string light_advice(const std::vector<LightChoice>& choices) {
  const LightChoice& now = choices.front();
  const optics::NoiseLimit limit = optics::limit_of(now.light, now.noise);
  std::string advice = std::string(sentence_of(limit)) + ".";
  const auto least = [](const LightChoice& a, const LightChoice& b) { return worst_mm(a) < worst_mm(b); };
  const LightChoice& best = *std::min_element(choices.begin(), choices.end(), least);
  if (worst_mm(best) < 0.9 * worst_mm(now))
    advice += " Of these changes most is gained by: " + best.what + " (" + text("%.3f", worst_mm(now)) +
              text(" to %.3f mm).", worst_mm(best));
  else
    advice += " None of these changes gains a tenth.";
  return advice;
}

Result<MeasuredLight> read_measured_light(const LightQuestion& question) {
  MeasuredLight measured;
  if (!question.sensor.empty()) {
    BITELINE_ASSIGN(const geometry::SensorModel sensor, config::read_sensor_yaml(question.sensor));
    measured.calibrated = sensor.speckle_contrast;
  }
  if (!question.report.empty()) {
    BITELINE_ASSIGN(const nlohmann::ordered_json report, batch::read_json_object(question.report));
    const nlohmann::ordered_json::json_pointer place{"/scan/speckle_contrast"};
    if (report.contains(place)) {
      BITELINE_ASSIGN(const nlohmann::ordered_json* scan,
                      batch::JsonFields(report, question.report).object("scan"));
      BITELINE_ASSIGN(const nlohmann::ordered_json* contrast,
                      batch::JsonFields(*scan, question.report).object("speckle_contrast"));
      BITELINE_ASSIGN(measured.scanned, batch::JsonFields(*contrast, question.report).number("median"));
    }
  }
  return measured;
}

std::string measured_words(const MeasuredLight& measured, const optics::StripeNoise& forecast) {
  std::string words;
  if (measured.calibrated) words = beside("calibrated", *measured.calibrated, forecast.contrast_at_rest);
  if (measured.scanned)
    words += (words.empty() ? "" : "\n") + beside("scanned", *measured.scanned, forecast.contrast);
  return words;
}

void add_light_options(options::Command& command, LightQuestion& question) {
  optics::ScanLight& light = question.light;
  options::Option* asked = command.add_flag(
      "--light", question.asked,
      "Say instead what noise a head of these measures has, what limits it, and what another "
      "lens, speed or laser would give");
  struct Measure {
    const char *name, *help, *unit;
    double* value;
    NumberRange interval;
  };
  for (const Measure& measure : std::initializer_list<Measure>{
           {"--f-number", "Of the lens", "", &light.f_number, {.minimum = 1, .maximum = 32}},
           {"--focal-mm", "Of the lens", "mm", &light.focal_mm, {.minimum = 1, .maximum = 200}},
           {"--distance-mm",
            "From the lens to the stripe",
            "mm",
            &light.distance_mm,
            {.minimum = 20, .maximum = 5000}},
           {"--pixel-um", "The pixels' pitch", "um", &light.pixel_um, {.minimum = 0.5, .maximum = 30}},
           {"--wavelength-nm", "Of the laser", "nm", &light.wavelength_nm, {.minimum = 400, .maximum = 900}},
           {"--stripe-mm",
            "The sheet's thickness, full width at half height",
            "mm",
            &light.stripe_mm,
            {.minimum = 0.01, .maximum = 5}},
           {"--range-mm",
            "Heights that are to be seen",
            "mm",
            &light.range_mm,
            {.minimum = 0, .maximum = 1000}},
           {"--exposure-us", "Of one picture", "us", &light.exposure_us, {.minimum = 1, .maximum = 1e6}},
           {"--speed-mm-s",
            "Of the surface across the stripe",
            "mm/s",
            &light.speed_mm_s,
            {.minimum = 0, .maximum = 5000}},
           {"--grey", "Of the stripe's middle", "", &light.grey, {.minimum = 1, .maximum = 255}},
           {"--laser-mw",
            "All of the line's power",
            "mW",
            &light.laser_mw,
            {.minimum = 0.01, .maximum = 500}},
       }) {
    command.add_option(measure.name, *measure.value, measure.help)
        ->check(options::number(measure.interval, measure.unit))
        ->capture_default_str()
        ->needs(asked);
  }
  command
      .add_option("--sensor", question.sensor,
                  "A sensor.yaml: the contrast that it was calibrated with beside the forecast")
      ->check(options::existing_file())
      ->needs(asked);
  command.add_option("--report", question.report, "A scan's report.json: its contrast beside the forecast")
      ->check(options::existing_file())
      ->needs(asked);
}

void print_light(const std::vector<LightChoice>& choices, const MeasuredLight& measured) {
  std::printf("%-36s %9s %8s %9s %9s %9s %6s\n", "", "exposure", "contrast", "noise", "at ends", "Dorsch's",
              "class");
  std::printf("%-36s %9s %8s %9s %9s %9s %6s\n", "one column of a matt surface", "us", "", "mm", "mm",
              "limit, mm", "about");
  for (const LightChoice& choice : choices) {
    const optics::StripeNoise& noise = choice.noise;
    std::printf("%-36s %9.0f %8.2f %9.4f %9.4f %9.4f %6s\n", choice.what.c_str(), choice.light.exposure_us,
                noise.contrast, noise.middle_mm, noise.end_mm, noise.dorsch_mm,
                optics::name_of(judged(choice.light).laser_class));
  }
  const LightChoice& now = choices.front();
  std::printf(
      "\nas it is: stripe %.1f px (standard deviation), speckle %.4f mm, camera %.4f mm, pixels %.4f mm; "
      "%.3f mm of motion within the exposure\n",
      now.noise.stripe_px, now.noise.speckle_mm, now.noise.camera_mm, now.noise.pixel_mm, now.noise.moved_mm);
  std::printf("%s\n", light_advice(choices).c_str());
  if (const std::string words = measured_words(measured, now.noise); !words.empty())
    std::printf("%s\n", words.c_str());
  std::printf(
      "The class is a judgement for continuous light (biteline laser-class says more); what counts is the "
      "maker's.\n");
}

nlohmann::ordered_json light_json(const std::vector<LightChoice>& choices, const MeasuredLight& measured) {
  auto rows = nlohmann::ordered_json::array();
  for (const LightChoice& choice : choices) {
    const optics::StripeNoise& noise = choice.noise;
    rows.push_back({{"what", choice.what},
                    {"f_number", choice.light.f_number},
                    {"wavelength_nm", choice.light.wavelength_nm},
                    {"exposure_us", choice.light.exposure_us},
                    {"speed_mm_s", choice.light.speed_mm_s},
                    {"laser_mw", choice.light.laser_mw},
                    {"stripe_mm", choice.light.stripe_mm},
                    {"contrast", noise.contrast},
                    {"contrast_at_rest", noise.contrast_at_rest},
                    {"moved_mm", noise.moved_mm},
                    {"stripe_px", noise.stripe_px},
                    {"speckle_mm", noise.speckle_mm},
                    {"camera_mm", noise.camera_mm},
                    {"pixel_mm", noise.pixel_mm},
                    {"noise_mm", noise.middle_mm},
                    {"noise_at_ends_mm", noise.end_mm},
                    {"dorsch_limit_mm", noise.dorsch_mm},
                    {"eye_mw", judged(choice.light).eye_mw},
                    {"laser_class_about", optics::name_of(judged(choice.light).laser_class)},
                    {"limit", name_of(optics::limit_of(choice.light, noise))}});
  }
  nlohmann::ordered_json json{{"choices", rows}, {"advice", light_advice(choices)}};
  if (measured.calibrated) json["measured"]["calibrated"] = *measured.calibrated;
  if (measured.scanned) json["measured"]["scanned"] = *measured.scanned;
  if (json.contains("measured")) json["measured"]["words"] = measured_words(measured, choices.front().noise);
  return json;
}

}  // namespace biteline::app

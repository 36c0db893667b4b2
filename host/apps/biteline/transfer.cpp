// SPDX-License-Identifier: MIT
// biteline transfer: the sample's line on the next upper of its model.
#include <cstdio>
#include <map>

#include "common/options/command.hpp"
#include "host/apps/biteline/cloud_option.hpp"
#include "host/apps/biteline/command.hpp"
#include "host/records/results/line_result.hpp"
#include "host/records/results/transfer_result.hpp"
#include "host/report/json_text.hpp"
#include "host/report/report.hpp"
#include "host/transfer/grading.hpp"
#include "host/transfer/identify.hpp"
#include "host/transfer/transfer.hpp"

namespace biteline::app {
namespace {

struct TransferOptions {
  std::string sample;  ///< folder, or a model's name; empty: find the model
  std::string second;  ///< the same of another size; empty: none
  std::filesystem::path upper, out, library{transfer::Library::default_folder()};
  cloud::Reading reading;
  transfer::TransferOptions transfer;
};

nlohmann::ordered_json json_of(const transfer::Identification& found) {
  nlohmann::ordered_json json{{"name", found.name}, {"matches", nlohmann::ordered_json::array()}};
  for (const transfer::Match& match : found.matches) {
    json["matches"].push_back({{"name", match.name},
                               {"model", match.model},
                               {"foot", match.foot},
                               {"size", match.size},
                               {"mirrored", match.align.mirror},
                               {"graded", match.align.grade},
                               {"probability", match.probability},
                               {"compared", match.compared},
                               {"fits", match.alignment.accepted()},
                               {"shape_rms_mm", match.alignment.shape_rms_mm},
                               {"reason", match.alignment.reason}});
  }
  for (const transfer::ModelInfo& model : found.damaged) {
    json["damaged"].push_back({{"name", model.name}, {"why", to_line(*model.damage)}});
  }
  return json;
}

/// The sample that was named, or the model that the upper is found to be.
Result<transfer::Transfer> carry_over(TransferOptions options, const cloud::PointCloud& upper,
                                      report::Report& report) {
  const transfer::Library library{options.library};
  std::string sample_name = options.sample;
  if (sample_name.empty()) {
    BITELINE_ASSIGN(const transfer::Identification found,
                    report.timed("identify", [&] { return transfer::identify(library, upper); }));
    report.fields["identified"] = json_of(found);
    if (found.refusal) return transfer::Transfer{.refusal = found.refusal};
    sample_name = found.name;
    options.transfer.align = found.matches.front().align;
  }
  report.fields["sample"] = sample_name;
  BITELINE_ASSIGN(const transfer::SampleFiles sample,
                  report.timed("read_sample", [&] { return transfer::find_sample(sample_name, library); }));
  if (options.second.empty())
    return report.timed("transfer", [&] { return transfer::transfer_line(sample, upper, options.transfer); });
  report.fields["second"] = options.second;
  BITELINE_ASSIGN(const transfer::SampleFiles second, report.timed("read_second", [&] {
    return transfer::find_sample(options.second, library);
  }));
  const transfer::ReadySample one{sample}, other{second};
  return report.timed("transfer", [&] {
    return transfer::transfer_by_two({&one, &other}, upper, options.transfer);
  });
}

/// An upper that is to be read otherwise: report.json alone.
Result<ExitStatus> refuse(const TransferOptions& options, report::ToldRefusal refusal,
                          const cloud::CloudFile& upper, report::Report& report,
                          const GlobalOptions& global) {
  const std::string words = "biteline: refused: " + refusal.reason + " (read: " + upper.understood + ")";
  report.refuse(std::move(refusal));
  BITELINE_TRY(report.write(options.out));
  return tell(report, global, words);
}

Result<ExitStatus> transfer(const TransferOptions& options, const GlobalOptions& global) {
  report::Report report;
  BITELINE_TRY(results::prepare_result_folder(options.out));
  BITELINE_ASSIGN(const cloud::CloudFile upper, report.timed("read", [&] {
    return cloud::read_cloud_file(options.upper, options.reading);
  }));
  report.fields["upper"] = options.upper.filename().string();
  report.fields["cloud_file"] = as_json(upper, options.reading);
  if (const auto refusal = cloud::unit_refusal(upper))
    return refuse(options, report::told(*refusal), upper, report, global);
  BITELINE_ASSIGN(const transfer::Transfer result, carry_over(options, upper.cloud, report));
  BITELINE_TRY(results::write_transfer_result(options.out, upper.cloud, result, report));
  if (result.found && !upper.origin.isZero()) {
    cloud::ClosedLine line = result.carried.line;
    for (cloud::LinePoint& point : line.points) point.position += upper.origin;
    BITELINE_TRY(cloud::write_line(options.out / "line.csv", line));
  }
  const std::string summary = results::summary(result);
  return tell_folder(report, global,
                     result.found ? "read: " + upper.understood + "\n" + summary
                                  : summary + " (read: " + upper.understood + ")",
                     options.out, result.told(), plan_step(options.out));
}

}  // namespace

void add_transfer(options::Command& app, Context& context) {
  auto options = std::make_shared<TransferOptions>();
  options::Command* command =
      app.add_subcommand("transfer", "Carry a sample's bite line over to the next upper of its model");
  auto* const sample =
      command->add_option("--sample", options->sample,
                          "Folder of a finished sample, or a saved model's name; left out: find the model");
  command->add_option("--upper", options->upper, std::string{"The upper's cloud: "} + k_cloud_kinds)
      ->required();
  add_reading_options(*command, options->reading);
  command->add_option("--out", options->out, "Folder for line.csv, report.json, stages/")->required();
  command->add_option("--library", options->library, "Folder of the saved models")->capture_default_str();
  command
      ->add_option(
          "--second", options->second,
          "Another sample of the model, of another size and the same foot: the two teach how its factory "
          "grades, and the nearer one carries the line")
      ->needs(sample);
  command->add_flag("--mirror", options->transfer.align.mirror, "The sample is of the other foot")
      ->needs(sample);
  command
      ->add_flag("--grade", options->transfer.align.grade,
                 "The sample is of another size: grade by length, width and height")
      ->needs(sample);
  const std::map<std::string, transfer::RayDirection> directions{{"level", transfer::RayDirection::Level},
                                                                 {"normal", transfer::RayDirection::Normal}};
  command
      ->add_choice("--rays", options->transfer.direction, directions,
                   "Rays from the sample's line: level, or along its normals")
      ->type_name("level|normal");
  command
      ->add_option("--max-gap", options->transfer.max_gap_mm,
                   "Longest gap in the upper's scan that is bridged, mm")
      ->check(options::number({.minimum = 0, .maximum = 100}, "mm"))
      ->capture_default_str();
  command->callback([options, &context] {
    context.run = [options, &context] { return transfer(*options, context.options); };
  });
}

}  // namespace biteline::app

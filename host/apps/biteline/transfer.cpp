// SPDX-License-Identifier: MIT
// biteline transfer: the sample's line on the next upper of its model.
#include <cstdio>
#include <map>

#include "host/apps/biteline/command.hpp"
#include "host/cloud/ply.hpp"
#include "host/models/identify.hpp"
#include "host/models/transfer.hpp"
#include "host/report/report.hpp"

namespace biteline::app {
namespace {

struct Options {
  std::string sample;  ///< folder, or a model's name; empty: find the model
  std::filesystem::path upper, out, library{models::Library::default_folder()};
  models::TransferOptions transfer;
};

nlohmann::ordered_json rows_of(const Eigen::Matrix4d& T) {
  nlohmann::ordered_json rows = nlohmann::ordered_json::array();
  for (int i = 0; i < 4; ++i) rows.push_back({T(i, 0), T(i, 1), T(i, 2), T(i, 3)});
  return rows;
}

nlohmann::ordered_json json_of(const registration::Alignment& alignment) {
  const registration::Grade& grade = alignment.placement.grade;
  nlohmann::ordered_json information = nlohmann::ordered_json::array();
  for (Eigen::Index row = 0; row < alignment.information.rows(); ++row) {
    nlohmann::ordered_json values = nlohmann::ordered_json::array();
    for (Eigen::Index column = 0; column < alignment.information.cols(); ++column) values.push_back(alignment.information(row, column));
    information.push_back(values);
  }
  return {{"converged", alignment.converged},
          {"iterations", alignment.iterations},
          {"T_upper_sample", rows_of(alignment.T_upper_sample.matrix())},
          {"T_upper_shoe", rows_of(alignment.placement.T_target_source.matrix())},
          {"mirrored", alignment.mirrored},
          {"grade", {{"length", grade.length}, {"width", grade.width}, {"section", grade.section}, {"offset_mm", grade.offset_mm}}},
          {"overlap_share", alignment.overlap_ratio},
          {"upper_overlap_share", alignment.upper_overlap_ratio},
          {"residual_rms_mm", alignment.residual_rms_mm},
          {"shape_rms_mm", alignment.shape_rms_mm},
          {"rim_used", alignment.rim_used},
          {"rim_mm", alignment.rim_mm},
          {"line_sigma_mm", alignment.line_sigma_mm},
          {"weakest_direction", {{"words", alignment.weakest.words}, {"sigma_mm", alignment.weakest.sigma_mm}}},
          {"runner_up_ratio", alignment.runner_up_ratio},
          {"information", information}};
}

nlohmann::ordered_json json_of(const models::Identification& found) {
  nlohmann::ordered_json json{{"name", found.name}, {"matches", nlohmann::ordered_json::array()}};
  for (const models::Match& match : found.matches) {
    json["matches"].push_back({{"name", match.name},
                               {"probability", match.probability},
                               {"fits", match.alignment.accepted()},
                               {"shape_rms_mm", match.alignment.shape_rms_mm},
                               {"reason", match.alignment.reason}});
  }
  for (const models::ModelInfo& model : found.damaged) {
    json["damaged"].push_back({{"name", model.name}, {"why", to_line(*model.damage)}});
  }
  return json;
}

void fill(const models::Transfer& transfer, report::Report& report) {
  report.fields["alignment"] = json_of(transfer.alignment);
  report.fields["confidence"] = transfer.confidence;
  report.fields["bound_mm"] = transfer.bound_mm;
  report.fields["surface"] = transfer.from_mesh ? "mesh" : "points";
  for (const models::Stage& stage : transfer.stages) report.fields["transfer_s"][stage.name] = stage.seconds;
  if (!transfer.found) return report.refuse(transfer.reason);
  const surface::CarriedLine& carried = transfer.carried;
  const line::ClosedLine& line = carried.line;
  report.fields["length_mm"] = line::length_mm(line);
  report.fields["closure_mm"] = (line.points.front().position - line.points.back().position).norm();
  report.fields["line_points"] = line.points.size();
  report.fields["rays"] = carried.rays;
  report.fields["hits"] = carried.hits;
  report.fields["bridged_mm"] = carried.bridged_mm;
  report.fields["longest_gap_mm"] = carried.longest_gap_mm;
  report.fields["mean_ray_mm"] = carried.mean_distance_mm;
  report.fields["candidates"] = nlohmann::ordered_json::array({{{"confidence", transfer.confidence}, {"length_mm", line::length_mm(line)}}});
  std::vector<std::size_t> bridged;
  for (std::size_t i = 0; i < carried.bridged.size(); ++i) {
    if (carried.bridged[i]) bridged.push_back(i);
  }
  report.fields["bridged_points"] = bridged;
}

Result<ExitStatus> finish(const Options& options, report::Report& report) {
  BITELINE_TRY(report.write(options.out));
  return report.refused() ? ExitStatus::Refused : ExitStatus::Done;
}

/// A folder with that name, else a model of the library.
Result<models::SampleFiles> read_sample(const std::string& sample, const models::Library& library) {
  if (std::filesystem::is_directory(sample)) return models::read_sample(sample);
  if (sample.find('/') != std::string::npos) return fail(Errc::FileNotFound, "%s: expected the folder of a finished sample", sample.c_str());
  return library.load(sample);
}

void say(const models::Transfer& transfer, const report::Report& report, const GlobalOptions& global) {
  if (global.json) std::printf("%s\n", report.fields.dump(2).c_str());
  if (global.quiet || global.json) return;
  if (report.refused()) {
    std::fprintf(stderr, "refused: %s\n", report.reason().c_str());
  } else {
    std::printf("line carried over: %.1f mm long, %zu points, surfaces alike to %.2f mm RMS over %.0f %%, line within %.2f mm\n",
                line::length_mm(transfer.carried.line), transfer.carried.line.points.size(), transfer.alignment.shape_rms_mm,
                100 * transfer.alignment.overlap_ratio, transfer.bound_mm);
  }
}

/// A cloud without a shoe in it is readable input without a result: told in the report.  Any other failure goes on.
Result<ExitStatus> refuse(const Error& error, const Options& options, const GlobalOptions& global, report::Report& report) {
  if (error.code != Errc::Refused) return tl::unexpected<Error>(error);
  report.refuse(std::string{error.where.view()});
  say({}, report, global);
  return finish(options, report);
}

Result<ExitStatus> transfer(const Options& options, const GlobalOptions& global) {
  report::Report report;
  const models::Library library{options.library};
  BITELINE_TRY(report::prepare_folder(options.out));
  std::error_code ignored;
  std::filesystem::remove(options.out / "line.csv", ignored);  // a refusal must not leave an earlier run's line

  BITELINE_ASSIGN(const cloud::PointCloud upper, report.timed("read", [&] { return cloud::read_cloud(options.upper); }));
  report.fields["upper"] = options.upper.filename().string();
  report.fields["points"] = upper.size();
  std::string sample_name = options.sample;
  if (sample_name.empty()) {
    const Result<models::Identification> found = report.timed("identify", [&] { return models::identify(library, upper, options.transfer.align); });
    if (!found) return refuse(found.error(), options, global, report);
    report.fields["identified"] = json_of(*found);
    if (found->name.empty()) {
      report.refuse(found->reason);
      say({}, report, global);
      return finish(options, report);
    }
    sample_name = found->name;
  }
  report.fields["sample"] = sample_name;
  BITELINE_ASSIGN(const models::SampleFiles sample, report.timed("read_sample", [&] { return read_sample(sample_name, library); }));
  const Result<models::Transfer> result = report.timed("transfer", [&] { return models::transfer_line(sample, upper, options.transfer); });
  if (!result) return refuse(result.error(), options, global, report);
  fill(*result, report);
  if (result->found) {
    BITELINE_TRY(report.timed("write", [&] { return line::write_line(options.out / "line.csv", result->carried.line); }));
  }
  report.stop_clock();
  say(*result, report, global);
  return finish(options, report);
}

}  // namespace

void add_transfer(CLI::App& app, Context& context) {
  auto options = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand("transfer", "Carry a sample's bite line over to the next upper of its model");
  command->add_option("--sample", options->sample, "Folder of a finished sample, or a saved model's name; left out: find the model");
  command->add_option("--upper", options->upper, "The upper's cloud: PLY, mm")->required();
  command->add_option("--out", options->out, "Folder for line.csv, report.json")->required();
  command->add_option("--library", options->library, "Folder of the saved models")->capture_default_str();
  command->add_flag("--mirror", options->transfer.align.mirror, "The sample is of the other foot");
  command->add_flag("--grade", options->transfer.align.grade, "The sample is of another size: grade by length, width and height");
  const std::map<std::string, surface::RayDirection> directions{{"level", surface::RayDirection::Level}, {"normal", surface::RayDirection::Normal}};
  command->add_option("--rays", options->transfer.direction, "level, or along the normals: normal")->transform(CLI::CheckedTransformer(directions));
  command->add_option("--max-gap", options->transfer.max_gap_mm, "Longest gap in the upper's scan that is bridged, mm")->check(CLI::Range(0.0, 100.0))->capture_default_str();
  command->callback([options, &context] { context.run = [options, &context] { return transfer(*options, context.options); }; });
}

}  // namespace biteline::app

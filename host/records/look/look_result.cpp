// SPDX-License-Identifier: MIT
#include "host/records/look/look_result.hpp"

#include <cmath>

#include "common/core/fixed_text.hpp"
#include "host/records/look/look_files.hpp"

namespace biteline::look {
namespace {

using second_look::Settle;

/// A gap that ends where the path does is by chance the shorter one.
constexpr double k_ran_out_mm = 10, k_at_end_mm = 3;

/// What is missing up to the path's end, with nothing behind it: an empty gun's, and a tool's that fell off.
std::optional<double> ran_out_from(const second_look::Findings& findings, std::optional<double> end_mm) {
  if (!end_mm) return std::nullopt;
  for (const second_look::Fault& fault : findings.faults) {
    if (fault.kind != second_look::FaultKind::Missing) continue;
    const auto way_mm = [&](double from, double to) {
      return std::fmod(to - from + findings.line_mm, findings.line_mm);
    };
    const double beyond_mm = std::remainder(fault.along.to_mm - *end_mm, findings.line_mm);
    if (std::abs(beyond_mm) <= k_at_end_mm && way_mm(fault.along.from_mm, fault.along.to_mm) >= k_ran_out_mm)
      return fault.along.from_mm;
  }
  return std::nullopt;
}

Judged judge(const second_look::Findings& findings, const LookOf& of) {
  const bool reworked = of.reworks > 0;
  if (findings.refusal) return {.status = ExitStatus::Refused, .told = report::told(*findings.refusal)};
  const auto settle = [](Settle code, std::string reason) {
    return Judged{.status = ExitStatus::Review,
                  .told = report::told(report::Refusal<Settle>{.code = code, .reason = std::move(reason)})};
  };
  if (const auto from_mm = ran_out_from(findings, of.path_end_mm))
    return settle(
        Settle::WorkRanOut,
        FixedText<120>::format("nothing was left from %.0f mm to the path's end: the gun may be empty "
                               "or clogged",
                               *from_mm)
            .c_str());
  if (!findings.faults.empty())
    return settle(reworked ? Settle::StillFaulty : Settle::WorkFaulty,
                  FixedText<160>::format("%zu faults along %.0f mm of work%s", findings.faults.size(),
                                         findings.planned_mm,
                                         reworked ? ", after it was worked once more: a person decides" : "")
                      .c_str());
  if (findings.unclear_mm > 0)
    return settle(
        Settle::WorkUnsure,
        FixedText<120>::format("of %.0f mm nobody can tell whether they are worked", findings.unclear_mm)
            .c_str());
  return {};
}

}  // namespace

Result<Judged> write_look_result(const std::filesystem::path& folder, const second_look::Findings& findings,
                                 const second_look::PlannedBand& plan, const LookOf& of,
                                 report::Report& report) {
  report.fields["first"] = of.first;
  report.fields["second"] = of.second;
  report.fields["line_sha256"] = of.line_sha256;
  report.fields["process_sha256"] = of.process_sha256;
  report.fields["foot"] = of.foot;
  report.fields["reworks"] = of.reworks;
  report.fields["work"] = as_json(findings, plan);
  if (!findings.places.empty()) {
    BITELINE_TRY(report::write_file_atomically(folder / "band.csv", band_table(findings)));
    BITELINE_TRY(report::write_file_atomically(folder / "band.svg", band_picture(findings, plan)));
  }
  Judged judged = judge(findings, of);
  if (judged.status == ExitStatus::Refused) report.refuse(judged.told);
  if (judged.status == ExitStatus::Review) report.review(judged.told);
  return judged;
}

std::string summary(const second_look::Findings& findings) {
  if (findings.refusal) return "refused: " + findings.refusal->reason;
  std::string words =
      FixedText<160>::format("worked: %.0f mm of %.0f mm", findings.worked_mm, findings.planned_mm).c_str();
  if (findings.unclear_mm > 0)
    words += FixedText<80>::format("; of %.0f mm nobody can tell", findings.unclear_mm).view();
  for (const second_look::Fault& fault : findings.faults)
    words += FixedText<120>::format("\n%s from %.1f to %.1f mm, across %.1f to %.1f mm",
                                    second_look::name_of(fault.kind), fault.along.from_mm, fault.along.to_mm,
                                    fault.low_mm, fault.high_mm)
                 .view();
  return words;
}

}  // namespace biteline::look

// SPDX-License-Identifier: MIT
// Mending a scan's line.
#include <algorithm>
#include <array>
#include <cmath>

#include "common/core/text_bounds.hpp"
#include "host/interfaces/api/api.hpp"
#include "host/interfaces/api/json_fields.hpp"
#include "host/records/evidence/evidence.hpp"
#include "host/records/results/mended_result.hpp"

namespace biteline::api {
namespace {

using control::Answer;
using Kind = edit::Step::Kind;

constexpr std::size_t k_most_steps = 200;
constexpr std::size_t k_most_points = 1000;
constexpr double k_most_mm = 1e5;

/// A step's number; a fault where it is none or beyond its range.
double number_of(const Json& step, const char* name, double least, double most, bool& good) {
  const auto found = step.find(name);
  const bool is = found != step.end() && found->is_number() && std::isfinite(found->get<double>()) &&
                  found->get<double>() >= least && found->get<double>() <= most;
  good = good && is;
  return is ? found->get<double>() : 0;
}

bool has_only(const Json& step, std::initializer_list<const char*> names) {
  return std::ranges::all_of(step.items(), [&](const auto& item) {
    return item.key() == "step" || std::ranges::find(names, item.key()) != names.end();
  });
}

std::optional<std::vector<Vec3>> points_of(const Json& step) {
  const auto found = step.find("points");
  if (found == step.end() || !found->is_array() || found->empty() || found->size() > k_most_points)
    return std::nullopt;
  std::vector<Vec3> points;
  for (const Json& point : *found) {
    if (!point.is_array() || point.size() != 3) return std::nullopt;
    Vec3 place;
    for (int axis = 0; axis < 3; ++axis) {
      const Json& value = point[static_cast<std::size_t>(axis)];
      if (!value.is_number() || !(std::abs(value.get<double>()) <= k_most_mm)) return std::nullopt;
      place[axis] = value.get<double>();
    }
    points.push_back(place);
  }
  return points;
}

edit::Stretch stretch_of(const Json& json, bool& good) {
  return {.from_mm = number_of(json, "from_mm", 0, k_most_mm, good),
          .to_mm = number_of(json, "to_mm", 0, k_most_mm, good)};
}

/// Nothing where it is no `Mend` step of the API.
std::optional<edit::Step> step_of(const Json& json) {
  if (!json.is_object() || !json.contains("step") || !json["step"].is_string()) return std::nullopt;
  const auto kind = json["step"].get<std::string>();
  edit::Step step;
  bool good = true;
  if (kind == "candidate") {
    step.kind = Kind::Candidate;
    step.candidate = static_cast<int>(number_of(json, "candidate", 1, 99, good));
    const bool part = json.contains("from_mm") || json.contains("to_mm");
    if (part) step.stretch = stretch_of(json, good);
    good = good && has_only(json, {"candidate", "from_mm", "to_mm"});
  } else if (kind == "back_to") {
    step.kind = Kind::BackTo;
    step.line_version = static_cast<int>(number_of(json, "line_version", 0, 1e6, good));
    good = good && has_only(json, {"line_version"});
  } else if (kind == "through" || kind == "cut") {
    step.kind = kind == "cut" ? Kind::Cut : Kind::Through;
    step.stretch = stretch_of(json, good);
    if (step.kind == Kind::Through) {
      std::optional<std::vector<Vec3>> points = points_of(json);
      good = good && points && has_only(json, {"from_mm", "to_mm", "points"});
      if (points) step.points = std::move(*points);
    } else {
      good = good && has_only(json, {"from_mm", "to_mm"});
    }
  } else {
    return std::nullopt;
  }
  return good ? std::optional{step} : std::nullopt;
}

/// What the row says of a line changes with it.
void take_mended(const results::MendedScan& mended, report::Report& report, memory::Scan& row) {
  row.line_version = mended.version;
  row.length_mm = cloud::length_mm(mended.line);
  row.confidence = mended.confidence;
  row.weak_stretches = static_cast<int>(report.fields["weak_stretches"].size());
  row.u95_mm.reset();
  for (const cloud::LinePoint& point : mended.line.points) {
    if (point.u95_mm) row.u95_mm = std::max(row.u95_mm.value_or(0), *point.u95_mm);
  }
  // A hand's line is looked at again, whatever it says of itself.
  row.verdict = mended.status == ExitStatus::Refused  ? "refused"
                : mended.status == ExitStatus::Review ? "review"
                                                      : "amber";
  const Json told = Json::parse(report.text(), nullptr, false);
  row.reason_code = told.value("reason_code", "");
  row.reason = told.value("reason", "");
  row.next_step = told.value("next_step", "");
}

/// Why a scan of this row is not mended; nothing: it may be.
std::optional<Answer> not_to_mend(const std::string& id, const Result<std::optional<memory::Scan>>& row) {
  if (!row) return answer_of(row.error());
  if (!*row) return control::refusal(404, "not_found", id + ": no such scan; GET /scans lists them");
  if ((*row)->decision == "accepted" || (*row)->sent)
    return control::refusal(409, "wrong_state", id + " was accepted; its line stays as it was sent");
  return std::nullopt;
}

/// Ends a mend whatever becomes of it, also by an exception of a library: else nobody could mend again.
class Mending {
 public:
  Mending(Cell& cell, const std::string& scan, Speaker who)
      : cell_{cell}, scan_{scan}, who_{std::move(who)} {}
  ~Mending() { cell_.end_mend(scan_, mended_, who_); }
  Mending(const Mending&) = delete;
  Mending& operator=(const Mending&) = delete;
  void done() { mended_ = true; }

 private:
  Cell& cell_;
  const std::string& scan_;
  Speaker who_;
  bool mended_{false};
};

}  // namespace

Answer Api::mend_scan(const Call& call) {
  const std::string& id = call.names.front();
  Fields fields{call.request.body};
  results::MendOrder order{
      .steps = {}, .who = call.person.name, .why = fields.text("why", bounds::k_why, true)};
  const std::optional<double> version = fields.number("line_version", 0, 1e6);
  if (!version) fields.fault("line_version", "the version that was looked at expected; 0: as found");
  order.line_version = static_cast<int>(version.value_or(0));
  const Json steps = fields.list("steps", k_most_steps);
  if (steps.empty()) fields.fault("steps", "1 to 200 steps expected");
  for (std::size_t i = 0; i < steps.size(); ++i) {
    if (const std::optional<edit::Step> step = step_of(steps[i])) {
      order.steps.push_back(*step);
    } else {
      fields.fault("steps[" + std::to_string(i) + "]",
                   "candidate, through, cut or back_to with its fields expected");
    }
  }
  if (const std::optional<Answer> faults = fields.faults()) return *faults;
  if (!is_scan_id(id)) return control::refusal(404, "not_found", "no such scan; GET /scans lists them");
  // From here to its end no word changes the row.
  if (const Result<void> begun = rooms_.cell.begin_mend(id); !begun) return answer_of(begun.error());
  Mending mending{rooms_.cell, id, speaker(call)};
  Result<std::optional<memory::Scan>> row = rooms_.memory.scan(id);
  if (const std::optional<Answer> refused = not_to_mend(id, row)) return *refused;
  // What another program wrote would come out of a mend as if the service had.
  const Result<std::optional<memory::Evidence>> written = rooms_.memory.evidence(id);
  if (!written) return answer_of(written.error());
  if (*written) {
    const Result<memory::Evidence> now = evidence::of_folder(rooms_.results / id);
    if (!now) return answer_of(now.error());
    const auto changed = evidence::change(**written, *now);
    if (changed && !evidence::mended_since(rooms_.results / id, **written, *now, (*row)->line_version))
      return control::refusal(409, "wrong_state", id + ": " + *changed);
  }

  report::Report report;
  Result<edit::OrRefusal<results::MendedScan>> mended =
      results::mend_scan(rooms_.results / id, order, report);
  const bool done = mended && *mended;
  if (done) {
    mending.done();
    take_mended(**mended, report, **row);
    const Result<void> put = rooms_.memory.put_scan(**row, {.id = 0,
                                                            .time = memory::now_ms(),
                                                            .who = call.person.name,
                                                            .door = call.request.door,
                                                            .action = "mend",
                                                            .subject = id,
                                                            .before = std::to_string(*order.line_version),
                                                            .after = order.why});
    if (!put) return unlogged("the line of " + id + " is mended", put.error());
    if (Result<memory::Evidence> now = evidence::of_folder(rooms_.results / id); now && *written) {
      if (const auto kept = rooms_.memory.put_evidence(id, *now); !kept)
        return unlogged("the line of " + id + " is mended", kept.error());
    }
    if (rooms_.publish) rooms_.publish("scan", to_json(**row));
    static_cast<void>(teach_.look());
    return ok(to_json(**row));
  }
  if (!mended) return answer_of(mended.error());
  const report::ToldRefusal told = report::told(mended->error());
  return control::refusal(422, "check_failed", told.reason + "; " + told.next_step);
}

}  // namespace biteline::api

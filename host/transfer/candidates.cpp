// SPDX-License-Identifier: MIT
#include "host/transfer/candidates.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "common/core/fixed_text.hpp"
#include "host/transfer/align/rough_fit.hpp"

namespace biteline::transfer {
namespace {

// So many are compared in the last round in any case: a search that has missed the right place costs nobody
// his model.
constexpr std::size_t k_nearest_compared = 3;

// Six sizes.  Laws are known to hold over a tenth (`bench_grading`), and a shoe of another model is found far
// away sooner than near.
constexpr double k_most_change = 0.15;

const SavedModel& model_of(const std::vector<SavedModel>& models, const std::string& name) {
  return *std::ranges::find(models, name, &SavedModel::name);
}

const ModelMade& made_of(const SavedModel& model, const std::string& sample) {
  return std::ranges::find(model.samples, sample, &SavedSample::name)->made;
}

/// Of the outline, which length and offset move together.
double length_change(const Grade& grade, double length_mm) {
  return grade.length - 1 + 2 * grade.offset_mm / length_mm;
}

std::string set_aside(double rough_mm, double most_mm) {
  if (!std::isfinite(rough_mm)) return "set aside: less than half of it lies on the upper";
  return FixedText<120>::format("set aside: half of its places lie %.1f mm off (at most %.1f mm)", rough_mm,
                                most_mm)
      .c_str();
}

/// The sample's line on the upper, in the sample's order of points.
cloud::ClosedLine placed_line(const cloud::ClosedLine& line, const SE3& T_shoe_base,
                              const Alignment& alignment) {
  cloud::ClosedLine out = line;
  for (cloud::LinePoint& point : out.points) {
    const Alignment::OnLine on_upper = alignment.placed(
        {.point = T_shoe_base * point.position, .normal = T_shoe_base.linear() * point.normal});
    point.position = on_upper.point;
    point.normal = on_upper.normal;
  }
  const std::size_t count = out.points.size();
  for (std::size_t i = 0; i < count; ++i)
    out.points[i].tangent =
        (out.points[(i + 1) % count].position - out.points[(i + count - 1) % count].position).normalized();
  return out;
}

}  // namespace

Candidates::Candidates(const Library& library, const std::vector<SavedModel>& models, const Upper& upper,
                       std::vector<ModelInfo>& damaged)
    : library_{library},
      models_{models},
      upper_{upper},
      damaged_{damaged},
      shapes_{library},
      target_{upper} {}

std::size_t Candidates::samples() const {
  std::size_t count = 0;
  for (const SavedModel& model : models_) count += model.samples.size();
  return count;
}

std::vector<Candidates::Candidate> Candidates::of(Round round) const {
  std::vector<Candidate> out;
  for (const SavedModel& model : models_) {
    for (const SavedSample& sample : model.samples) {
      const auto add = [&](bool mirror, bool grade) {
        Candidate candidate{.match = {.name = sample.name,
                                      .model = model.name,
                                      .foot = mirror ? other_foot(sample.made.foot) : sample.made.foot,
                                      .size = grade ? std::string{} : sample.made.size,
                                      .compared = false}};
        candidate.match.align.mirror = mirror;
        candidate.match.align.grade = grade;
        candidate.match.alignment.verdict = Verdict::OtherModel;
        out.push_back(std::move(candidate));
      };
      const bool has_foot = !other_foot(sample.made.foot).empty();
      const bool has_size = size_label(sample.made.size).has_value();
      if (round == Round::AsTaught) add(false, false);
      if (round == Round::OtherFoot && has_foot) add(true, false);
      if (round == Round::OtherSize && has_size) add(false, true);
      if (round == Round::OtherSize && has_size && has_foot) add(true, true);
    }
  }
  return out;
}

bool Candidates::is_last(Round round) const {
  for (const Round later : {Round::OtherFoot, Round::OtherSize})
    if (later > round && !of(later).empty()) return false;
  return true;
}

Result<void> Candidates::grade_by_model(Candidate& candidate) const {
  const SavedModel& model = model_of(models_, candidate.match.model);
  const ModelMade& made = made_of(model, candidate.match.name);
  const std::optional<SizeLabel> size = size_label(made.size);
  if (!size) return {};
  if (const std::optional<double> mm = mm_per_size(*size))
    candidate.scale = SizeScale{.of_sample = *size, .share_per_size = *mm / candidate.length_mm};
  const SavedSample* other = farthest_in_size(model, made.size);
  if (other == nullptr) return {};
  BITELINE_ASSIGN(const std::optional<TaughtGrading> taught,
                  shapes_.grading_of(candidate.match.name, other->name, of_both_feet(made, other->made)));
  if (!taught) return {};
  candidate.match.align.law = taught->law;
  candidate.scale = SizeScale{.of_sample = *size,
                              .share_per_size = length_change(taught->between, candidate.length_mm) /
                                                (size_label(other->made.size)->number - size->number)};
  return {};
}

Result<void> Candidates::take_rough_fit(Candidate& candidate) const {
  Match& match = candidate.match;
  BITELINE_ASSIGN(const RoughShape shape, shapes_.shape_of(match.name));
  candidate.length_mm = shape.length_mm;
  if (match.align.grade) BITELINE_TRY(grade_by_model(candidate));
  const RoughFit fit = rough_fit(match.align.mirror ? mirrored(shape) : shape, target_,
                                 match.align.grade ? &match.align.law : nullptr);
  match.rough_fit_mm = fit.off_mm;
  match.alignment.reason =
      set_aside(fit.off_mm, match.align.grade ? k_most_rough_graded_mm : k_most_rough_mm);
  candidate.length = fit.length;
  return {};
}

Result<void> Candidates::align(Candidate& candidate) const {
  Match& match = candidate.match;
  BITELINE_ASSIGN(const SampleFiles files, library_.load(match.name));
  BITELINE_ASSIGN(const Sample sample, prepare_sample(files.cloud, files.line));
  match.alignment = transfer::align(sample, upper_, match.align);
  match.compared = true;
  const double change = length_change(match.alignment.placement.grade, candidate.length_mm);
  if (match.align.grade && match.alignment.accepted() && std::abs(change) > k_most_change) {
    match.alignment.verdict = Verdict::OtherSize;
    match.alignment.reason =
        FixedText<120>::format("it would be graded by %.0f %% of its length (at most %.0f %%)", 100 * change,
                               100 * k_most_change)
            .c_str();
  }
  if (!match.alignment.accepted()) return {};
  match.line = placed_line(files.line, sample.T_base_shoe.inverse(), match.alignment);
  if (!match.align.grade || !candidate.scale) return {};
  if (const std::optional<SizeLabel> size = candidate.scale->at(change)) match.size = text_of(*size);
  return {};
}

template <class Work>
void Candidates::for_each(std::vector<Candidate>& candidates, Work work) {
  tbb::parallel_for(std::size_t{0}, candidates.size(), [&](std::size_t i) {
    if (Result<void> done = work(candidates[i]); !done) candidates[i].damage = done.error();
  });
  for (const Candidate& candidate : candidates) {
    const bool known = std::ranges::find(damaged_, candidate.match.name, &ModelInfo::name) != damaged_.end();
    if (candidate.damage && !known)
      damaged_.push_back({.name = candidate.match.name, .damage = candidate.damage});
  }
  std::erase_if(candidates, [](const Candidate& candidate) { return candidate.damage.has_value(); });
}

std::vector<Candidates::Candidate> Candidates::nearest_in_size(std::vector<Candidate> candidates) {
  std::vector<Candidate> nearest;
  for (Candidate& candidate : candidates) {
    const auto same = std::ranges::find_if(nearest, [&](const Candidate& other) {
      return other.match.model == candidate.match.model && other.match.foot == candidate.match.foot;
    });
    // One that does not lie on the upper tells no length.
    const auto away = [](const Candidate& c) {
      return std::pair{c.match.rough_fit_mm > k_most_rough_graded_mm, std::abs(std::log(c.length))};
    };
    if (same == nearest.end())
      nearest.push_back(std::move(candidate));
    else if (away(candidate) < away(*same))
      *same = std::move(candidate);
  }
  return nearest;
}

std::vector<Match> Candidates::compare(Round round) {
  std::vector<Candidate> all = of(round);
  for_each(all, [&](Candidate& candidate) { return take_rough_fit(candidate); });
  if (round == Round::OtherSize) all = nearest_in_size(std::move(all));
  const double most_mm = round == Round::OtherSize ? k_most_rough_graded_mm : k_most_rough_mm;
  std::ranges::stable_sort(all, {}, [](const Candidate& c) { return c.match.rough_fit_mm; });
  const std::size_t least = is_last(round) ? k_nearest_compared : 0;
  std::vector<Candidate> near, rest;
  for (Candidate& candidate : all) {
    // The nearest in any case: where one model's search missed, a wrong one must not stand alone.
    const bool compared = candidate.match.rough_fit_mm <= most_mm || near.size() < least;
    (compared ? near : rest).push_back(std::move(candidate));
  }
  for_each(near, [&](Candidate& candidate) { return align(candidate); });
  std::vector<Match> matches;
  for (std::vector<Candidate>* part : {&near, &rest})
    for (Candidate& candidate : *part) matches.push_back(std::move(candidate.match));
  return matches;
}

}  // namespace biteline::transfer

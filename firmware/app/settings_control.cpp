// SPDX-License-Identifier: MIT
#include "firmware/app/settings_control.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "firmware/app/live_head.hpp"

namespace biteline::sensor {
namespace {

using settings::Key;
using settings::SettingsSet;

bool is_peaks(Key key) {
  return std::string{settings::row_of(key).group} == "peaks";
}

/// Numbers go through floats and whole nanoseconds, a thousandth of an exposure's unit.
bool alike(const settings::Value& a, const settings::Value& b) {
  constexpr double k_rounding = 1e-3, k_rounding_ratio = 1e-6;
  return std::abs(a.number - b.number) <= std::max(k_rounding, k_rounding_ratio * std::abs(a.number)) &&
         a.on == b.on && a.word == b.word;
}

template <class Visit>
Result<void> for_each_key(Visit&& visit) {
  for (std::size_t i = 0; i < settings::k_key_count; ++i) BITELINE_TRY(visit(static_cast<Key>(i)));
  return {};
}

}  // namespace

SettingsControl::SettingsControl(SourceKind& kind, pipeline::ProfilePipeline::Config& pipeline, Told told)
    : kind_{kind}, pipeline_{pipeline}, told_{std::move(told)} {
  if (kind_.recording) return;
  asked_ = whole_of({.set = kind_.set.value_or(SettingsSet{}),
                     .whole = {},
                     .model = kind_.model,
                     .capture = kind_.capture,
                     .pipeline = pipeline_});
  refresh();
}

SettingsSet SettingsControl::whole_of(const Prepared& prepared) const {
  // With the trigger that keeps the asked rate: nothing is read back here.
  SettingsSet whole =
      set_in_use(live_settings(prepared.model, prepared.capture, hal::Trigger::Hardware, prepared.set).camera,
                 prepared.model, prepared.capture);
  put_into(whole, prepared.pipeline);
  whole.note = prepared.set.note;
  return whole;
}

Result<SettingsControl::Prepared> SettingsControl::prepare(const std::string& text) const {
  Prepared next;
  BITELINE_ASSIGN(next.set, settings::parse_settings(text, "settings"));
  BITELINE_ASSIGN(next.model, with_set(kind_.calibrated, next.set, kind_.head_file));
  next.capture = put_over(told_.capture, next.set);
  BITELINE_TRY(check(next.capture, next.model));
  BITELINE_ASSIGN(next.pipeline, pipeline_config(put_over(told_.peaks, next.set), std::nullopt));
  next.whole = whole_of(next);
  BITELINE_TRY(for_each_key([&](Key key) -> Result<void> {
    const auto &wanted = next.set.at(key), &comes = next.whole.at(key);
    if (!wanted || (comes && alike(*wanted, *comes))) return {};
    if (key == Key::TestPattern && !comes && !wanted->on) return {};
    return next.set.refuse(key, comes ? settings::value_text(key, *comes) + ", as the command line says,"
                                      : std::string{"none, as the command line says,"});
  }));
  return next;
}

Result<void> SettingsControl::use(const std::string& text) {
  BITELINE_ASSIGN(Prepared next, prepare(text));
  // First: nothing is made of a region that no camera has.
  BITELINE_TRY(kind_.learn_limits());
  if (kind_.limits_known)
    BITELINE_TRY(check_limits(live_settings(next.model, next.capture, hal::Trigger::Hardware, next.set),
                              kind_.limits));
  // As the next scan would: what it refuses is refused now.
  if (const auto made = pipeline::ProfilePipeline::create(next.pipeline, next.model); !made) {
    const std::string words{made.error().where.view()};
    return fail(made.error().code, "settings, region and peaks: %s", words.c_str());
  }
  BITELINE_TRY(kind_.adopt(next.model, next.capture, next.set));
  keep(std::move(next));
  return {};
}

Result<void> SettingsControl::check_changes(const Prepared& next, const Scanner& scanner) const {
  return for_each_key([&](Key key) -> Result<void> {
    const auto &before = asked_.at(key), &after = next.whole.at(key);
    if (before.has_value() == after.has_value() && (!before || before->same_as(*after))) return {};
    if (is_peaks(key)) return {};
    // The camera's own number, as the sensor tells it.
    if (const auto& taken = kind_.in_use.at(key); after && taken && alike(*after, *taken)) return {};
    const std::string none = key == Key::TestPattern ? "off" : "none";
    const std::string now = before ? settings::value_text(key, *before) : none;
    const bool at_once = key == Key::ExposureUs && !kind_.capture.auto_exposure && !kind_.capture.pairs();
    if (!at_once) {
      return fail(Errc::WrongState, "%s: it stays %s while a scan is on; stop the scan first",
                  settings::path_of(key).c_str(), now.c_str());
    }
    // The trigger's pulse lights the stripe for as long as the scan was begun with.
    const Scanner::Config& begun = scanner.config();
    const Nanoseconds longest = longest_exposure(begun.capture, begun.model);
    if (!scanner.has_trigger() || *next.model.exposure <= longest) return {};
    return fail(
        Errc::WrongState,
        "%s: at most %g us while this scan is on, as long as the trigger's pulse; stop the scan first",
        settings::path_of(key).c_str(), 1e-3 * static_cast<double>(longest.count()));
  });
}

Result<void> SettingsControl::offer(const std::string& text, Scanner& scanner) {
  BITELINE_ASSIGN(Prepared next, prepare(text));
  BITELINE_TRY(check_changes(next, scanner));
  BITELINE_TRY(
      check_limits(live_settings(next.model, next.capture, hal::Trigger::Hardware, next.set), kind_.limits));
  const auto &exposure = next.whole.at(Key::ExposureUs), &taken = kind_.in_use.at(Key::ExposureUs);
  const bool as_taken = exposure && taken && alike(*exposure, *taken);
  const bool exposes_anew = next.model.exposure != kind_.model.exposure && !as_taken;
  BITELINE_TRY(scanner.offer_change(exposes_anew ? *next.model.exposure : Nanoseconds{0}, next.pipeline.peaks,
                                    next.pipeline.selector.choice));
  offered_ = std::move(next);
  return {};
}

Result<void> SettingsControl::finish(const Result<Scanner::Changed>& changed) {
  Prepared next = *std::exchange(offered_, std::nullopt);
  if (!changed) return tl::unexpected<Error>{changed.error()};
  if (changed->exposure.count() != 0) {
    kind_.in_use.set(Key::ExposureUs, {.number = 1e-3 * static_cast<double>(changed->exposure.count())});
    kind_.limits.rate_max_hz = changed->rate_max_hz;
  }
  kind_.model = next.model;
  kind_.set = next.set;
  keep(std::move(next));
  return {};
}

void SettingsControl::keep(Prepared next) {
  pipeline_ = next.pipeline;
  asked_ = std::move(next.whole);
  ++state_.changes;
  refresh();
}

void SettingsControl::refresh() {
  if (kind_.recording) return;
  // What the camera took goes before what it was asked.
  SettingsSet shown = asked_;
  (void)for_each_key([&](Key key) -> Result<void> {
    if (const auto& taken = kind_.in_use.at(key)) shown.set(key, *taken);
    return {};
  });
  state_.text = settings::settings_text(shown);
  state_.rate_max_hz = kind_.limits.rate_max_hz;
}

}  // namespace biteline::sensor

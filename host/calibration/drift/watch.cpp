// SPDX-License-Identifier: MIT
#include "host/calibration/drift/watch.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <string_view>
#include <system_error>

#include "common/core/fixed_text.hpp"
#include "host/geometry/symmetric.hpp"

namespace biteline::drift {
namespace {

/// A quantity that a scan knows worse, alone and in fault sizes, is not seen.  Scans scatter some twice as
/// much as they state (pose errors along the lap go together).  A CUSUM tells a step within five numbers from
/// SelfStarting::k_slack + k_limit / 5 = 2.45 deviations on.
constexpr double k_most_sigma = 0.2;
/// A fault lasts so many shoes before somebody asks.
constexpr double k_shoes_asked = 5;

/// What is left of a scan's pull after the usual, as a variance per degree of freedom.
double scatter_of(const Sums& left) {
  const geometry::PrincipalAxes parts = geometry::principal_axes(left.information);
  double sum = 0, freedom = 0;
  for (int i = 0; i < k_quantities; ++i) {
    const double information = parts.values[i];
    if (!(information > 1 / (k_most_sigma * k_most_sigma))) continue;
    const double pull = parts.vectors.col(i).dot(left.pull);
    sum += pull * pull / information;
    ++freedom;
  }
  return freedom > 0 ? sum / freedom : 0;
}

/// "scan-" and 12 of "scan-12".
struct Numbered {
  std::string_view name;
  unsigned long number{0};
};
Numbered numbered(std::string_view scan) {
  const std::size_t digits = scan.find_last_not_of("0123456789") + 1;
  Numbered out{.name = scan.substr(0, digits)};
  const std::from_chars_result read =
      std::from_chars(scan.data() + digits, scan.data() + scan.size(), out.number);
  // Without a number, or with one beyond all counting, the whole is the name.
  if (read.ec != std::errc{}) out.name = scan;
  return out;
}

/// `scan` is the last one, or one with a lower number: a person had it worked out again.
bool came_before(const std::string& scan, const std::string& last) {
  if (scan.empty()) return false;
  const Numbered now = numbered(scan), then = numbered(last);
  return scan == last || (now.name == then.name && now.number <= then.number);
}

}  // namespace

std::string_view to_string(Status status) {
  switch (status) {
    case Status::NotSeen:
      return "not_seen";
    case Status::Learning:
      return "learning";
    case Status::Sound:
      return "sound";
    case Status::Drifted:
      return "drifted";
  }
  return "";
}

Watch::Watch() : rows_(k_quantities, SelfStarting{k_least_sigma}) {}

double Watch::spread() const {
  return sound_shoes_ > 0 ? std::max(1.0, scatter_ / sound_shoes_) : 1.0;
}

void Watch::pass(const std::string& scan) {
  if (came_before(scan, last_scan_)) return;
  last_scan_ = scan;
  if (verdict_.status == Status::Drifted) return;
  verdict_ = {.status = Status::NotSeen,
              .shoes = verdict_.shoes,
              .words = "this scan shows no place well enough twice"};
}

const Verdict& Watch::take(const std::string& scan, const Evidence& evidence, const std::string& model) {
  if (came_before(scan, last_scan_)) return verdict_;
  heed_table(evidence.table, model);
  const Sums sums = seen(evidence, model);
  const Vector sigma = sums.alone_sigma();
  // Seen twice from one direction only: it would learn for ever.
  if (!(sigma.minCoeff() <= k_most_sigma)) {
    pass(scan);
    return verdict_;
  }
  last_scan_ = scan;
  ++verdict_.shoes;
  const bool drifted = verdict_.status == Status::Drifted;
  const std::optional<ModelUsuals::Said> said = models_.take(model, sums, !drifted);
  if (!said) {
    judge();
    return verdict_;
  }
  if (!drifted) {
    for (int i = 0; i < k_quantities; ++i) {
      if (sigma[i] <= k_most_sigma) rows_.at(static_cast<std::size_t>(i)).take(said->alone[i]);
    }
  }
  Recent recent{.model = model, .seen = sums, .scatter = {}, .learnt = !drifted};
  if (said->left) recent.scatter = scatter_of(*said->left);
  recent_.push_back(std::move(recent));
  if (recent_.size() > k_recent) {
    if (const Recent& proven = recent_.front(); !drifted && proven.scatter) {
      ++sound_shoes_;
      scatter_ += *proven.scatter;
    }
    recent_.pop_front();
  }
  if (drifted) verdict_.for_shoes = std::min(verdict_.for_shoes + 1, static_cast<int>(k_recent));
  judge();
  return verdict_;
}

void Watch::heed_table(const std::optional<TableEvidence>& table, const std::string& model) {
  if (!table) return;
  ModelUsuals::Usual& own = models_.own(model);
  if (own.table && table->is_another(*own.table)) {
    if (++own.on_another_table < k_another_table || verdict_.status == Status::Drifted) return;
    if (models_.is_first(model)) {
      Watch anew;
      anew.last_scan_ = last_scan_;
      *this = std::move(anew);
      return heed_table(table, model);
    }
    own = {};
    // The usual that they were learnt into is gone.
    std::erase_if(recent_, [&](const Recent& shoe) { return models_.are_one(shoe.model, model); });
  }
  own.on_another_table = 0;
  if (!own.table) own.table = table->plane;
}

Sums Watch::changed_by(int shoes) const {
  const std::size_t before = recent_.size() - std::min(recent_.size(), static_cast<std::size_t>(shoes));
  ModelUsuals usual = models_;
  for (std::size_t i = before; i < recent_.size(); ++i) {
    if (recent_[i].learnt) usual.forget(recent_[i].model, recent_[i].seen);
  }
  Sums changed;
  for (std::size_t i = before; i < recent_.size(); ++i) {
    const Recent& shoe = recent_[i];
    const ModelUsuals::Usual& own = usual.own(shoe.model);
    if (own.shoes < 1) continue;
    changed.add(shoe.seen.information, shoe.seen.pull - shoe.seen.information * explained(own.sums));
  }
  return changed;
}

int Watch::likeliest_change() const {
  int best = 1;
  double most = 0;
  for (int shoes = 1; shoes <= static_cast<int>(recent_.size()); ++shoes) {
    const Sums changed = changed_by(shoes);
    if (const double evidence = changed.pull.dot(explained(changed)); evidence > most) {
      most = evidence;
      best = shoes;
    }
  }
  return best;
}

void Watch::judge() {
  if (verdict_.for_shoes == 0 && std::ranges::any_of(rows_, &SelfStarting::changed))
    verdict_.for_shoes = likeliest_change();
  if (verdict_.for_shoes == 0) {
    const bool knows = std::ranges::any_of(rows_, &SelfStarting::knows);
    verdict_.status = knows ? Status::Sound : Status::Learning;
    verdict_.words =
        knows ? "no drift since the calibration"
              : std::string{FixedText<96>::format("learns what is usual: %d of %d shoes", verdict_.shoes,
                                                  SelfStarting::k_least + SelfStarting::k_on_trial)
                                .view()};
    return;
  }
  verdict_.status = Status::Drifted;
  const Sums changed = changed_by(verdict_.for_shoes);
  if (changed.information.isZero()) {
    verdict_.words = "drifted; of which part is not known";
    return;
  }
  verdict_.named = name(changed, spread());
  verdict_.words = words_of(*verdict_.named) + " drifted: " + largest_of(*verdict_.named) +
                   std::string{FixedText<64>::format(" over the last %d shoes", verdict_.for_shoes).view()};
}

Blind blind_of(const Evidence& evidence) {
  Blind blind;
  const Sums seen = evidence.sums();
  const Vector sigma = seen.alone_sigma();
  for (int i = 0; i < k_head_quantities; ++i) {
    const Quantity& quantity = k_table.at(static_cast<std::size_t>(i));
    if (!(sigma[i] <= k_most_sigma)) {
      blind.unseen.emplace_back(quantity.name);
      continue;
    }
    Sums sums{.information = k_shoes_asked * seen.information,
              .pull = k_shoes_asked * seen.information.col(i)};
    const std::string words = words_of(name(sums, 1));
    if (words != k_part_names.at(static_cast<std::size_t>(quantity.part)))
      blind.mistaken.push_back(std::string(quantity.name) + " (" + words + ")");
  }
  return blind;
}

}  // namespace biteline::drift

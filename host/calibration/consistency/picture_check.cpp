// SPDX-License-Identifier: MIT
#include "host/calibration/consistency/picture_check.hpp"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <vector>

#include "common/core/fixed_text.hpp"
#include "host/calibration/drift/table_seen.hpp"
#include "host/cloud/uncertainty/arm_sway.hpp"

namespace biteline::consistency {
namespace {

/// Points of a stripe nearer than that say no more (drift::seen_twice()).
constexpr float k_spacing_mm = 0.8F;
/// What is told by pictures that are not as they came must be many places, of many profiles, that agree as
/// well as sound ones do: of two surfaces that only touch each other few do.
constexpr std::size_t k_many_places = 60, k_many_profiles = 25;
constexpr double k_well_mm = 0.05;

ProfilePoints thinned(const drift::ScanView& scan, float spacing_mm) {
  ProfilePoints thin;
  for (std::size_t i = 0; i < scan.points_base.size(); ++i) {
    if (!scan.points_base[i].allFinite()) continue;
    const bool next = thin.profile.empty() || scan.profile[i] != thin.profile.back() ||
                      !((scan.points_base[i] - thin.points.back()).squaredNorm() < spacing_mm * spacing_mm);
    if (!next) continue;
    thin.points.push_back(scan.points_base[i]);
    thin.profile.push_back(scan.profile[i]);
  }
  return thin;
}

double arm_sigma_mm(const drift::ScanView& scan, const KnownBefore& known) {
  uncertainty::ArmSway sway;
  auto pose = scan.poses.begin();
  for (std::size_t first = 0, end = 0; first < scan.profile.size(); first = end) {
    while (end < scan.profile.size() && scan.profile[end] == scan.profile[first]) ++end;
    while (pose != scan.poses.end() && pose->profile < scan.profile[first]) ++pose;
    if (pose == scan.poses.end()) break;
    if (pose->profile == scan.profile[first])
      sway.add_profile(scan.points_base.subspan(first, end - first), pose->pose);
  }
  const auto by_motion = [&](const uncertainty::ArmGive& give) {
    const std::optional<uncertainty::ArmMotion> motion = sway.motion_by(give);
    return motion ? motion->sigma_mm : 0;
  };
  // A plane that a wrong head bends looks like an arm that sways: no arm is that soft.
  constexpr double k_softest = 3;
  if (const std::optional<uncertainty::ArmMotion> seen = sway.motion())
    return std::min(seen->sigma_mm, k_softest * by_motion(uncertainty::k_assumed_give));
  return by_motion(uncertainty::give_of(known.head, known.arm));
}

/// Profiles that show a table, level along each stripe: a slope that turns with the head is a cone.
std::size_t flat_table_profiles(const drift::ScanView& scan, const geometry::SensorModel& head) {
  const std::optional<drift::TableEvidence> table = drift::see_table(scan, head);
  if (!table) return 0;
  constexpr double k_on_table_mm = 0.4, k_most_slope = 0.03;
  std::size_t flat = 0, all = 0;
  for (std::size_t first = 0, end = 0; first < scan.profile.size(); first = end) {
    const Eigen::Vector3f* begin = nullptr;
    const Eigen::Vector3f* last = nullptr;
    for (; end < scan.profile.size() && scan.profile[end] == scan.profile[first]; ++end) {
      const Eigen::Vector3f& point = scan.points_base[end];
      if (!(std::abs(table->plane.above_mm(point.cast<double>())) < k_on_table_mm)) continue;
      if (begin == nullptr) begin = &point;
      last = &point;
    }
    if (begin == last) continue;
    const double rise_mm =
        table->plane.above_mm(last->cast<double>()) - table->plane.above_mm(begin->cast<double>());
    const double width_mm = static_cast<double>((*last - *begin).head<2>().norm());
    ++all;
    if (std::abs(rise_mm) < k_most_slope * width_mm) ++flat;
  }
  return 2 * flat > all ? table->profiles : 0;
}

/// One scan, under one reading of its pictures after the other.
class Looks {
 public:
  Looks(const drift::ScanView& whole, const geometry::SensorModel& head, const KnownBefore& known)
      : whole_{whole},
        thin_{thinned(whole, k_spacing_mm)},
        head_{head},
        spread_{spread_of(head, known.head)},
        known_{known} {}

  [[nodiscard]] Agreement as_told() const { return agreement(view(thin_)); }
  [[nodiscard]] std::size_t table_profiles() const { return flat_table_profiles(view(thin_), head_); }

  /// A move that, taken back, makes many places agree; the best one.
  struct Explained {
    PictureMove move;
    Agreement agreement{};
    std::size_t table_profiles{0};
  };
  [[nodiscard]] std::optional<Explained> explained(double most_apart_mm, bool by_table) const {
    std::optional<Explained> best;
    for (const PictureMove move : k_picture_moves) {
      // Of half the scale they lie half as far apart.
      const bool halved = move == PictureMove::Halved;
      const ProfilePoints came = halved ? thinned(whole_, k_spacing_mm / 2) : ProfilePoints{};
      const ProfilePoints placed = taken_back(view(halved ? came : thin_), head_, move);
      const drift::ScanView back = view(placed);
      Explained tried{.move = move, .agreement = agreement(back)};
      const Agreement& found = tried.agreement;
      // A plane stays one at another scale.
      if (by_table && !halved) tried.table_profiles = flat_table_profiles(back, head_);
      const bool places = found.places >= k_many_places && found.profiles >= k_many_profiles &&
                          !found.contradicts() && found.apart_mm < most_apart_mm;
      if (!places && tried.table_profiles == 0) continue;
      if (!best || found.places > best->agreement.places) best = tried;
    }
    return best;
  }

  /// Where the pictures are moved to, if that alone explains it: columns, rows.
  [[nodiscard]] std::optional<Vec2> moved(Agreement told) const {
    constexpr int k_rounds = 6;
    constexpr double k_most_step = 15, k_farthest_px = 150;
    Vec2 px = Vec2::Zero();
    // The one that explains more; both together may not be told apart.
    int by = 1;
    for (int round = 0; round < k_rounds && told.contradicts(); ++round) {
      by = told.moved_statistic[1] < told.moved_statistic[0] ? 0 : 1;
      px[by] += std::clamp(told.moved_px[by], -k_most_step, k_most_step);
      if (!(px.norm() < k_farthest_px)) return std::nullopt;
      const ProfilePoints placed = place_taken_back(view(thin_), head_, px);
      told = agreement(view(placed));
    }
    if (!told.enough() || told.contradicts()) return std::nullopt;
    px[by] += told.moved_px[by];
    return px;
  }

 private:
  [[nodiscard]] Agreement agreement(const drift::ScanView& scan) const {
    const std::vector<Crossing> crossings = crossings_of(scan, head_, spread_);
    return agreement_of(crossings, crossings.empty() ? 0 : arm_sigma_mm(scan, known_));
  }

  [[nodiscard]] drift::ScanView view(const ProfilePoints& points) const { return points.view(whole_.poses); }

  const drift::ScanView& whole_;
  ProfilePoints thin_;
  const geometry::SensorModel& head_;
  HeadSpread spread_;
  const KnownBefore& known_;
};

std::string words_of(const Vec2& px) {
  const auto count = [](double value, const char* of) {
    return std::string{FixedText<32>::format("%.0f %s", value, of).view()};
  };
  const bool columns = std::abs(px.x()) >= 0.5, rows = std::abs(px.y()) >= 0.5 || !columns;
  return (columns ? count(px.x(), "columns") : std::string{}) + (columns && rows ? " and " : "") +
         (rows ? count(px.y(), "rows") : std::string{});
}

std::string cause_of(const Looks& looks, const Agreement& told) {
  if (const auto explained = looks.explained(told.apart_mm / 2, false))
    return "as if the pictures were " + std::string(words_of(explained->move));
  if (const auto px = looks.moved(told)) return "as if the pictures were moved by " + words_of(*px);
  return "neither mirroring, turn, binning nor another place of the region explains it alone";
}

}  // namespace

std::string_view to_string(PictureCheck::Status status) {
  switch (status) {
    case PictureCheck::Status::Agree:
      return "agree";
    case PictureCheck::Status::Contradict:
      return "contradict";
    case PictureCheck::Status::NotSeen:
      return "not_seen";
  }
  return "";
}

PictureCheck check_pictures(const drift::ScanView& scan, const geometry::SensorModel& head,
                            const KnownBefore& known) {
  const Looks looks{scan, head, known};
  PictureCheck check{.as_told = looks.as_told()};
  const Agreement& told = check.as_told;
  using Status = PictureCheck::Status;
  if (told.contradicts()) {
    check.status = Status::Contradict;
    check.words =
        std::string{FixedText<160>::format("the scan contradicts itself by %.2f mm, where %.2f mm may be: ",
                                           told.apart_mm, told.allowed_mm())
                        .view()} +
        cause_of(looks, told);
    return check;
  }
  if (told.agrees()) {
    check.status = Status::Agree;
    check.words = std::string{FixedText<160>::format("%zu places seen from two directions agree to %.3f mm",
                                                     told.places, told.apart_mm)
                                  .view()};
    return check;
  }
  if (told.rows_agree()) {
    // A shoe's top shows rows, and hardly a column: those move the places along the surface.
    check.words =
        std::string{FixedText<200>::format("%zu places seen from two directions agree to %.3f mm, ",
                                           told.places, told.apart_mm)
                        .view()} +
        (told.tells_columns ? std::string{FixedText<120>::format(
                                              "but would with pictures moved by fewer than %.0f columns, too",
                                              *told.tells_columns)
                                              .view()}
                            : std::string{"but would with pictures moved along their rows, too"}) +
        ": let it make a check lap";
    return check;
  }
  check.table_profiles = looks.table_profiles();
  if (const auto explained = looks.explained(k_well_mm, check.table_profiles == 0)) {
    check.status = Status::Contradict;
    check.words = explained->table_profiles > 0
                      ? std::string{FixedText<160>::format("a level table is seen all round (%zu profiles)",
                                                           explained->table_profiles)
                                        .view()}
                      : std::string{FixedText<160>::format("%zu places seen from two directions agree",
                                                           explained->agreement.places)
                                        .view()};
    check.words += " only if the pictures were " + std::string(words_of(explained->move));
    return check;
  }
  check.words =
      "this scan shows too little from two directions to tell pictures that are not as calibrated: "
      "let it make a check lap";
  return check;
}

std::optional<Refusal> refusal_of(const PictureCheck& check) {
  if (check.status != PictureCheck::Status::Contradict) return std::nullopt;
  return Refusal{.code = Refused::NotAsCalibrated, .reason = check.words};
}

VouchedBy vouched_by(const PictureCheck& check, bool camera_state_compared) {
  if (camera_state_compared) return VouchedBy::CameraState;
  return check.status == PictureCheck::Status::Agree ? VouchedBy::Places : VouchedBy::Nobody;
}

std::string_view to_string(VouchedBy by) {
  switch (by) {
    case VouchedBy::Places:
      return "places";
    case VouchedBy::CameraState:
      return "camera_state";
    case VouchedBy::Nobody:
      return "nobody";
  }
  return "";
}

nlohmann::ordered_json as_json(const PictureCheck& check, bool camera_state_compared) {
  const Agreement& told = check.as_told;
  nlohmann::ordered_json json{{"status", to_string(check.status)},
                              {"words", check.words},
                              {"vouched_by", to_string(vouched_by(check, camera_state_compared))},
                              {"places", told.places},
                              {"profiles", told.profiles}};
  if (told.enough()) {
    json["apart_mm"] = told.apart_mm;
    json["arm_sigma_mm"] = told.arm_sigma_mm;
    json["statistic"] = told.statistic;
    json["limit"] = told.limit;
    json["moved_statistic"] = told.moved_statistic.maxCoeff();
    json["moved_limit"] = told.moved_limit;
    if (told.tells_columns) json["tells_columns"] = *told.tells_columns;
    if (told.tells_rows) json["tells_rows"] = *told.tells_rows;
  }
  if (check.table_profiles > 0) json["table_profiles"] = check.table_profiles;
  return json;
}

}  // namespace biteline::consistency

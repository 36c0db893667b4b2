// SPDX-License-Identifier: MIT
#pragma once
/// \file Shoe after shoe: has the calibration drifted since it was made, and which part of it?

#include <deque>
#include <optional>
#include <string>
#include <vector>

#include "common/core/result.hpp"
#include "host/calibration/drift/evidence.hpp"
#include "host/calibration/drift/model_usuals.hpp"
#include "host/calibration/drift/naming.hpp"
#include "host/calibration/drift/self_starting.hpp"

namespace biteline::drift {

enum class Status : std::uint8_t {
  NotSeen,   ///< this scan shows no place twice, or no quantity well enough
  Learning,  ///< too few shoes since the calibration
  Sound,
  Drifted,  ///< and it stays so until somebody calibrates or starts anew
};
[[nodiscard]] std::string_view to_string(Status status);

struct Verdict {
  Status status{Status::NotSeen};
  int shoes{0};  ///< judged since the calibration
  std::string words{};
  std::optional<Named> named{};  ///< of a drift
  int for_shoes{0};              ///< so many of the last ones have it
};

/// One calibration's shoes.  Not thread-safe.
class Watch {
 public:
  Watch();

  /// A shoe with places seen twice.  Names end in a number that rises; one that came before, or came last, is
  /// not counted again.  `model`: whose shoe it is; empty: nobody knows, or there is only one.
  const Verdict& take(const std::string& scan, const Evidence& evidence, const std::string& model = {});
  /// A shoe without.
  void pass(const std::string& scan);

  [[nodiscard]] const Verdict& verdict() const { return verdict_; }
  /// A scan's evidence as this watch counts it: the table from its model's usual one.
  [[nodiscard]] Sums seen(const Evidence& evidence, const std::string& model = {}) const {
    return evidence.sums(models_.table_of(model));
  }
  [[nodiscard]] const SelfStarting& row(int quantity) const {
    return rows_.at(static_cast<std::size_t>(quantity));
  }

  /// As text for a memory, and back; Errc::BadFormat.
  [[nodiscard]] std::string to_text() const;
  [[nodiscard]] static Result<Watch> from_text(const std::string& text);

 private:
  /// No row's spread counts as less: a drift of a tenth of a fault size is none.
  static constexpr double k_least_sigma = 0.1;
  /// Shoes that a drift is named by.
  static constexpr std::size_t k_recent = 10;

  /// Shoes on another table after which that one is the usual.
  static constexpr int k_another_table = 10;

  /// Takes a model's first table for its usual one, and another one that stays: the model is learnt anew on
  /// it.  All is, where the others count from that model.
  void heed_table(const std::optional<TableEvidence>& table, const std::string& model);
  struct Recent {
    std::string model{};
    Sums seen{};
    std::optional<double> scatter{};  ///< of what its model's usual leaves, per degree of freedom
    bool learnt{true};                ///< its model's usual holds it
  };

  [[nodiscard]] double spread() const;
  /// Since how many shoes: what explains them best (Hinkley, "Inference about the change-point in a sequence
  /// of random variables", 1970).
  [[nodiscard]] int likeliest_change() const;
  /// What the last shoes have beyond the usual of their models before.
  [[nodiscard]] Sums changed_by(int shoes) const;
  void judge();

  std::vector<SelfStarting> rows_;  ///< one for each quantity
  std::deque<Recent> recent_;       ///< the last shoes, oldest first
  int sound_shoes_{0};              ///< of those before, with a known scatter
  double scatter_{0};               ///< their sum
  ModelUsuals models_;
  std::string last_scan_;
  Verdict verdict_;
};

/// Quantities of the head whose fault of one size a scan like this would hardly show, and those that it would
/// show but call by another part's name too: for people, "laser roll", "mounting z (head or mounting)".
struct Blind {
  std::vector<std::string> unseen;
  std::vector<std::string> mistaken;
};
[[nodiscard]] Blind blind_of(const Evidence& evidence);

}  // namespace biteline::drift

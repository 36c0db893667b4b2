// SPDX-License-Identifier: MIT
#pragma once
/// \file What is usual of each model: an arm bends otherwise round each of them.

#include <map>
#include <optional>
#include <string>

#include "host/calibration/drift/sums.hpp"
#include "host/calibration/drift/table_seen.hpp"

namespace biteline::drift {

/// A quantity is held to about so many fault sizes where a scan does not tell it.
inline constexpr double k_usual_size = 3;
/// The drift that explains such sums best.
[[nodiscard]] Vector explained(const Sums& sums);

/// Shoes count from their own model's usual.  A drift moves that of all models alike, so it stays in what is
/// left.
class ModelUsuals {
 public:
  struct Usual {
    Sums sums{};
    Vector alone{Vector::Zero()};  ///< sum over the shoes
    int shoes{0};
    std::optional<TablePlane> table{};  ///< models may have fixtures of their own
    int on_another_table{0};            ///< shoes on another one, one after the other
  };
  /// Shoes of a model, and of the first one, before such a shoe is judged.
  static constexpr int k_least = 3;
  /// More share one usual.
  static constexpr std::size_t k_most = 32;

  ModelUsuals() = default;
  ModelUsuals(std::string first, std::map<std::string, Usual> of);

  struct Said {
    Vector alone;                ///< as if the shoe were of the first model
    std::optional<Sums> left{};  ///< beyond its own model's usual, once that is known
  };
  /// Learns from the shoe where `learns`.  Nothing: of this model too little is known yet.
  [[nodiscard]] std::optional<Said> take(const std::string& model, const Sums& seen, bool learns);

  /// As if a shoe that was learnt had not been.
  void forget(const std::string& model, const Sums& seen);
  /// Made where the model is new.
  [[nodiscard]] Usual& own(const std::string& model);
  [[nodiscard]] bool is_first(const std::string& model) const { return name_of(model) == first_; }
  /// One usual serves both.
  [[nodiscard]] bool are_one(const std::string& a, const std::string& b) const {
    return name_of(a) == name_of(b);
  }
  /// Nothing where none was seen yet.
  [[nodiscard]] std::optional<TablePlane> table_of(const std::string& model) const;

  [[nodiscard]] const std::string& first() const { return first_; }
  [[nodiscard]] const std::map<std::string, Usual>& of() const { return of_; }

 private:
  [[nodiscard]] std::string name_of(const std::string& model) const;

  std::string first_;
  std::map<std::string, Usual> of_;
};

}  // namespace biteline::drift

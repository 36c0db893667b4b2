// SPDX-License-Identifier: MIT
#pragma once
/// \file What is usual of each model: an arm bends otherwise round each of them.

#include <map>
#include <optional>
#include <string>

#include "host/calibration/drift/sums.hpp"

namespace biteline::drift {

/// A quantity is held to about so many fault sizes where a scan does not tell it.
inline constexpr double k_usual_size = 3;
/// The drift that explains such sums best.
[[nodiscard]] Vector explained(const Sums& sums);

/// Shoes of other models count from their own usual, as if they were of the first one.  A drift moves the
/// usual of all models alike, so it stays in what is left.
class ModelUsuals {
 public:
  struct Usual {
    Sums sums{};
    Vector alone{Vector::Zero()};  ///< sum over the shoes
    int shoes{0};
  };
  /// Shoes of a model, and of the first one, before such a shoe is judged.
  static constexpr int k_least = 3;
  /// More share one usual.
  static constexpr std::size_t k_most = 32;

  ModelUsuals() = default;
  ModelUsuals(std::string first, std::map<std::string, Usual> of);

  /// What a shoe would say if it were of the first model.
  struct Said {
    Sums sums;
    Vector alone;  ///< not that of `sums`: models see the same mixture of quantities otherwise
  };
  /// Learns from the shoe where `learns`.  Nothing: of this model too little is known yet.
  [[nodiscard]] std::optional<Said> take(const std::string& model, const Sums& seen, bool learns);

  [[nodiscard]] const std::string& first() const { return first_; }
  [[nodiscard]] const std::map<std::string, Usual>& of() const { return of_; }

 private:
  std::string first_;
  std::map<std::string, Usual> of_;
};

}  // namespace biteline::drift

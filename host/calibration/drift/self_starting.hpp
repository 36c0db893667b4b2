// SPDX-License-Identifier: MIT
#pragma once
/// \file A change in a row of numbers whose mean and spread nobody knows beforehand: a CUSUM that starts
/// itself.

#include <deque>

namespace biteline::drift {

/// Two-sided CUSUM of scores against the numbers before (after Hawkins, "Self-starting cusum charts for
/// location and scale", 1987).  A number's score is Student's t of it against what came before, made a normal
/// deviate; the last few numbers are on trial and not among these, so that a jump does not hide itself.
class SelfStarting {
 public:
  static constexpr int k_on_trial = 5;
  /// Numbers behind those on trial, from which on there are scores.
  static constexpr int k_least = 10;
  /// Half the shift, in standard deviations, that is found fastest.
  static constexpr double k_slack = 1.25;
  /// One number counts no more, whatever it is: a shoe that was touched is no drift.
  static constexpr double k_most_score = 3.5;
  /// Sum that tells a change: reached by an unchanged row about once in 500 000 numbers.
  static constexpr double k_limit = 6.0;

  struct State {
    int count{0};  ///< of those that are not on trial
    double mean{0}, squares{0};
    std::deque<double> on_trial{};
    double high{0}, low{0};
  };

  explicit SelfStarting(double least_sigma) : least_sigma_{least_sigma} {}
  SelfStarting(double least_sigma, State state) : least_sigma_{least_sigma}, state_{std::move(state)} {}

  /// Pre: finite.
  void take(double value);
  [[nodiscard]] bool changed() const { return state_.high > k_limit || state_.low > k_limit; }
  [[nodiscard]] bool knows() const { return state_.count >= k_least; }
  [[nodiscard]] double mean() const { return state_.mean; }
  /// Of one number; never below `least_sigma`.
  [[nodiscard]] double sigma() const;
  [[nodiscard]] double sum() const { return state_.high > state_.low ? state_.high : -state_.low; }
  [[nodiscard]] const State& state() const { return state_; }

 private:
  double least_sigma_;
  State state_{};
};

}  // namespace biteline::drift

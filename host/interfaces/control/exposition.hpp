// SPDX-License-Identifier: MIT
#pragma once
/// \file Prometheus' text of numbers, version 0.0.4: what each program gives under /metrics.

#include <string>
#include <string_view>
#include <utility>

namespace biteline::control {

/// `name="value"`; backslash, quote and line end of the value are escaped.
[[nodiscard]] std::string metric_label(std::string_view name, std::string_view value);

/// A family begins with its head; its values follow at once.
class Exposition {
 public:
  /// `prefix` stands before every name: "biteline_".
  explicit Exposition(std::string prefix) : prefix_{std::move(prefix)} {}

  void head(std::string_view name, std::string_view type, std::string_view help);
  /// Of the family begun last; `labels` as metric_label() gives them, with commas between, or none.
  void value(std::string_view labels, double number);
  /// A family of one number.
  void one(std::string_view name, std::string_view type, std::string_view help, double number);
  [[nodiscard]] std::string take() { return std::move(text_); }

 private:
  std::string prefix_, name_, text_;
};

}  // namespace biteline::control

// SPDX-License-Identifier: MIT
#include "host/interfaces/control/exposition.hpp"

#include <array>
#include <cstdio>

namespace biteline::control {

std::string metric_label(std::string_view name, std::string_view value) {
  std::string label{name};
  label += "=\"";
  for (const char letter : value) {
    if (letter == '\\' || letter == '"') label += '\\';
    if (letter == '\n') {
      label += "\\n";
    } else {
      label += letter;
    }
  }
  return label + '"';
}

void Exposition::head(std::string_view name, std::string_view type, std::string_view help) {
  name_ = prefix_ + std::string{name};
  text_.append("# HELP ").append(name_).append(" ").append(help);
  text_.append("\n# TYPE ").append(name_).append(" ").append(type).append("\n");
}

void Exposition::value(std::string_view labels, double number) {
  std::array<char, 32> digits{};
  std::snprintf(digits.data(), digits.size(), "%.17g", number);
  text_.append(name_);
  if (!labels.empty()) text_.append("{").append(labels).append("}");
  text_.append(" ").append(digits.data()).append("\n");
}

void Exposition::one(std::string_view name, std::string_view type, std::string_view help, double number) {
  head(name, type, help);
  value("", number);
}

}  // namespace biteline::control

// SPDX-License-Identifier: MIT
#pragma once
/// \file A GenICam description as text, feature by feature, over 32-bit big-endian registers.

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace biteline::gige {

/// One value of an enumeration.
struct Choice {
  const char* name;
  std::uint32_t value;
};

/// SFNC names over registers.  `access` is GenICam's: RO, RW or WO.  `index` is of per(), or empty.
class Description {
 public:
  Description(std::string_view vendor, std::string_view model) : vendor_{vendor}, model_{model} {}

  void text(const char* name, std::uint32_t address, int length);
  /// `limit`: a feature's name or a number, empty for none.
  void integer(const char* name, std::uint32_t address, const char* access, int minimum,
               const std::string& limit, const std::string& index = {});
  /// value = register / per_unit
  void real(const char* name, std::uint32_t address, const char* access, int per_unit, double minimum,
            double maximum, const std::string& index = {});
  /// A register that holds a 32-bit float.
  void float_register(const char* name, std::uint32_t address, const char* access,
                      const std::string& index = {});
  /// value = 1e6 / register: a rate kept as a period in microseconds
  void rate(const char* name, std::uint32_t address, double minimum, double maximum);
  void boolean(const char* name, std::uint32_t address, const char* access = "RW");
  /// `selected`: features that this one selects, as selected() gives them.
  void choices(const char* name, std::uint32_t address, const char* access,
               const std::vector<Choice>& entries, const std::string& index = {},
               const std::string& selected = {});
  void command(const char* name, std::uint32_t address, int value);
  void line(const std::string& text) { body_ += text + "\n"; }
  void listed(const char* name);

  /// One register for each value of the selector, `stride` bytes apart.
  [[nodiscard]] static std::string per(const char* selector, std::uint32_t stride);
  [[nodiscard]] static std::string selected(const std::vector<const char*>& features);

  [[nodiscard]] std::string whole() const;

 private:
  [[gnu::format(printf, 2, 3)]] void add(const char* pattern, ...);
  void raw_register(const char* name, std::uint32_t address, const char* access,
                    const std::string& index = {});

  std::string_view vendor_, model_;
  std::string features_, body_;
};

}  // namespace biteline::gige

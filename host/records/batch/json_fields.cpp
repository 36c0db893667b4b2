// SPDX-License-Identifier: MIT
#include "host/records/batch/json_fields.hpp"

#include <unistd.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <cmath>
#include <cstdio>

#include "common/system/file.hpp"
#include "host/report/report.hpp"

namespace biteline::batch {

using nlohmann::ordered_json;

const ordered_json* JsonFields::find(const char* key) const {
  if (!json_.is_object()) return nullptr;
  const auto at = json_.find(key);
  return at == json_.end() || at->is_null() ? nullptr : &*at;
}

tl::unexpected<Error> JsonFields::wrong(const char* key, const char* expected) const {
  return fail(Errc::BadFormat, "%.180s key %s: %s expected", file_.c_str(), key, expected);
}

Result<std::string> JsonFields::text(const char* key) const {
  const ordered_json* const value = find(key);
  if (value == nullptr || !value->is_string()) return wrong(key, "a text");
  return value->get<std::string>();
}

Result<double> JsonFields::number(const char* key) const {
  BITELINE_ASSIGN(const std::optional<double> value, number_if(key));
  if (!value) return wrong(key, "a number");
  return *value;
}

Result<std::optional<double>> JsonFields::number_if(const char* key) const {
  const ordered_json* const value = find(key);
  if (value == nullptr) return std::optional<double>{};
  if (!value->is_number() || !std::isfinite(value->get<double>())) return wrong(key, "a number");
  return std::optional{value->get<double>()};
}

Result<const ordered_json*> JsonFields::array(const char* key) const {
  const ordered_json* const value = find(key);
  if (value == nullptr || !value->is_array()) return wrong(key, "a list");
  return value;
}

Result<const ordered_json*> JsonFields::object(const char* key) const {
  const ordered_json* const value = find(key);
  if (value == nullptr || !value->is_object()) return wrong(key, "an object");
  return value;
}

Result<ordered_json> read_json_object(const std::filesystem::path& file) {
  BITELINE_ASSIGN(const std::string text, read_regular_file(file, k_most_table_bytes));
  ordered_json json = ordered_json::parse(text, nullptr, false);
  if (!json.is_object()) return fail(Errc::BadFormat, "%s: a JSON object expected", file.c_str());
  return json;
}

Result<void> write_shared_file(const std::filesystem::path& file, const std::string& text) {
  static std::atomic<int> count{0};
  std::array<char, 256> host{};
  ::gethostname(host.data(), host.size() - 1);
  const std::filesystem::path beside =
      file.string() + "." + host.data() + "." + std::to_string(::getpid()) + "." + std::to_string(count++);
  BITELINE_TRY(report::write_file_atomically(beside, text));
  if (std::rename(beside.c_str(), file.c_str()) != 0)
    return fail_errno(Errc::WriteFailed, errno, "%s", file.c_str());
  return {};
}

}  // namespace biteline::batch

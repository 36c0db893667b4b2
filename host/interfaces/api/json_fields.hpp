// SPDX-License-Identifier: MIT
#pragma once
/// \file How the API reads bodies and queries, and says things: the shapes of host/web/openapi.yaml.

#include <optional>
#include <string>
#include <vector>

#include "common/core/numbers.hpp"
#include "host/interfaces/control/messages.hpp"
#include "host/records/memory/factory_day.hpp"
#include "host/records/memory/memory.hpp"

namespace biteline::api {

using control::Answer;
using control::Json;

[[nodiscard]] Answer ok(Json body, int status = 200);
[[nodiscard]] Answer nothing();  ///< 204
/// The status and code of the API for an Error: what is missing is 404, wrong state 409, bad input 400, a
/// full disk 507, a broken file 500.
[[nodiscard]] Answer answer_of(const Error& error);
/// Where something was done, and only the memory could not keep it: what was done first, then why.
[[nodiscard]] Answer unlogged(const std::string& done, const Error& error);

/// A body's fields, read strictly: each fault is collected, unknown fields are faults.
class Fields {
 public:
  explicit Fields(const Json& body);

  std::string text(const std::string& name, std::size_t most_bytes, bool required = false);
  std::optional<bool> boolean(const std::string& name);
  /// Within the range, both ends included.
  std::optional<double> number(const std::string& name, double least, double most);
  /// Empty when it is absent.
  Json list(const std::string& name, std::size_t most);
  /// Null when it is absent.
  Json object(const std::string& name);
  [[nodiscard]] bool has(const std::string& name) const;
  void fault(const std::string& name, const std::string& message);

  /// 400 with every fault, or nothing.  Call once, last.
  [[nodiscard]] std::optional<Answer> faults();

 private:
  Json body_;
  std::vector<std::string> known_;
  Json faults_ = Json::array();
};

/// from, to, model, verdict, limit, cursor of a query; a fault is an Answer.  A day without a time is the
/// factory's, a time without a zone local.
struct QueryFilter {
  memory::ScanFilter filter;
  std::optional<Answer> fault{};
};
[[nodiscard]] QueryFilter filter_of(const std::map<std::string, std::string>& query,
                                    const memory::FactoryDay& day);

[[nodiscard]] bool is_name(const std::string& text);
[[nodiscard]] bool is_scan_id(const std::string& text);
[[nodiscard]] bool is_foot(const std::string& text);  ///< left or right

/// `ScanRow`, `LogEntry` and `User`.
/// Null where no look was asked for.
[[nodiscard]] Json work_json(const memory::Work& work);
[[nodiscard]] Json to_json(const memory::Scan& scan);
[[nodiscard]] Json to_json(const memory::LogRow& row);
[[nodiscard]] Json to_json(const memory::User& user);

/// Null for an empty text or an absent number.
[[nodiscard]] Json or_null(const std::string& text);
[[nodiscard]] Json or_null(const std::optional<double>& number);

}  // namespace biteline::api

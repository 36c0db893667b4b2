// SPDX-License-Identifier: MIT
#include "host/records/memory/scan_filter.hpp"

namespace biteline::memory {

Where where_of(const ScanFilter& filter) {
  Where where;
  if (filter.from) where.add("time >= ?", *filter.from);
  if (filter.to) where.add("time < ?", *filter.to);
  if (!filter.model.empty()) where.add("model = ?", filter.model);
  if (!filter.verdict.empty()) where.add("verdict = ?", filter.verdict);
  if (!filter.reason_code.empty()) where.add("reason_code = ?", filter.reason_code);
  if (filter.part.ends_with('*')) {
    const std::string begin = filter.part.substr(0, filter.part.size() - 1);
    where.add("part <> '' AND part >= ?", begin);
    where.add("part < ?", begin + "\xF4\x8F\xBF\xBF");  // the last letter of Unicode
  } else if (!filter.part.empty()) {
    where.add("part <> '' AND part = ?", filter.part);
  }
  return where;
}

}  // namespace biteline::memory

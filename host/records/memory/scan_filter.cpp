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
  return where;
}

}  // namespace biteline::memory

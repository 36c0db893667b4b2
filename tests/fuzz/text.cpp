// SPDX-License-Identifier: MIT
// Any bytes as text: clean, not longer, and the same when cleaned again.
#include "common/core/text.hpp"

#include "common/core/result.hpp"
#include "tests/fuzz/case.hpp"

using namespace biteline;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  fuzz::Case bytes{data, size};
  const std::size_t most = bytes.take<std::uint16_t>() % 600U;
  const std::vector<std::uint8_t> rest = bytes.rest();
  const std::string text(rest.begin(), rest.end());
  const std::string once = clean_text(text, most);
  fuzz::demand(once.size() <= most && clean_text(once) == once, "clean text stays as it is");
  fuzz::demand_clean(fail(Errc::BadValue, "%s", text.c_str()).value());
  return 0;
}

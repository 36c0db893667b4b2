// SPDX-License-Identifier: MIT
// MCAP files: any bytes are read up to their damage; what both readers call whole has the same messages.
#include "common/mcap/reader.hpp"
#include "common/mcap/verify.hpp"
#include "tests/fuzz/case.hpp"

using namespace biteline;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const fuzz::MemoryFile file{data, size};
  std::uint64_t heard = 0;
  const auto end = mcap::read_messages(
      file.path(), {.on_message =
                        [&](const mcap::Channel&, const mcap::Schema*, const mcap::Message&) {
                          ++heard;
                          return Result<void>{};
                        },
                    .on_attachment = {},
                    .on_metadata = {}});
  const auto verdict = mcap::verify(file.path());
  if (!end) {
    fuzz::demand_clean(end.error());
    fuzz::demand(!verdict.has_value(), "both take the same files for MCAP");
    return 0;
  }
  fuzz::demand(end->messages == heard && end->good_bytes <= size, "what is told is handed out");
  fuzz::demand(verdict.has_value(), "a file that can be read can be judged");
  if (verdict->faults.empty())
    fuzz::demand(end->damage.empty() && verdict->messages == heard, "a whole file is read whole");
  return 0;
}

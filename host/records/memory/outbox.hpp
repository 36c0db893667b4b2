// SPDX-License-Identifier: MIT
#pragma once
/// \file What the centre of many cells is to be told, in order: read beside the service that writes it.

#include "host/records/memory/memory.hpp"

namespace biteline::memory {

/// A shoe that the centre is to be told of, or to be told of again.
struct OutboxRow {
  std::int64_t seq{0};
  std::int64_t after{0};  ///< the row before; 0: none
  Scan scan;              ///< as it is now
  std::optional<Places> places{};
};

struct OutboxPart {
  std::string book;         ///< of this file; another file has another one
  std::int64_t waiting{0};  ///< rows above the number that was asked for
  std::vector<OutboxRow> rows;
};

/// Thread: one owner.  Never holds up the service: it reads only.
class Outbox {
 public:
  /// Errc::FileNotFound where there is no memory yet; Errc::NotSupported: of another program's schema.
  [[nodiscard]] static Result<Outbox> open(const std::filesystem::path& file);

  [[nodiscard]] Result<std::string> book();
  /// The first `limit` rows above `seq`, oldest first.
  [[nodiscard]] Result<OutboxPart> after(std::int64_t seq, int limit);
  /// The newest row alone, or none.
  [[nodiscard]] Result<OutboxPart> last();
  /// Of the newest row of the log, for the centre to keep; row 0: there is none with a link.
  [[nodiscard]] Result<LogLink> last_log_link();

 private:
  Outbox(Memory memory, Database database) : memory_{std::move(memory)}, database_{std::move(database)} {}
  [[nodiscard]] Result<std::int64_t> number(const char* sql, std::int64_t bound);

  Memory memory_;
  Database database_;
};

}  // namespace biteline::memory

// SPDX-License-Identifier: MIT
#pragma once
/// \file A scan's messages on disk as they come: what a host that dies has not lost.
/// The file's form: common/wire/scan_file.hpp.

#include <filesystem>
#include <functional>
#include <span>

#include "common/core/result.hpp"
#include "common/wire/messages.hpp"
#include "host/intake/host_protocol.hpp"

namespace biteline::intake {

/// Survives the death of the process (not a power cut: the kernel's cache is not forced out).  One program at
/// a time: the file is locked while it is open (Errc::PeerRefused).
/// Thread: one owner.
class ScanJournal {
 public:
  struct Recovered;

  /// Errc::WriteFailed when the file exists.
  [[nodiscard]] static Result<ScanJournal> create(const std::filesystem::path& file);

  /// Hands every whole message to `on_message`, cuts off what was being written at the end, and goes on from
  /// there. Errc::BadFormat when the file is none of ours or holds no hello.
  [[nodiscard]] static Result<Recovered> recover(const std::filesystem::path& file,
                                                 const std::function<void(wire::Message)>& on_message);

  ScanJournal(ScanJournal&& other) noexcept;
  ScanJournal& operator=(ScanJournal&& other) noexcept;
  ~ScanJournal();

  /// Whole or not at all: after Errc::DiskFull or WriteFailed the file ends with the message before.
  [[nodiscard]] Result<void> append(std::span<const std::uint8_t> message);

  [[nodiscard]] const std::filesystem::path& file() const { return file_; }

 private:
  ScanJournal(std::filesystem::path file, int fd, std::uint64_t size_bytes)
      : file_{std::move(file)}, fd_{fd}, size_bytes_{size_bytes} {}

  std::filesystem::path file_;
  int fd_{-1};
  std::uint64_t size_bytes_{0};
};

struct ScanJournal::Recovered {
  ScanJournal journal;
  ScanPosition position;       ///< what to ask the sensor for
  std::uint64_t bytes_cut{0};  ///< of a message that was not finished
};

}  // namespace biteline::intake

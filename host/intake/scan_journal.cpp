// SPDX-License-Identifier: MIT
#include "host/intake/scan_journal.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <limits>
#include <string_view>
#include <utility>
#include <vector>

#include "common/system/file.hpp"
#include "common/wire/scan_file.hpp"
#include "host/report/file_lock.hpp"

namespace biteline::intake {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view k_magic = wire::k_scan_file_magic;
using Length = std::uint32_t;

Errc write_code(int sys_errno) {
  return sys_errno == ENOSPC || sys_errno == EDQUOT || sys_errno == EFBIG ? Errc::DiskFull
                                                                          : Errc::WriteFailed;
}

/// All of `bytes` or an Error; a short write is a full disk about to say so.
Result<void> write_all(int fd, std::span<const std::uint8_t> bytes, const fs::path& file) {
  while (!bytes.empty()) {
    const ssize_t written = ::write(fd, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) return fail_errno(write_code(errno), errno, "%s", file.c_str());
    bytes = bytes.subspan(static_cast<std::size_t>(written));
  }
  return {};
}

Result<std::size_t> read_up_to(int fd, std::span<std::uint8_t> bytes, const fs::path& file) {
  std::size_t got = 0;
  while (got < bytes.size()) {
    const ssize_t count = ::read(fd, bytes.data() + got, bytes.size() - got);
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) return fail_errno(Errc::FileUnreadable, errno, "%s", file.c_str());
    if (count == 0) break;
    got += static_cast<std::size_t>(count);
  }
  return got;
}

/// The next whole message, or nothing at the end (also where the file was cut or damaged).
Result<std::optional<wire::Message>> read_message(int fd, const fs::path& file, std::uint64_t& size_bytes) {
  Length length = 0;
  std::array<std::uint8_t, sizeof length> head{};
  BITELINE_ASSIGN(const std::size_t head_bytes, read_up_to(fd, head, file));
  std::memcpy(&length, head.data(), sizeof length);
  if (head_bytes < head.size() || length > wire::k_max_message_bytes) return std::optional<wire::Message>{};
  wire::Bytes bytes(length);
  BITELINE_ASSIGN(const std::size_t got, read_up_to(fd, bytes, file));
  if (got < bytes.size()) return std::optional<wire::Message>{};
  Result<wire::Message> message = wire::decode(bytes);
  if (!message) return std::optional<wire::Message>{};
  size_bytes += head.size() + length;
  return std::optional<wire::Message>{std::move(*message)};
}

/// Where a host stands once it has `message` too.
void advance(ScanPosition& position, const wire::Message& message) {
  position.scan_id = message.scan_id;
  if (const auto* gap = std::get_if<wire::Gap>(&message.body)) {
    position.next_sequence = std::max(position.next_sequence, gap->first + gap->count);
  } else if (std::holds_alternative<profile::Profile>(message.body) ||
             std::holds_alternative<wire::EndOfScan>(message.body)) {
    position.next_sequence = message.sequence + 1;
  }
}

}  // namespace

Result<ScanJournal> ScanJournal::create(const fs::path& file) {
  const int fd = ::open(file.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0644);
  if (fd < 0) return fail_errno(write_code(errno), errno, "%s", file.c_str());
  ScanJournal journal{file, fd, k_magic.size()};
  BITELINE_TRY(report::lock_open_file(fd, file.string()));
  BITELINE_TRY(write_all(fd, {reinterpret_cast<const std::uint8_t*>(k_magic.data()), k_magic.size()}, file));
  return journal;
}

Result<ScanJournal::Recovered> ScanJournal::recover(const fs::path& file,
                                                    const std::function<void(wire::Message)>& on_message) {
  // A pipe would be waited for without end; a recording of a long scan may be of any size.
  BITELINE_TRY(check_regular_file(file, std::numeric_limits<std::uint64_t>::max()));
  const int fd = ::open(file.c_str(), O_RDWR | O_CLOEXEC);
  if (fd < 0) return fail_errno(Errc::FileUnreadable, errno, "%s", file.c_str());
  Recovered recovered{.journal = ScanJournal{file, fd, k_magic.size()}, .position = {}};
  BITELINE_TRY(report::lock_open_file(fd, file.string()));
  std::array<std::uint8_t, k_magic.size()> magic{};
  BITELINE_ASSIGN(const std::size_t magic_bytes, read_up_to(fd, magic, file));
  if (magic_bytes < magic.size() || std::memcmp(magic.data(), k_magic.data(), magic.size()) != 0) {
    return fail(Errc::BadFormat, "%s: not a recorded scan", file.c_str());
  }
  std::uint64_t& size_bytes = recovered.journal.size_bytes_;
  bool has_hello = false;
  while (true) {
    BITELINE_ASSIGN(std::optional<wire::Message> message, read_message(fd, file, size_bytes));
    if (!message) break;
    has_hello = has_hello || std::holds_alternative<wire::SensorHello>(message->body);
    if (!has_hello) break;
    advance(recovered.position, *message);
    on_message(std::move(*message));
  }
  if (!has_hello) return fail(Errc::BadFormat, "%s: a recorded scan without its beginning", file.c_str());
  const auto end = static_cast<std::uint64_t>(::lseek(fd, 0, SEEK_END));
  recovered.bytes_cut = end - size_bytes;
  if (::ftruncate(fd, static_cast<off_t>(size_bytes)) != 0 || ::lseek(fd, 0, SEEK_END) < 0) {
    return fail_errno(Errc::WriteFailed, errno, "%s", file.c_str());
  }
  return recovered;
}

ScanJournal::ScanJournal(ScanJournal&& other) noexcept
    : file_{std::move(other.file_)}, fd_{std::exchange(other.fd_, -1)}, size_bytes_{other.size_bytes_} {}

ScanJournal& ScanJournal::operator=(ScanJournal&& other) noexcept {
  std::swap(file_, other.file_);
  std::swap(fd_, other.fd_);
  std::swap(size_bytes_, other.size_bytes_);
  return *this;
}

ScanJournal::~ScanJournal() {
  if (fd_ >= 0) ::close(fd_);
}

Result<void> ScanJournal::append(std::span<const std::uint8_t> message) {
  wire::Bytes record;
  wire::make_scan_record(message, record);
  if (const Result<void> written = write_all(fd_, record, file_); !written) {
    // Half a record at the end would be cut by recover() anyway; without it the next append may succeed.
    if (::ftruncate(fd_, static_cast<off_t>(size_bytes_)) == 0) ::lseek(fd_, 0, SEEK_END);
    return written;
  }
  size_bytes_ += record.size();
  return {};
}

}  // namespace biteline::intake

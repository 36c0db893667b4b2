// SPDX-License-Identifier: MIT
#include "firmware/record/append_file.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <utility>

namespace biteline::record {
namespace {

Errc write_code(int sys_errno) {
  return sys_errno == ENOSPC || sys_errno == EDQUOT || sys_errno == EFBIG ? Errc::DiskFull
                                                                          : Errc::WriteFailed;
}

}  // namespace

Result<AppendFile> AppendFile::create(const std::filesystem::path& file) {
  const int number = ::open(file.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0644);
  if (number < 0) return fail_errno(write_code(errno), errno, "%s", file.c_str());
  return AppendFile{file, number};
}

AppendFile::AppendFile(AppendFile&& other) noexcept
    : file_{std::move(other.file_)},
      number_{std::exchange(other.number_, -1)},
      size_bytes_{other.size_bytes_} {}

AppendFile& AppendFile::operator=(AppendFile&& other) noexcept {
  std::swap(file_, other.file_);
  std::swap(number_, other.number_);
  std::swap(size_bytes_, other.size_bytes_);
  return *this;
}

AppendFile::~AppendFile() {
  if (number_ >= 0) ::close(number_);
}

Result<void> AppendFile::append(std::span<const std::uint8_t> piece) {
  const std::size_t piece_bytes = piece.size();
  while (!piece.empty()) {
    const ssize_t written = ::write(number_, piece.data(), piece.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) {
      const int reason = errno;
      if (::ftruncate(number_, static_cast<off_t>(size_bytes_)) == 0) ::lseek(number_, 0, SEEK_END);
      return fail_errno(write_code(reason), reason, "%s", file_.c_str());
    }
    piece = piece.subspan(static_cast<std::size_t>(written));
  }
  size_bytes_ += piece_bytes;
  return {};
}

Result<void> AppendFile::append(std::string_view piece) {
  return append(std::span{reinterpret_cast<const std::uint8_t*>(piece.data()), piece.size()});
}

}  // namespace biteline::record

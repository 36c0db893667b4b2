// SPDX-License-Identifier: MIT
#include "host/interfaces/api/exchange.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>

#include "host/report/report.hpp"

namespace biteline::api {
namespace {

namespace fs = std::filesystem;

void remove_file(const fs::path& file) {
  std::error_code gone;
  fs::remove(file, gone);
}

Result<void> append(const fs::path& file, std::string_view bytes, bool fresh) {
  const int fd = ::open(file.c_str(),
                        O_WRONLY | O_APPEND | O_NOFOLLOW | O_CLOEXEC | (fresh ? O_CREAT | O_EXCL : 0), 0600);
  if (fd < 0) return fail_errno(Errc::WriteFailed, errno, "%.200s", file.c_str());
  int fault = 0;
  while (!bytes.empty() && fault == 0) {
    const ssize_t now = ::write(fd, bytes.data(), bytes.size());
    if (now < 0 && errno != EINTR) fault = errno;
    if (now > 0) bytes.remove_prefix(static_cast<std::size_t>(now));
  }
  if (::close(fd) != 0 && fault == 0) fault = errno;
  if (fault == 0) return {};
  return fail_errno(fault == ENOSPC ? Errc::DiskFull : Errc::WriteFailed, fault, "%.200s", file.c_str());
}

}  // namespace

Exchange::Exchange(fs::path folder) : folder_{std::move(folder)} {
  std::error_code gone;
  fs::remove_all(folder_, gone);
}

Result<fs::path> Exchange::fresh(const char* kind) {
  BITELINE_TRY(report::prepare_folder(folder_));
  return folder_ / (std::string{kind} + "-" + std::to_string(++made_) + ".tar");
}

Result<void> Exchange::add(const std::string& owner, std::uint64_t at, std::string_view piece) {
  forget_idle();
  if (at == 0) {
    drop(owner);
    if (uploads_.size() >= k_most_uploads)
      return fail(Errc::WrongState, "%zu files are being brought already: wait a minute", uploads_.size());
    BITELINE_ASSIGN(const fs::path file, fresh("in"));
    uploads_.push_back({.owner = owner, .file = file, .bytes = 0, .last = {}});
  }
  const auto upload = std::ranges::find(uploads_, owner, &Upload::owner);
  if (upload == uploads_.end())
    return fail(Errc::WrongState, "no file is being brought, or it was waited for too long: begin anew");
  if (upload->bytes != at || piece.size() > k_most_bytes - at) {
    drop(owner);
    return fail(Errc::WrongState, "a piece at byte %llu does not fit, or the file has more than %llu bytes",
                static_cast<unsigned long long>(at), static_cast<unsigned long long>(k_most_bytes));
  }
  if (const Result<void> written = append(upload->file, piece, at == 0); !written) {
    drop(owner);
    return written;
  }
  upload->bytes += piece.size();
  upload->last = Clock::now();
  return {};
}

fs::path Exchange::brought_by(const std::string& owner) const {
  const auto upload = std::ranges::find(uploads_, owner, &Upload::owner);
  return upload == uploads_.end() ? fs::path{} : upload->file;
}

void Exchange::drop(const std::string& owner) {
  std::erase_if(uploads_, [&](const Upload& upload) {
    if (upload.owner != owner) return false;
    remove_file(upload.file);
    return true;
  });
}

Result<fs::path> Exchange::outgoing() {
  if (downloads_.size() >= k_most_downloads) {
    remove_file(downloads_.front());
    downloads_.erase(downloads_.begin());
  }
  BITELINE_ASSIGN(const fs::path file, fresh("out"));
  downloads_.push_back(file);
  return file;
}

void Exchange::forget_idle(Clock::time_point now) {
  std::erase_if(uploads_, [&](const Upload& upload) {
    if (now - upload.last < k_idle) return false;
    remove_file(upload.file);
    return true;
  });
}

}  // namespace biteline::api

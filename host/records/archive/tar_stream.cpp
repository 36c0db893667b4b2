// SPDX-License-Identifier: MIT
#include "host/records/archive/tar_stream.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>

#include "host/records/archive/tar_block.hpp"

namespace biteline::archive {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t k_most_files = 10'000;
constexpr std::uint64_t k_most_file_bytes = 1ULL << 33U;  // eleven octal digits
constexpr std::uint64_t k_end_bytes = 2 * tar::k_block;

std::uint64_t padded(std::uint64_t bytes) {
  return (bytes + tar::k_block - 1) / tar::k_block * tar::k_block;
}

/// Reads `size` bytes of a file from `at` on behind `out`; what was read does not stay in the memory that
/// others need.
Result<void> read_some(const fs::path& file, std::uint64_t at, std::size_t size, std::string& out) {
  const int fd = ::open(file.c_str(), O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC);
  if (fd < 0)
    return fail_errno(errno == ENOENT ? Errc::FileNotFound : Errc::FileUnreadable, errno, "%.200s",
                      file.c_str());
  const std::size_t begin = out.size();
  out.resize(begin + size);
  std::size_t done = 0;
  int read_errno = 0;
  while (done < size) {
    const ssize_t now = ::pread(fd, out.data() + begin + done, size - done, static_cast<off_t>(at + done));
    if (now < 0 && errno == EINTR) continue;
    if (now < 0) read_errno = errno;
    if (now <= 0) break;
    done += static_cast<std::size_t>(now);
  }
  ::posix_fadvise(fd, static_cast<off_t>(at), static_cast<off_t>(size), POSIX_FADV_DONTNEED);
  ::close(fd);
  if (done == size) return {};
  if (read_errno != 0) return fail_errno(Errc::FileUnreadable, read_errno, "%.200s", file.c_str());
  return fail(Errc::SizeMismatch, "%.200s has become shorter", file.c_str());
}

}  // namespace

Result<TarStream> TarStream::open(const fs::path& folder, std::uint64_t most_bytes) {
  std::error_code error;
  if (!fs::is_directory(fs::symlink_status(folder, error)))
    return fail(Errc::FileNotFound, "%.200s: no such folder", folder.c_str());
  TarStream stream;
  for (fs::recursive_directory_iterator at{folder, error}, end; !error && at != end; at.increment(error)) {
    const std::string plain = at->path().filename().string();
    const fs::file_status status = at->symlink_status(error);
    if (plain.starts_with('.')) {
      if (fs::is_directory(status)) at.disable_recursion_pending();
      continue;
    }
    if (error || !fs::is_regular_file(status)) continue;
    File file{.name = folder.filename().string() + "/" + at->path().lexically_relative(folder).string(),
              .path = at->path(),
              .bytes = at->file_size(error)};
    if (error) break;
    if (!tar::good_name(file.name))
      return fail(Errc::BadValue, "%.200s: no name for an archive", file.path.c_str());
    if (stream.files_.size() >= k_most_files || file.bytes >= k_most_file_bytes)
      return fail(Errc::SizeMismatch, "%.200s: more than %zu files, or one above 8 GB", folder.c_str(),
                  k_most_files);
    stream.files_.push_back(std::move(file));
  }
  if (error) return fail_errno(Errc::FileUnreadable, error.value(), "%.200s", folder.c_str());
  std::ranges::sort(stream.files_, {}, &File::name);
  for (File& file : stream.files_) {
    file.begin = stream.bytes_;
    stream.bytes_ += tar::k_block + padded(file.bytes);
  }
  stream.bytes_ += k_end_bytes;
  if (stream.bytes_ > most_bytes)
    return fail(Errc::SizeMismatch, "%.200s: %llu bytes, at most %llu", folder.c_str(),
                static_cast<unsigned long long>(stream.bytes_), static_cast<unsigned long long>(most_bytes));
  return stream;
}

Result<void> TarStream::add_file(const File& file, std::uint64_t at, std::string& out,
                                 std::size_t most) const {
  std::uint64_t within = at - file.begin;
  if (within < tar::k_block) {
    const tar::Block header = tar::header_of(file.name, file.bytes);
    const std::size_t size = std::min<std::uint64_t>(tar::k_block - within, most - out.size());
    out.append(header.data() + within, size);
    within += size;
  }
  if (within >= tar::k_block && within < tar::k_block + file.bytes) {
    const std::uint64_t from = within - tar::k_block;
    const std::size_t size = std::min<std::uint64_t>(file.bytes - from, most - out.size());
    BITELINE_TRY(read_some(file.path, from, size, out));
    within += size;
  }
  const std::uint64_t end = tar::k_block + padded(file.bytes);
  if (within >= tar::k_block + file.bytes)
    out.append(std::min<std::uint64_t>(end - within, most - out.size()), '\0');
  return {};
}

Result<std::string> TarStream::read(std::uint64_t at, std::size_t most) const {
  std::string out;
  if (at >= bytes_) return out;
  most = std::min<std::uint64_t>(most, bytes_ - at);
  // The last one that begins at or before `at`.
  auto file = std::ranges::upper_bound(files_, at, {}, &File::begin);
  if (file != files_.begin()) --file;
  for (; file != files_.end() && out.size() < most; ++file) {
    const std::uint64_t end = file->begin + tar::k_block + padded(file->bytes);
    if (at + out.size() < end) BITELINE_TRY(add_file(*file, at + out.size(), out, most));
  }
  out.resize(most, '\0');  // the two empty blocks at its end
  return out;
}

}  // namespace biteline::archive

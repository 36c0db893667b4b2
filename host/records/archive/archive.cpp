// SPDX-License-Identifier: MIT
#include "host/records/archive/archive.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>
#include <vector>

#include "common/system/file.hpp"
#include "common/wire/checksum.hpp"
#include "host/records/archive/tar_block.hpp"
#include "host/report/report.hpp"

namespace biteline::archive {
namespace {

namespace fs = std::filesystem;
using namespace tar;
using nlohmann::json;

constexpr const char* k_list_file = "biteline.json";
constexpr int k_format = 1;
constexpr std::size_t k_most_files = 10'000;
constexpr std::size_t k_most_list_bytes = 8 << 20;

struct Fd {
  explicit Fd(int descriptor) : fd{descriptor} {}
  Fd(const Fd&) = delete;
  Fd& operator=(const Fd&) = delete;
  ~Fd() {
    if (fd >= 0) ::close(fd);
  }
  int fd;
};

std::string checksum_of(const std::string& bytes) {
  char text[9];
  std::snprintf(text, sizeof text, "%08x",
                wire::crc32c({reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()}));
  return text;
}

std::string text_of(const Block& block, const Field& field) {
  const char* begin = block.data() + field.at;
  return {begin, ::strnlen(begin, field.bytes)};
}

std::optional<std::uint64_t> octal_of(const Block& block, const Field& field) {
  std::uint64_t number = 0;
  bool any = false;
  for (const char c : text_of(block, field)) {
    if (c == ' ') continue;
    if (c < '0' || c > '7' || number >> 60 != 0) return std::nullopt;
    number = 8 * number + static_cast<std::uint64_t>(c - '0');
    any = true;
  }
  return any ? std::optional{number} : std::nullopt;
}

class Writer {
 public:
  Writer(int fd, const fs::path& target) : fd_{fd}, target_{target} {}

  [[nodiscard]] Result<void> add(const std::string& name, const std::string& bytes) {
    const Block header = header_of(name, bytes.size());
    BITELINE_TRY(put_bytes(header.data(), header.size()));
    BITELINE_TRY(put_bytes(bytes.data(), bytes.size()));
    const Block zeros{};
    return put_bytes(zeros.data(), (k_block - bytes.size() % k_block) % k_block);
  }
  [[nodiscard]] Result<void> end() {
    const Block zeros{};
    BITELINE_TRY(put_bytes(zeros.data(), zeros.size()));
    BITELINE_TRY(put_bytes(zeros.data(), zeros.size()));
    return ::fsync(fd_) == 0 ? Result<void>{} : failed();
  }

 private:
  [[nodiscard]] Result<void> failed() const {
    return fail_errno(errno == ENOSPC ? Errc::DiskFull : Errc::WriteFailed, errno, "%.200s", target_.c_str());
  }
  [[nodiscard]] Result<void> put_bytes(const char* bytes, std::size_t size) {
    for (std::size_t done = 0; done < size;) {
      const ssize_t now = ::write(fd_, bytes + done, size - done);
      if (now < 0 && errno == EINTR) continue;
      if (now < 0) return failed();
      done += static_cast<std::size_t>(now);
    }
    return {};
  }
  int fd_;
  const fs::path& target_;
};

class Reader {
 public:
  Reader(int fd, const fs::path& file) : fd_{fd}, file_{file} {}

  [[nodiscard]] Result<void> take(char* bytes, std::size_t size) {
    for (std::size_t done = 0; done < size;) {
      const ssize_t now = ::read(fd_, bytes + done, size - done);
      if (now < 0 && errno == EINTR) continue;
      if (now < 0) return fail_errno(Errc::FileUnreadable, errno, "%.200s", file_.c_str());
      if (now == 0) return fail(Errc::BadFormat, "%.200s is cut short", file_.c_str());
      done += static_cast<std::size_t>(now);
    }
    return {};
  }
  /// The next entry's bytes; an empty name: the end.
  [[nodiscard]] Result<std::string> next(std::string& name) {
    Block header{};
    BITELINE_TRY(take(header.data(), header.size()));
    name.clear();
    if (std::ranges::all_of(header, [](char c) { return c == 0; })) return std::string{};
    const std::optional<std::uint64_t> sum = octal_of(header, k_sum), bytes = octal_of(header, k_size);
    if (text_of(header, k_magic).rfind("ustar", 0) != 0 || !sum || *sum != sum_of(header))
      return fail(Errc::BadFormat, "%.200s: no tar file, or a damaged one", file_.c_str());
    std::string found = text_of(header, k_name);
    if (!good_name(found) || header[k_kind.at] != '0')
      return fail(Errc::BadFormat, "%.200s: it holds more than plain files of plain names", file_.c_str());
    if (!bytes || *bytes > k_most_cloud_bytes || *bytes > rest())
      return fail(Errc::BadFormat, "%.200s is cut short at %s", file_.c_str(), found.c_str());
    std::string content(static_cast<std::size_t>(*bytes), '\0');
    BITELINE_TRY(take(content.data(), content.size()));
    Block padding{};
    BITELINE_TRY(take(padding.data(), (k_block - content.size() % k_block) % k_block));
    name = std::move(found);
    return content;
  }

 private:
  /// Bytes that are still to be read: no more room is taken for a size that only is told.
  [[nodiscard]] std::uint64_t rest() const {
    struct stat state {};
    const off_t at = ::lseek(fd_, 0, SEEK_CUR);
    return ::fstat(fd_, &state) == 0 && state.st_size > at ? static_cast<std::uint64_t>(state.st_size - at)
                                                           : 0;
  }
  int fd_;
  const fs::path& file_;
};

struct Seen {
  std::uint64_t bytes{0};
  std::string checksum;
};

/// biteline.json against what was unpacked.
Result<About> compare(const std::string& text, const std::string& kind,
                      const std::map<std::string, Seen>& seen, const fs::path& file) {
  // nlohmann reports by exceptions: caught here, at the one call.
  try {
    const json list = json::parse(text);
    if (list.at("format").get<int>() != k_format) {
      return fail(Errc::NotSupported, "%.200s: format %d, expected %d: made by a newer program", file.c_str(),
                  list.at("format").get<int>(), k_format);
    }
    About about{.kind = list.at("kind").get<std::string>(),
                .program = list.value("program", ""),
                .time = list.value("time", ""),
                .more = {}};
    if (about.kind != kind)
      return fail(Errc::BadFormat, "%.200s is a %.20s, expected a %s", file.c_str(), about.kind.c_str(),
                  kind.c_str());
    const json more = list.value("more", json::object());
    for (const auto& [name, value] : more.items()) about.more[name] = value.get<std::string>();
    if (list.at("files").size() != seen.size())
      return fail(Errc::SizeMismatch, "%.200s holds %zu files, expected %zu", file.c_str(), seen.size(),
                  list.at("files").size());
    for (const json& row : list.at("files")) {
      const auto name = row.at("name").get<std::string>();
      const auto found = seen.find(name);
      if (found == seen.end() || found->second.bytes != row.at("bytes").get<std::uint64_t>())
        return fail(Errc::SizeMismatch, "%.200s: %.100s is missing or has another size", file.c_str(),
                    name.c_str());
      if (found->second.checksum != row.at("crc32c").get<std::string>())
        return fail(Errc::BadValue, "%.200s: %.100s does not match its checksum", file.c_str(), name.c_str());
    }
    return about;
  } catch (const json::exception& error) {
    return fail(Errc::BadFormat, "%.200s: %s: %.200s", file.c_str(), k_list_file, error.what());
  }
}

}  // namespace

Result<void> write(const fs::path& target, const About& about, std::span<const Entry> entries) {
  if (entries.size() > k_most_files)
    return fail(Errc::InvalidArgument, "%.200s: %zu files, at most %zu", target.c_str(), entries.size(),
                k_most_files);
  const fs::path beside = target.string() + ".part";
  const Fd out{::open(beside.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_NOFOLLOW | O_CLOEXEC, 0600)};
  if (out.fd < 0) return fail_errno(Errc::WriteFailed, errno, "%.200s", beside.c_str());
  const auto written = [&]() -> Result<void> {
    Writer writer{out.fd, target};
    json files = json::array();
    for (const Entry& entry : entries) {
      if (!good_name(entry.name) || entry.name == k_list_file)
        return fail(Errc::InvalidArgument, "%.100s: no name for an archive", entry.name.c_str());
      BITELINE_ASSIGN(const std::string bytes, read_regular_file(entry.file, k_most_cloud_bytes));
      BITELINE_TRY(writer.add(entry.name, bytes));
      files.push_back({{"name", entry.name}, {"bytes", bytes.size()}, {"crc32c", checksum_of(bytes)}});
    }
    const json list{{"format", k_format}, {"kind", about.kind}, {"program", about.program},
                    {"time", about.time}, {"more", about.more}, {"files", std::move(files)}};
    BITELINE_TRY(writer.add(k_list_file, list.dump(1) + "\n"));
    return writer.end();
  }();
  if (written && ::rename(beside.c_str(), target.c_str()) == 0) return {};
  const int rename_errno = errno;
  ::unlink(beside.c_str());
  if (!written) return written;
  return fail_errno(Errc::WriteFailed, rename_errno, "%.200s", target.c_str());
}

Result<About> unpack(const fs::path& file, const std::string& kind, const fs::path& folder) {
  BITELINE_TRY(check_regular_file(file, std::numeric_limits<std::uint64_t>::max()));
  const Fd in{::open(file.c_str(), O_RDONLY | O_CLOEXEC)};
  if (in.fd < 0) return fail_errno(Errc::FileNotFound, errno, "%.200s", file.c_str());
  BITELINE_TRY(report::prepare_folder(folder));
  Reader reader{in.fd, file};
  std::map<std::string, Seen> seen;
  for (std::string name;;) {
    BITELINE_ASSIGN(const std::string bytes, reader.next(name));
    if (name.empty())
      return fail(Errc::BadFormat, "%.200s: no %s at its end: not made by biteline", file.c_str(),
                  k_list_file);
    if (name == k_list_file) {
      if (bytes.size() > k_most_list_bytes)
        return fail(Errc::BadFormat, "%.200s: %s is too long", file.c_str(), name.c_str());
      return compare(bytes, kind, seen, file);
    }
    if (seen.size() >= k_most_files || seen.contains(name))
      return fail(Errc::BadFormat, "%.200s: too many files, or one twice", file.c_str());
    std::error_code error;
    fs::create_directories((folder / name).parent_path(), error);
    if (error) return fail_errno(Errc::WriteFailed, error.value(), "%.200s", (folder / name).c_str());
    BITELINE_TRY(report::write_file_atomically(folder / name, bytes));
    seen[name] = {.bytes = bytes.size(), .checksum = checksum_of(bytes)};
  }
}

}  // namespace biteline::archive

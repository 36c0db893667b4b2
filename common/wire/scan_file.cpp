// SPDX-License-Identifier: MIT
#include "common/wire/scan_file.hpp"

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <memory>
#include <utility>

#include "common/system/file.hpp"

namespace biteline::wire {
namespace {

using Length = std::uint32_t;

struct FileCloser {
  void operator()(std::FILE* file) const { std::fclose(file); }
};

bool read_all(std::FILE* file, void* out, std::size_t size_bytes) {
  return std::fread(out, 1, size_bytes, file) == size_bytes;
}

}  // namespace

void make_scan_record(std::span<const std::uint8_t> message, Bytes& out) {
  const auto length = static_cast<Length>(message.size());
  out.resize(sizeof length + message.size());
  for (std::size_t i = 0; i < sizeof length; ++i) out[i] = static_cast<std::uint8_t>(length >> (8 * i));
  std::memcpy(out.data() + sizeof length, message.data(), message.size());
}

Result<ScanFileEnd> read_scan_file(
    const std::filesystem::path& file,
    const std::function<Result<void>(Message message, std::span<const std::uint8_t> bytes)>& on_message) {
  BITELINE_TRY(check_regular_file(file, k_most_cloud_bytes));
  const std::unique_ptr<std::FILE, FileCloser> in{std::fopen(file.c_str(), "rb")};
  if (!in) return fail_errno(Errc::FileUnreadable, errno, "%s", file.c_str());
  char magic[k_scan_file_magic.size()];
  if (!read_all(in.get(), magic, sizeof magic) ||
      std::string_view{magic, sizeof magic} != k_scan_file_magic) {
    return fail(Errc::BadFormat, "%s: not a recorded scan", file.c_str());
  }
  std::uint64_t good_bytes = sizeof magic;
  ScanFileEnd end;
  Bytes bytes;
  for (;;) {
    std::uint8_t head[sizeof(Length)];
    if (!read_all(in.get(), head, sizeof head)) break;
    Length length = 0;
    for (std::size_t i = 0; i < sizeof head; ++i) length |= static_cast<Length>(head[i]) << (8 * i);
    if (length > k_max_message_bytes) break;
    bytes.resize(length);
    if (!read_all(in.get(), bytes.data(), length)) break;
    Result<Message> message = decode(bytes);
    if (!message) break;
    if (end.messages == 0 && !std::holds_alternative<SensorHello>(message->body)) break;
    good_bytes += sizeof head + length;
    ++end.messages;
    BITELINE_TRY(on_message(std::move(*message), bytes));
  }
  if (end.messages == 0) {
    return fail(Errc::BadFormat, "%s: a recorded scan without its beginning", file.c_str());
  }
  std::fseek(in.get(), 0, SEEK_END);
  end.bytes_left = static_cast<std::uint64_t>(std::ftell(in.get())) - good_bytes;
  return end;
}

}  // namespace biteline::wire

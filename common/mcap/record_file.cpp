// SPDX-License-Identifier: MIT
#include "common/mcap/record_file.hpp"

#include <algorithm>
#include <cerrno>
#include <limits>

#include "common/system/file.hpp"

namespace biteline::mcap {

Result<RecordFile> RecordFile::open(const std::filesystem::path& file) {
  BITELINE_TRY(check_regular_file(file, std::numeric_limits<std::int64_t>::max()));
  std::FILE* const in = std::fopen(file.c_str(), "rb");
  if (in == nullptr) return fail_errno(Errc::FileUnreadable, errno, "%s", file.c_str());
  RecordFile opened{in};
  std::error_code error;
  opened.size_ = std::filesystem::file_size(file, error);
  std::array<std::uint8_t, k_magic.size()> magic{};
  if (error || !opened.read(magic.data(), magic.size()) || magic != k_magic) {
    return fail(Errc::BadFormat, "%s: not an MCAP file", file.c_str());
  }
  return opened;
}

bool RecordFile::read(std::uint8_t* out, std::size_t count) {
  if (std::fread(out, 1, count, file_.get()) != count) return false;
  position_ += count;
  return true;
}

Result<std::optional<RecordFile::Record>> RecordFile::next() {
  if (after_footer_) return end();
  const std::uint64_t start = position_, left = size_ - std::min(size_, position_);
  if (left == 0) return fail(Errc::Truncated, "it has no end");
  std::array<std::uint8_t, k_record_head_bytes> head{};
  if (left < head.size() || !read(head.data(), head.size())) {
    position_ = start;
    return fail(Errc::Truncated, "it ends in a record's head");
  }
  std::uint64_t length = 0;
  for (std::size_t i = 0; i < 8; ++i) length |= std::uint64_t{head.at(1 + i)} << (8 * i);
  if (length > left - head.size()) {
    position_ = start;
    return fail(Errc::Truncated, "a %s goes beyond the file's end", name_of(head[0]).c_str());
  }
  if (head[0] == 0 || length > k_most_record_bytes) {
    position_ = start;
    return fail(Errc::BadFormat, "a %s of %llu bytes; at most %llu are read", name_of(head[0]).c_str(),
                static_cast<unsigned long long>(length),
                static_cast<unsigned long long>(k_most_record_bytes));
  }
  whole_.resize(head.size() + static_cast<std::size_t>(length));
  std::copy(head.begin(), head.end(), whole_.begin());
  if (!read(whole_.data() + head.size(), static_cast<std::size_t>(length))) {
    position_ = start;
    return fail(Errc::Truncated, "it became shorter while it was read");
  }
  after_footer_ = head[0] == static_cast<std::uint8_t>(Opcode::Footer);
  return Record{
      .opcode = head[0], .start = start, .whole = whole_, .content = View{whole_}.subspan(head.size())};
}

Result<std::optional<RecordFile::Record>> RecordFile::end() {
  const std::uint64_t start = position_;
  std::array<std::uint8_t, k_magic.size()> magic{};
  if (size_ < start + magic.size()) return fail(Errc::Truncated, "it ends behind its footer");
  if (!read(magic.data(), magic.size()) || magic != k_magic || position_ != size_) {
    position_ = start;
    return fail(Errc::BadFormat, "other bytes than the closing ones behind its footer");
  }
  return std::optional<Record>{};
}

}  // namespace biteline::mcap

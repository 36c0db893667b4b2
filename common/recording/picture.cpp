// SPDX-License-Identifier: MIT
#include "common/recording/picture.hpp"

#include <string_view>

#include "common/recording/cdr.hpp"

namespace biteline::recording {
namespace {

class Take {
 public:
  explicit Take(std::span<const std::uint8_t> bytes) : bytes_{bytes} {}

  std::uint32_t whole() {
    at_ = (at_ + 3) / 4 * 4;
    const std::span<const std::uint8_t> raw = next(4);
    std::uint32_t value = 0;
    for (std::size_t i = 0; i < raw.size(); ++i) value |= std::uint32_t{raw[i]} << (8 * i);
    return value;
  }
  /// Text or bytes: a length and as many.
  std::span<const std::uint8_t> counted() { return next(whole()); }
  [[nodiscard]] bool good() const { return good_; }

 private:
  std::span<const std::uint8_t> next(std::size_t count) {
    good_ = good_ && at_ <= bytes_.size() && count <= bytes_.size() - at_;
    if (!good_) return {};
    const auto taken = bytes_.subspan(at_, count);
    at_ += count;
    return taken;
  }
  std::span<const std::uint8_t> bytes_;
  std::size_t at_{0};
  bool good_{true};
};

}  // namespace

std::vector<std::uint8_t> picture_message(std::int64_t stamp_ns, std::span<const std::uint8_t> file) {
  CdrWriter out{file.size() + 64};
  out.put_header(stamp_ns, "cam0");
  out.put_text("png");
  out.put_bytes(file);
  return out.take();
}

Result<std::span<const std::uint8_t>> picture_file_of(std::span<const std::uint8_t> message) {
  if (message.size() < k_cdr_head_bytes || message[0] != 0 || message[1] != 1)
    return fail(Errc::BadFormat, "a picture as little-endian CDR expected");
  Take take{message.subspan(k_cdr_head_bytes)};
  take.whole();
  take.whole();
  take.counted();
  const std::span<const std::uint8_t> format = take.counted();
  const std::span<const std::uint8_t> file = take.counted();
  if (!take.good()) return fail(Errc::BadFormat, "a picture that does not hold its fields");
  if (std::string_view{reinterpret_cast<const char*>(format.data()), format.size()} !=
      std::string_view{"png", 4}) {
    return fail(Errc::NotSupported, "a picture's format: png expected");
  }
  return file;
}

}  // namespace biteline::recording

// SPDX-License-Identifier: MIT
#include "common/rtde/package.hpp"

#include <algorithm>

#include "common/core/contracts.hpp"

namespace biteline::rtde {

bool is_known(PackageType type) {
  switch (type) {
    case PackageType::SetupInputs:
    case PackageType::TextMessage:
    case PackageType::SetupOutputs:
    case PackageType::Pause:
    case PackageType::Start:
    case PackageType::Data:
    case PackageType::ProtocolVersion:
    case PackageType::ControllerVersion:
      return true;
  }
  return false;
}

std::size_t PackageSplitter::feed(ByteView bytes) {
  if (begin_ > 0) {
    std::copy(buffer_.begin() + static_cast<std::ptrdiff_t>(begin_),
              buffer_.begin() + static_cast<std::ptrdiff_t>(end_), buffer_.begin());
    end_ -= begin_;
    begin_ = 0;
  }
  const std::size_t taken = std::min(bytes.size(), buffer_.size() - end_);
  std::copy_n(bytes.begin(), taken, buffer_.begin() + static_cast<std::ptrdiff_t>(end_));
  end_ += taken;
  return taken;
}

Result<std::optional<Package>> PackageSplitter::next() {
  if (broken_) return fail(Errc::ProtocolError, "RTDE stream is out of step");
  const ByteView waiting{buffer_.data() + begin_, end_ - begin_};
  if (waiting.size() < k_header_bytes) return std::nullopt;
  const std::size_t size = static_cast<std::size_t>(waiting[0]) << 8U | waiting[1];
  // The first package that makes no sense shows before its body is waited for.
  if (size < k_header_bytes) {
    broken_ = true;
    return fail(Errc::ProtocolError, "RTDE header: size %zu, type %u", size,
                static_cast<unsigned>(waiting[2]));
  }
  if (waiting.size() < size) return std::nullopt;
  begin_ += size;
  return Package{.type = static_cast<PackageType>(waiting[2]),
                 .payload = waiting.subspan(k_header_bytes, size - k_header_bytes)};
}

void PackageSplitter::reset() {
  begin_ = end_ = 0;
  broken_ = false;
}

void append_package(Bytes& out, PackageType type, ByteView payload) {
  BITELINE_EXPECTS(payload.size() + k_header_bytes <= k_max_package_bytes);
  Writer writer{out};
  writer.put(static_cast<std::uint16_t>(payload.size() + k_header_bytes));
  writer.put(static_cast<std::uint8_t>(type));
  out.insert(out.end(), payload.begin(), payload.end());
}

}  // namespace biteline::rtde

// SPDX-License-Identifier: MIT
#include "host/apps/biteline-host/kept_recordings.hpp"

#include <charconv>

namespace biteline::service {
namespace {

constexpr unsigned k_most_apart = 1'000'000;

}  // namespace

Result<KeptRecordings> KeptRecordings::parse(const std::string& words) {
  KeptRecordings kept;
  if (words == "none") return kept;
  if (words == "all") {
    kept.which_ = Which::All;
    return kept;
  }
  if (words == "refused") {
    kept.which_ = Which::Refused;
    return kept;
  }
  kept.which_ = Which::EachNth;
  const char* end = words.data() + words.size();
  const auto [at, error] = std::from_chars(words.data(), end, kept.each_);
  if (error != std::errc{} || at != end || kept.each_ < 1 || kept.each_ > k_most_apart)
    return fail(Errc::InvalidArgument,
                "--keep-recordings '%.40s': all, refused, none or a whole number from 1 to %u expected",
                words.c_str(), k_most_apart);
  return kept;
}

bool KeptRecordings::keeps(bool refused) {
  ++ended_;
  switch (which_) {
    case Which::None:
      return false;
    case Which::All:
      return true;
    case Which::Refused:
      return refused;
    case Which::EachNth:
      return ended_ % each_ == 0;
  }
  return false;
}

}  // namespace biteline::service

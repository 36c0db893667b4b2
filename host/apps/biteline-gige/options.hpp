// SPDX-License-Identifier: MIT
#pragma once
/// \file The command line of biteline-gige.

#include <optional>

#include "host/interfaces/gige/feed.hpp"

namespace biteline::gige {

struct Options {
  FeedConfig feed;
  ServerConfig server;
  bool ask_for_cameras{false};  ///< no --camera: whoever answers on the network may be the camera
  bool exit_with_parent{false};
};

struct ParsedOptions {
  Options options;
  std::optional<int> leave_with;  ///< help, version, or a fault that was told
};

[[nodiscard]] ParsedOptions parse_options(int argc, char** argv);

}  // namespace biteline::gige

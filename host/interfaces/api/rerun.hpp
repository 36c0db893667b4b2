// SPDX-License-Identifier: MIT
#pragma once
/// \file A kept scan worked out again: what is asked, and where the outcome stands beside the scan's result.
///
/// `rerun-1`, `rerun-2`, ... in the scan's folder.  `rerun.json` there holds the order, `report.json` the
/// outcome, `path/` the planned path.  Nothing outside that folder changes, and none of it is ever sent.

#include <filesystem>
#include <functional>
#include <optional>
#include <string>

#include "host/interfaces/control/messages.hpp"

namespace biteline::api {

struct RerunOrder {
  std::string scan;
  std::string model;    ///< its line is carried over; empty: none is
  std::string method;   ///< "default" or "published": the line is looked for anew; empty: it stays as it is
  std::string process;  ///< empty: the model's own, else the service's
  bool mirror{false};   ///< the model is of the other foot
  bool grade{false};    ///< the model is of another size
  std::string who, why, door;
};

inline constexpr const char* k_rerun_file = "rerun.json";
/// A scan's folder holds no more of them.
inline constexpr int k_most_reruns = 20;

/// Relative to the scan's folder.
[[nodiscard]] std::filesystem::path rerun_folder(int number);

/// `settings` of the API; what was not given is left out.
[[nodiscard]] control::Json settings_json(const RerunOrder& order);

/// Makes the next folder and writes the order into it; its number.  Errc::WrongState beyond the limit.
[[nodiscard]] Result<int> keep_order(const std::filesystem::path& scan, const RerunOrder& order);

/// `Rerun`s of the API, oldest first.  `open`: it waits or is worked on.
[[nodiscard]] control::Json reruns_json(const std::filesystem::path& scan,
                                        const std::function<bool(int number)>& open);

}  // namespace biteline::api

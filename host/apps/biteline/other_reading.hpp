// SPDX-License-Identifier: MIT
#pragma once
/// \file A cloud that gives no line as it was read, and does with another unit or another axis up.

#include <filesystem>
#include <optional>

#include "host/apps/biteline/method.hpp"
#include "host/bite_line/refused.hpp"
#include "host/cloud/cloud_file.hpp"
#include "host/report/refusal.hpp"

namespace biteline::app {

/// Whether wrong axes could be the reason: what was found is no shoe, or not all round.
[[nodiscard]] bool may_lie_otherwise(bite_line::Refused refused);

/// Looks for a line with each axis up, in the units that make the cloud a shoe unless the unit is known, and
/// names the options of the surest one.  None: no reading helps.  Nothing is turned: a person decides.  Some
/// tenths of a second for each million points, and only on a refusal.
[[nodiscard]] std::optional<report::ToldRefusal> other_reading(const std::filesystem::path& path,
                                                               const cloud::Reading& reading,
                                                               const cloud::CloudFile& file);

}  // namespace biteline::app

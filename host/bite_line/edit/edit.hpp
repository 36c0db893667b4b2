// SPDX-License-Identifier: MIT
#pragma once
/// \file A line mended by a person's steps.

#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "host/bite_line/edit/refused.hpp"
#include "host/bite_line/edit/splice.hpp"
#include "host/bite_line/edit/steps.hpp"
#include "host/bite_line/edit/surface.hpp"
#include "host/cloud/closed_line.hpp"

namespace biteline::edit {

/// The line of an older version, if one is kept.
using OldLine = std::function<std::optional<cloud::ClosedLine>(int line_version)>;

/// Who takes the steps.
enum class By {
  Person,  ///< has looked at the shoe: what it takes or leads is by hand, whatever the method thought of it
  Model,   ///< no point becomes surer by it
};

/// `base`: the version that is mended, base frame, mm; empty where the scan was refused.  One step after the
/// other; lengths are those of `base`.  The refusal names the step that cannot be done.  `snaps` (optional):
/// what became of every point that a hand has set, in order.
[[nodiscard]] OrRefusal<cloud::ClosedLine> mend(const Surface& surface, const cloud::ClosedLine& base,
                                                std::span<const Step> steps, const OldLine& old_line,
                                                By by = By::Person, std::vector<Snap>* snaps = nullptr);

/// The stretch about the points of a step that names none: so far to either side of them along the line.
[[nodiscard]] Stretch stretch_about(const cloud::ClosedLine& line, std::span<const Vec3> points);

}  // namespace biteline::edit

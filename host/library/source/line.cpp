// SPDX-License-Identifier: MIT
#include "biteline/line.hpp"

#include "host/bite_line/find_bite_line.hpp"
#include "host/cloud/closed_line.hpp"
#include "host/library/source/inside.hpp"

namespace biteline::sdk {
namespace {

/// The same names in the same order (checked below).
Source from_inside(cloud::PointSource source) {
  return static_cast<Source>(source);
}
static_assert(static_cast<int>(Source::Seen) == static_cast<int>(cloud::PointSource::Seen));
static_assert(static_cast<int>(Source::Bridged) == static_cast<int>(cloud::PointSource::Bridged));
static_assert(static_cast<int>(Source::Carried) == static_cast<int>(cloud::PointSource::Carried));
static_assert(static_cast<int>(Source::Mended) == static_cast<int>(cloud::PointSource::Mended));

}  // namespace

Line from_inside(const cloud::ClosedLine& line) {
  Line out;
  out.points.reserve(line.points.size());
  for (const cloud::LinePoint& point : line.points)
    out.points.push_back({.position_mm = point.position,
                          .normal = point.normal,
                          .tangent = point.tangent,
                          .confidence = point.confidence,
                          .u95_mm = point.u95_mm,
                          .unsure = (point.flags & cloud::k_line_unsure) != 0,
                          .source = from_inside(point.source)});
  return out;
}

cloud::ClosedLine to_inside(const Line& line) {
  if (line.points.size() < 3) throw Error{"line: fewer than 3 points", "give a closed line"};
  cloud::ClosedLine out;
  out.points.reserve(line.points.size());
  for (const LinePoint& point : line.points) {
    if (!point.position_mm.allFinite() || !point.normal.allFinite() || !point.tangent.allFinite())
      throw Error{"line: point " + std::to_string(out.points.size()) + " is not finite", "leave it out"};
    out.points.push_back({.position = point.position_mm,
                          .normal = point.normal,
                          .tangent = point.tangent,
                          .confidence = point.confidence,
                          .u95_mm = point.u95_mm,
                          .flags = point.unsure ? cloud::k_line_unsure : 0U,
                          .source = static_cast<cloud::PointSource>(point.source)});
  }
  return out;
}

double length_mm(const Line& line) {
  return cloud::length_mm(to_inside(line));
}

Line read_line(const std::filesystem::path& file) {
  return from_inside(or_throw(cloud::read_line(file)));
}

void write_line(const std::filesystem::path& file, const Line& line) {
  or_throw(cloud::write_line(file, to_inside(line)));
}

FoundLine find_line(const Cloud& cloud) {
  const bite_line::Extraction found = bite_line::find_bite_line(cloud.state().cloud, {});
  if (found.verdict() == bite_line::Verdict::Refused) throw_refusal(*found.told());
  return {.line = from_inside(found.line),
          .confidence = found.confidence,
          .bridged_mm = found.bridged_mm,
          .review = found.verdict() == bite_line::Verdict::Review ? found.reason() : std::string{}};
}

}  // namespace biteline::sdk

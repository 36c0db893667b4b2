// SPDX-License-Identifier: MIT
// Meshes of real and drawn shoes, sampled as a scanner would see them.
#include <CppUTest/TestHarness.h>

#include <cfenv>
#include <cmath>
#include <cstdint>
#include <optional>
#include <string>

#include "host/bite_line/find_bite_line.hpp"
#include "tests/support/known_shoe.hpp"
#include "tests/support/shape_truth.hpp"
#include "tests/support/shape_warp.hpp"

namespace biteline {

/// Powers of slopes next to 0 underflow in the vector lanes' series, as they may.  On which thread is chance.
struct ForgivesUnderflow : Utest {
  void teardown() override { std::feclearexcept(FE_UNDERFLOW); }
};

namespace {

/// Of the shape as it is; none without the shared data.
std::optional<bite_line::Extraction> line_of(const std::string& name) {
  for (const test::Shape& shape : test::k_shapes) {
    if (name != shape.name) continue;
    if (const auto cloud = test::cloud_of(shape)) return bite_line::find_bite_line(*cloud, {});
  }
  return std::nullopt;
}

}  // namespace

TEST_GROUP_BASE(Shoes, ForgivesUnderflow){};

TEST(Shoes, EachHasItsLineOrARefusal) {
  for (const test::KnownShoe& shoe : test::k_known_shoes) {
    const auto scan = test::scan_of(shoe);
    if (!scan) continue;
    const test::ShoeVerdict sut = test::judge(shoe, bite_line::find_bite_line(*scan, {}));
    CHECK_TEXT(sut.right, (std::string{shoe.name} + ": " + sut.why).c_str());
  }
}

TEST(Shoes, DesignedSolesHaveTheirLineAndWhatIsNoShoeHasNone) {
  // The labels' boundary is good to 0.5 mm, 1 mm where the edge is round; a line is wrong where more than 5
  // mm of it are off by more than 1 mm beyond that and do not say so.
  constexpr double k_mean_mm = 0.5;
  constexpr double k_wrong_mm = 5.0;
  for (const test::Shape& shape : test::k_shapes) {
    if (shape.truth == test::Shape::Truth::Unknown) continue;
    const auto cloud = test::cloud_of(shape);
    const auto truth = test::truth_of(shape);
    if (!cloud || !truth) continue;
    const bite_line::Extraction sut = bite_line::find_bite_line(*cloud, {});
    if (truth->has_none) {
      CHECK_TEXT(!sut.found && sut.refusal, shape.name);
      CHECK_TEXT(sut.confidence < 0.5, shape.name);
      continue;
    }
    CHECK_TEXT(sut.verdict() != bite_line::Verdict::Refused,
               (std::string{shape.name} + ": " + sut.reason()).c_str());
    const test::LineOnShape on = test::line_on_shape(sut.line, truth->line);
    CHECK_COMPARE_TEXT(on.mean_unflagged_mm, <=, k_mean_mm, shape.name);
    CHECK_COMPARE_TEXT(on.wrong_mm, <=, k_wrong_mm, shape.name);
    if (sut.found) CHECK_COMPARE_TEXT(on.flagged, <=, 0.1, shape.name);
  }
}

TEST(Shoes, NoneHasAWrongLineHoweverItLiesAndIsBent) {
  constexpr double k_wrong_mm = 5.0;
  constexpr std::uint32_t k_first = 101, k_count = 4;
  for (const test::Shape& shape : test::k_shapes) {
    if (shape.mesh || shape.truth == test::Shape::Truth::Unknown) continue;
    const auto cloud = test::cloud_of(shape);
    const auto truth = test::truth_of(shape);
    if (!cloud || !truth) continue;
    for (std::uint32_t seed = k_first; seed < k_first + k_count; ++seed) {
      const test::ShapeWarp warp = test::ShapeWarp::drawn(seed);
      for (const test::ShapeWarp& as : {warp, warp.rigid()}) {
        const bite_line::Extraction sut = bite_line::find_bite_line(as.cloud(*cloud), {});
        if (!sut.found) continue;
        CHECK_FALSE_TEXT(truth->has_none, shape.name);
        const test::LineOnShape on = test::line_on_shape(sut.line, as.line(truth->line));
        CHECK_COMPARE_TEXT(on.wrong_mm, <=, k_wrong_mm, shape.name);
      }
    }
  }
}

TEST(Shoes, ALineThatLiesHighIsFollowedThere) {
  // Bent so, the midsole's line at the heel lies 93 mm high.  A field that ended at 90 mm had it along the
  // ledge below, 10 mm off over 80 mm without a word.
  constexpr std::uint32_t k_high = 18;
  for (const test::Shape& shape : test::k_shapes) {
    if (std::string{shape.name} != "s32_ledge_midsole") continue;
    const auto cloud = test::cloud_of(shape);
    const auto truth = test::truth_of(shape);
    if (!cloud || !truth) continue;
    const test::ShapeWarp warp = test::ShapeWarp::drawn(k_high);
    const bite_line::Extraction sut = bite_line::find_bite_line(warp.cloud(*cloud), {});
    CHECK_TEXT(sut.verdict() != bite_line::Verdict::Refused, sut.reason().c_str());
    CHECK_COMPARE(test::line_on_shape(sut.line, warp.line(truth->line)).wrong_mm, <=, 5.0);
  }
}

TEST(Shoes, AThinPlateWithAGuardHasItsLineHoweverItLies) {
  // Found, or for a person to look at.
  constexpr std::uint32_t k_first = 101, k_count = 5;
  for (const test::Shape& shape : test::k_shapes) {
    if (std::string{shape.name} != "s34_trail_scan") continue;
    const auto cloud = test::cloud_of(shape);
    if (!cloud) continue;
    for (std::uint32_t seed = k_first; seed < k_first + k_count; ++seed) {
      const cloud::PointCloud moved = test::ShapeWarp::drawn(seed).rigid().cloud(*cloud);
      const bite_line::Extraction sut = bite_line::find_bite_line(moved, {});
      CHECK_TEXT(sut.verdict() != bite_line::Verdict::Refused, sut.reason().c_str());
    }
  }
}

TEST(Shoes, AThinPlateWithAGuardHasItsLineWhereTheEyeSeesIt) {
  // Places read off pictures of the largest curvature of the cloud, in its axes; the third number is not
  // asked where it is empty.
  struct Seen {
    const char* what;
    std::optional<double> x_mm, y_mm;
    double z_mm;
    int side;  ///< of y
  };
  constexpr Seen k_seen[] = {{"seam of the midsole, right", 92.5, std::nullopt, 31.6, -1},
                             {"seam of the midsole, right", 98.8, std::nullopt, 26.0, -1},
                             {"plate, right", 126.5, std::nullopt, 16.4, -1},
                             {"plate, right", 156.0, std::nullopt, 11.6, -1},
                             {"guard, top", std::nullopt, 8.6, 55.6, 1},
                             {"guard, flank", std::nullopt, -12.2, 40.6, -1},
                             {"plate, left", 238.9, std::nullopt, 20.9, 1},
                             {"plate, left", 215.9, std::nullopt, 15.9, 1},
                             {"midsole, left", 105.1, std::nullopt, 27.3, 1}};
  constexpr double k_read_mm = 1.2;  // four pixels of these pictures
  const std::optional<bite_line::Extraction> sut = line_of("s34_trail_scan");
  if (!sut) return;
  CHECK_TEXT(sut->verdict() != bite_line::Verdict::Refused, sut->reason().c_str());
  for (const Seen& seen : k_seen) {
    double nearest_mm = 1e9;
    bool flagged = true;
    for (const cloud::LinePoint& point : sut->line.points) {
      const Vec3& at = point.position;
      if (at.y() * seen.side < 0) continue;
      // The guard is at the toe, the rest on the two sides.
      if (seen.y_mm && at.x() < 270) continue;
      const double off_mm = seen.x_mm ? std::hypot(at.x() - *seen.x_mm, at.z() - seen.z_mm)
                                      : std::hypot(at.y() - *seen.y_mm, at.z() - seen.z_mm);
      if (off_mm >= nearest_mm) continue;
      nearest_mm = off_mm;
      flagged = point.flags != 0;
    }
    CHECK_TEXT(flagged || nearest_mm < k_read_mm, seen.what);
  }
}

TEST(Shoes, AGuardWithABadgeOnItIsGoneRound) {
  // Below the guard's edge the badge shows a piece of a crease, and the line once ran along it without a
  // word. Places on the toe, read off a picture of the cloud from the front, in its axes.
  struct Seen {
    const char* what;
    double y_mm, z_mm;
  };
  constexpr Seen k_seen[] = {{"right flank", -10.0, 41.0}, {"right flank", -9.5, 45.0},
                             {"right flank", -8.5, 48.0},  {"top", 0.0, 52.5},
                             {"left flank", 10.5, 49.0},   {"left flank", 11.2, 46.5}};
  constexpr double k_read_mm = 1.2;
  constexpr double k_toe_mm = 280;
  const std::optional<bite_line::Extraction> sut = line_of("s06_nike_pegasus36");
  if (!sut) return;
  CHECK_TEXT(sut->found, sut->reason().c_str());
  for (const Seen& seen : k_seen) {
    double nearest_mm = 1e9;
    for (const cloud::LinePoint& point : sut->line.points) {
      const Vec3& at = point.position;
      if (at.x() > k_toe_mm)
        nearest_mm = std::min(nearest_mm, std::hypot(at.y() - seen.y_mm, at.z() - seen.z_mm));
    }
    CHECK_COMPARE_TEXT(nearest_mm, <, k_read_mm, seen.what);
  }
}

}  // namespace biteline

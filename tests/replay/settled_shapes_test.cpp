// SPDX-License-Identifier: MIT
// Shoes of public origin whose line a person must settle: settled, they are samples like any other.
#include <CppUTest/TestHarness.h>

#include <array>
#include <cfenv>
#include <string>

#include "host/bite_line/edit/edit.hpp"
#include "host/bite_line/find_bite_line.hpp"
#include "host/cloud/flagged.hpp"
#include "host/cloud/ply.hpp"
#include "host/robot/path/checks/line_check.hpp"
#include "host/transfer/transfer.hpp"
#include "tests/support/errors.hpp"
#include "tests/support/shared_data.hpp"

namespace biteline {
namespace {

/// The same shoe turned by 25 degrees and elsewhere; what lies more than 2 mm below the line is gone.
cloud::PointCloud next_upper(const cloud::PointCloud& scan, const cloud::ClosedLine& line) {
  SE3 T_next_scan{Eigen::AngleAxisd{0.436, Vec3::UnitZ()}};
  T_next_scan.translation() = Vec3{30, -20, 5};
  cloud::PointCloud upper;
  for (const Eigen::Vector3f& at : scan.points) {
    const Vec3 point = at.cast<double>();
    const cloud::LinePoint* nearest = &line.points.front();
    // Every fourth of the line: 2 mm apart.
    for (std::size_t i = 0; i < line.points.size(); i += 4) {
      const auto off = [&](const cloud::LinePoint& p) {
        return (p.position - point).head<2>().squaredNorm();
      };
      if (off(line.points[i]) < off(*nearest)) nearest = &line.points[i];
    }
    if (point.z() > nearest->position.z() - 2) upper.points.push_back((T_next_scan * point).cast<float>());
  }
  return upper;
}

}  // namespace

TEST_GROUP(SettledShapes){void teardown() override{std::feclearexcept(FE_UNDERFLOW);
}  // namespace biteline
}
;

TEST(SettledShapes, ALineForReviewIsWorkedAndCarriedOnceAPersonHasTakenIt) {
  // Of these the first candidate is the line, by its labels or by eye.
  for (const char* name : {"shapes3/s41_low_basketball", "shapes3/s46_adi_8_parts"}) {
    BITELINE_SHARED_DATA_OR_SKIP(file, std::string{name} + "/cloud.ply");
    test::note_ran();
    const auto scan = cloud::read_cloud(file);
    SUCCEEDS(scan);
    const bite_line::Extraction found = bite_line::find_bite_line(*scan, {});
    CHECK_TEXT(found.verdict() != bite_line::Verdict::Refused, found.reason().c_str());
    CHECK(found.found == (cloud::flagged_share(found.line) <= cloud::k_most_flagged_share));
    if (!found.found) CHECK_FALSE(path::all_passed(path::check_line(found.line)));

    const edit::OrRefusal<edit::Surface> surface = edit::Surface::of(*scan);
    CHECK_TEXT(surface.has_value(), name);
    const edit::Step take{.kind = edit::Step::Kind::Candidate, .candidate = 1};
    const edit::OrRefusal<cloud::ClosedLine> line = edit::mend(*surface, found.line, {&take, 1}, {});
    CHECK_TEXT(line.has_value(), name);
    CHECK_TEXT(path::all_passed(path::check_line(*line)), name);
    for (const cloud::LinePoint& point : line->points) {
      if (point.source == cloud::PointSource::Mended) CHECK(point.u95_mm.value_or(9) <= edit::k_hand_u95_mm);
    }

    const transfer::SampleFiles sample{.cloud = *scan, .line = *line};
    const transfer::Transfer carried = transfer::transfer_line(sample, next_upper(*scan, *line), {});
    CHECK_TEXT(carried.found, (std::string{name} + ": " + carried.reason()).c_str());
    CHECK(carried.bound_mm < 1);
  }
}

}  // namespace biteline

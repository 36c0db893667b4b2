// SPDX-License-Identifier: MIT
#pragma once
/// \file All cells as a page shows them: shoes, trends, groups, whose cell is odd, and what calls for a
/// person.

#include <string>
#include <vector>

#include "host/fleet/centre.hpp"
#include "host/fleet/metrics.hpp"
#include "host/fleet/odd_cell.hpp"
#include "host/records/memory/factory_day.hpp"

namespace biteline::fleet {

struct FleetShoe {
  std::string cell;
  memory::Scan scan;
  std::string release;
};
struct FleetShoes {
  std::vector<FleetShoe> shoes;  ///< newest first
  std::int64_t next_id{0};       ///< the next page's cursor; 0: there is none
};
/// The shoes of a model in a cell.
struct Group {
  std::string cell, model;
  memory::Trend sums;  ///< over the whole filter; `begin`: of the first shoe
};
struct LastHour {
  std::string cell;
  std::int64_t shoes{0}, refused{0};
};

/// In the centre's database.  `cell` empty: all.  Thread: the centre's owner.
class Overview {
 public:
  explicit Overview(Centre& centre) : centre_{centre} {}

  [[nodiscard]] Result<FleetShoes> shoes(const std::string& cell, const memory::ScanFilter& filter);
  /// `span`: hour, day or week, of the factory.
  [[nodiscard]] Result<memory::Trends> trends(const std::string& cell, const memory::ScanFilter& filter,
                                              const memory::FactoryDay& day, const std::string& span);
  /// From now on the view `trends` counts by this day, in the process's time zone.  Errc::DeviceError: the
  /// database does not know that zone, say, and nothing changes.
  [[nodiscard]] Result<void> keep_day(const memory::FactoryDay& day);
  [[nodiscard]] Result<std::vector<Group>> groups(const memory::ScanFilter& filter);
  [[nodiscard]] Result<std::vector<LastHour>> last_hour();

 private:
  Centre& centre_;
};

/// Cells whose lines of a model differ from the others', of every model.
[[nodiscard]] Result<std::vector<OddOfModel>> odd_of_all(Centre& centre);

}  // namespace biteline::fleet

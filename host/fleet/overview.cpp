// SPDX-License-Identifier: MIT
#include "host/fleet/overview.hpp"

#include <limits>

#include "host/fleet/centre_state.hpp"

namespace biteline::fleet {
namespace {

/// A cell is compared by so many of its newest shoes of a model.
constexpr int k_newest = 300;

/// $1 cell, $2 model, $3 verdict, $4 and $5 from and to, $6 reason code, $7 part number, $8 its beginning;
/// empty: any.
constexpr const char* k_where =
    " FROM shoes WHERE ($1 = '' OR cell = $1) AND ($2 = '' OR model = $2) AND ($3 = '' OR verdict = $3) AND "
    "time >= to_timestamp($4::bigint / 1000.0) AND time < to_timestamp($5::bigint / 1000.0) AND ($6 = '' OR "
    "reason_code = $6) AND ($7 = '' OR part = $7) AND ($8 = '' OR starts_with(part, $8))";
/// As the database takes it.
std::string zone_of_process() {
  const std::string zone = memory::time_zone();
  return zone.empty() ? "UTC" : zone;
}

/// A scan that a person ended on its way says nothing of a shoe.
constexpr const char* k_no_stopped = " AND NOT (verdict = 'refused' AND reason_code = 'stopped_by_a_person')";
/// What works on with a shoe is no other one.
constexpr const char* k_shoes = " AND follows = ''";
constexpr const char* k_stopped = " AND verdict = 'refused' AND reason_code = 'stopped_by_a_person'";
constexpr const char* k_sums =
    "count(*), count(*) FILTER (WHERE verdict = 'ok'), count(*) FILTER (WHERE verdict = 'amber'), count(*) "
    "FILTER (WHERE verdict = 'refused'), count(*) FILTER (WHERE verdict NOT IN ('ok', 'amber', 'review', "
    "'refused')), "
    "avg(length_mm), percentile_cont(0.5) WITHIN GROUP (ORDER BY u95_mm), percentile_cont(0.5) WITHIN GROUP "
    "(ORDER BY cycle_s), count(*) FILTER (WHERE verdict = 'review')";
/// 9999-12-31, beyond which PostgreSQL's times go, but nobody's shoes.
constexpr memory::UnixMs k_latest_ms = 253'402'214'400'000;

std::optional<double> number_if(const pqxx::field& field) {
  return field.is_null() ? std::nullopt : std::optional{field.as<double>()};
}

/// Of the columns of k_sums from `first` on.
memory::Trend trend_of(const pqxx::row& row, int first, memory::UnixMs begin) {
  return {.begin = begin,
          .scans = row[first].as<std::int64_t>(),
          .ok = row[first + 1].as<std::int64_t>(),
          .amber = row[first + 2].as<std::int64_t>(),
          .review = row[first + 8].as<std::int64_t>(),
          .refused = row[first + 3].as<std::int64_t>(),
          .failed = row[first + 4].as<std::int64_t>(),
          .mean_length_mm = number_if(row[first + 5]),
          .median_u95_mm = number_if(row[first + 6]),
          .median_cycle_s = number_if(row[first + 7])};
}

FleetShoe shoe_of(const pqxx::row& row) {
  FleetShoe shoe{.cell = row[1].as<std::string>(), .scan = {}, .release = row[16].as<std::string>()};
  memory::Scan& scan = shoe.scan;
  scan.name = row[2].as<std::string>();
  scan.time = row[3].as<std::int64_t>();
  scan.model = row[4].as<std::string>();
  scan.verdict = row[5].as<std::string>();
  scan.reason_code = row[6].as<std::string>();
  scan.reason = row[7].as<std::string>();
  scan.length_mm = number_if(row[8]);
  scan.confidence = number_if(row[9]);
  scan.u95_mm = number_if(row[10]);
  scan.cycle_s = number_if(row[11]);
  scan.process = row[12].as<std::string>();
  scan.part = row[17].as<std::string>();
  scan.foot = row[18].as<std::string>();
  scan.size = row[19].as<std::string>();
  scan.follows = row[20].as<std::string>();
  scan.work = {.verdict = row[21].as<std::string>(),
               .reworked = row[22].as<bool>(),
               .missing_mm = number_if(row[23]),
               .narrow = row[24].as<int>(),
               .wide = row[25].as<int>(),
               .beside = row[26].as<int>(),
               .doubled = row[27].as<int>()};
  scan.decision = row[13].as<std::string>();
  scan.sent = row[14].as<bool>();
  if (scan.sent) scan.followed = row[15].as<bool>();
  return shoe;
}

/// `statement` with k_where's parameters, and what stands behind it.
template <class... More>
pqxx::result ask(pqxx::work& work, const std::string& statement, const std::string& cell,
                 const memory::ScanFilter& filter, const More&... more) {
  const bool begins = filter.part.ends_with('*');
  const std::string part = begins ? filter.part.substr(0, filter.part.size() - 1) : filter.part;
  return work.exec_params(statement, text_of(cell), text_of(filter.model), text_of(filter.verdict),
                          filter.from.value_or(0), std::min(filter.to.value_or(k_latest_ms), k_latest_ms),
                          text_of(filter.reason_code), text_of(begins ? "" : part),
                          text_of(begins ? part : ""), more...);
}

}  // namespace

Result<FleetShoes> Overview::shoes(const std::string& cell, const memory::ScanFilter& filter) {
  return centre_.work<FleetShoes>([&](Centre::State& state) {
    pqxx::work work{state.connection};
    FleetShoes page;
    std::int64_t last = 0;
    const std::int64_t before =
        filter.before_id > 0 ? filter.before_id : std::numeric_limits<std::int64_t>::max();
    for (const pqxx::row& row :
         ask(work,
             std::string{"SELECT id, cell, scan, (extract(epoch FROM time) * 1000)::bigint, model, verdict, "
                         "reason_code, reason, length_mm, confidence, u95_mm, cycle_s, process, decision, "
                         "sent, followed, release, part, foot, size, follows, work, work_reworked, "
                         "work_missing_mm, work_narrow, work_wide, work_beside, work_doubled"} +
                 k_where + " AND id < $9 ORDER BY id DESC LIMIT $10",
             cell, filter, before, filter.limit + 1)) {
      if (static_cast<int>(page.shoes.size()) == filter.limit) {
        page.next_id = last;
        break;
      }
      page.shoes.push_back(shoe_of(row));
      last = row[0].as<std::int64_t>();
    }
    return page;
  });
}

Result<memory::Trends> Overview::trends(const std::string& cell, const memory::ScanFilter& filter,
                                        const memory::FactoryDay& day, const std::string& span) {
  return centre_.work<memory::Trends>([&](Centre::State& state) {
    pqxx::work work{state.connection};
    memory::Trends trends;
    for (const pqxx::row& row :
         ask(work,
             std::string{
                 "SELECT (extract(epoch FROM (date_trunc($9::text, (time AT TIME ZONE $10::text) - "
                 "$11::interval) + $11::interval) AT TIME ZONE $10::text) * 1000)::bigint AS bucket, "} +
                 k_sums + k_where + k_no_stopped + k_shoes + " GROUP BY bucket ORDER BY bucket",
             cell, filter, span, zone_of_process(), span == "hour" ? "00:00" : day.begin()))
      trends.buckets.push_back(trend_of(row, 1, row[0].as<std::int64_t>()));
    for (const pqxx::row& row : ask(work,
                                    std::string{"SELECT reason_code, count(*)"} + k_where + k_no_stopped +
                                        " AND reason_code <> '' GROUP BY reason_code ORDER BY 2 DESC, 1",
                                    cell, filter))
      trends.reasons.push_back({.reason_code = row[0].as<std::string>(), .scans = row[1].as<std::int64_t>()});
    trends.stopped = ask(work, std::string{"SELECT count(*)"} + k_where + k_stopped, cell, filter)[0][0]
                         .as<std::int64_t>();
    return trends;
  });
}

Result<void> Overview::keep_day(const memory::FactoryDay& day) {
  const std::string zone = zone_of_process();
  const Result<bool> kept = centre_.work<bool>([&](Centre::State& state) -> Result<bool> {
    pqxx::work work{state.connection};
    // One that the database does not know would make the view useless.
    work.exec_params("SELECT now() AT TIME ZONE $1::text", zone);
    work.exec_params("UPDATE factory_day SET zone = $1, begins = $2::interval", zone, day.begin());
    work.commit();
    return true;
  });
  if (!kept) return tl::unexpected<Error>{kept.error()};
  return {};
}

Result<std::vector<Group>> Overview::groups(const memory::ScanFilter& filter) {
  return centre_.work<std::vector<Group>>([&](Centre::State& state) {
    pqxx::work work{state.connection};
    std::vector<Group> groups;
    for (const pqxx::row& row :
         ask(work,
             std::string{"SELECT cell, model, (extract(epoch FROM min(time)) * 1000)::bigint, "} + k_sums +
                 k_where + k_no_stopped + k_shoes + " GROUP BY cell, model ORDER BY model, cell",
             "", filter))
      groups.push_back({.cell = row[0].as<std::string>(),
                        .model = row[1].as<std::string>(),
                        .sums = trend_of(row, 3, row[2].as<std::int64_t>())});
    return groups;
  });
}

Result<std::vector<LastHour>> Overview::last_hour() {
  return centre_.work<std::vector<LastHour>>([&](Centre::State& state) {
    pqxx::work work{state.connection};
    std::vector<LastHour> cells;
    for (const pqxx::row& row : work.exec(
             "SELECT cell, count(*), count(*) FILTER (WHERE verdict = 'refused') FROM shoes WHERE time > "
             "now() - interval '1 hour' AND follows = '' GROUP BY cell ORDER BY cell"))
      cells.push_back({.cell = row[0].as<std::string>(),
                       .shoes = row[1].as<std::int64_t>(),
                       .refused = row[2].as<std::int64_t>()});
    return cells;
  });
}

Result<std::vector<OddOfModel>> odd_of_all(Centre& centre) {
  std::vector<OddOfModel> odd;
  BITELINE_ASSIGN(const std::vector<std::string> models, centre.models());
  for (const std::string& model : models) {
    BITELINE_ASSIGN(const std::vector<PlacedShoe> shoes, centre.placed_shoes(model, k_newest));
    for (OddCell& one : odd_cells(shoes)) odd.push_back({.model = model, .odd = std::move(one)});
  }
  return odd;
}

}  // namespace biteline::fleet

// SPDX-License-Identifier: MIT
#pragma once
/// \file The cell's memory: every shoe, every person, every change, in one SQLite file.

#include <array>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "host/records/memory/database.hpp"
#include "host/records/memory/log_chain.hpp"
#include "host/records/memory/teaching.hpp"

namespace biteline::memory {

inline constexpr const char* k_memory_file = "memory.sqlite";
/// Places along a line at which its distance to the model's line is kept; even parts of its length.
inline constexpr std::size_t k_places = 36;
using Places = std::array<float, k_places>;  ///< mm, outwards above 0

/// Milliseconds since 1970, UTC.
using UnixMs = std::int64_t;
[[nodiscard]] UnixMs now_ms();
[[nodiscard]] std::string to_iso(UnixMs time);                         ///< "2026-11-20T21:04:05.123Z"
[[nodiscard]] std::optional<UnixMs> from_iso(const std::string& iso);  ///< also "2026-11-20"

/// What a look after the work told of it.
struct Work {
  std::string verdict;   ///< looking, ok, faulty, unsure, refused, not_looked; empty: no look was asked for
  bool reworked{false};  ///< what is missing was worked once more: the scan that follows tells how
  std::optional<double> missing_mm{};             ///< along the line, at the last look; absent: no look told
  int narrow{0}, wide{0}, beside{0}, doubled{0};  ///< stretches
  bool operator==(const Work&) const = default;
};

/// One shoe.  Texts are empty and numbers absent where nothing is known.
struct Scan {
  std::string name;  ///< of its folder: scan-0007
  UnixMs time{0};    ///< of its end
  std::string model;
  std::optional<double> model_probability{};
  std::string foot;     ///< left or right
  std::string size;     ///< as its samples name it, e.g. "EU 42"
  std::string part;     ///< part number of the shoe
  std::string follows;  ///< the scan of the same shoe that it works on with; empty: it is the shoe's first
  std::string verdict;  ///< working, ok, amber, review, refused, failed
  std::string reason_code;                                    ///< of a refusal
  std::string reason;                                         ///< in words
  std::string next_step;                                      ///< what the person does next
  std::optional<double> length_mm{}, confidence{}, u95_mm{};  ///< u95: the line's largest
  std::optional<double> tip_bound_mm{};  ///< of the tool off the line, as its path was planned
  int weak_stretches{0};
  std::optional<double> scan_s{}, line_s{}, cycle_s{};
  std::string operator_name;  ///< who held control
  std::string process;
  std::string decision{"open"};  ///< open, automatic, held, accepted, rejected
  std::string decided_by;
  std::optional<UnixMs> decided_at{};
  std::string why;  ///< of the decision
  bool sent{false};
  std::optional<bool> followed{};  ///< false: sent, but not to its end
  Work work{};
  int line_version{0};   ///< 0: as found; above: mended
  bool marked{false};    ///< never deleted by itself
  std::string versions;  ///< JSON: programs, process, model
  std::string details;   ///< JSON: what does not stand in a column
};

/// SHA-256 of what a person looks at and the arm is sent, as the service wrote it; empty: not there.
struct Evidence {
  std::string line;     ///< line.csv
  std::string cloud;    ///< cloud.ply
  std::string process;  ///< process.yaml, that the path was planned with
  std::string report;   ///< report.json
  bool operator==(const Evidence&) const = default;
};

/// The reason code of a scan that a person ended on its way; with the verdict refused.
inline constexpr const char* k_stopped_by_a_person = "stopped_by_a_person";

struct ScanFilter {
  std::optional<UnixMs> from{}, to{};  ///< from <= time < to
  std::string model, verdict, reason_code;
  std::string part;           ///< of this part number; with * at its end: of all that begin so
  std::int64_t before_id{0};  ///< the cursor; 0: from the newest
  int limit{100};             ///< at most k_most_scans
};
inline constexpr UnixMs k_day_ms = 86'400'000;
inline constexpr int k_most_scans = 1000;

struct ScanPage {
  std::vector<Scan> scans;  ///< newest first
  std::int64_t next_id{0};  ///< the next page's cursor; 0: there is none
};

/// A line of the log: who did what.  "service" did what nobody asked for.
struct LogRow {
  std::int64_t id{0};
  UnixMs time{0};
  std::string who, door, action, subject, before, after;
};

struct User {
  std::string name;
  std::string role;
  std::string password_hash;
  UnixMs created{0};
  bool enabled{true};
  std::optional<UnixMs> last_login{};
};

struct Session {
  std::string token_hash;  ///< hex; the token itself is known to its owner alone
  std::string user, role;
  UnixMs created{0}, expires{0};
};

/// What came within one stretch of time.
struct Trend {
  UnixMs begin{0};
  std::int64_t scans{0}, ok{0}, amber{0}, review{0}, refused{0}, failed{0};
  std::optional<double> mean_length_mm{}, median_u95_mm{}, median_cycle_s{};
};
struct ReasonCount {
  std::string reason_code;
  std::int64_t scans{0};
};
/// Of the distances to the model's line, over all scans of a model.
struct PlaceSums {
  std::int64_t scans{0};
  std::array<double, k_places> sum_mm{}, sum_mm2{};
};
struct Trends {
  std::vector<Trend> buckets;        ///< oldest first; of shoes: what follows on the same one is in none
  std::vector<ReasonCount> reasons;  ///< most frequent first
  std::int64_t stopped{0};           ///< by a person on their way: in none of both
};

/// What is kept of the shoes' folders.  Absent: no limit.
struct Retention {
  std::optional<UnixMs> oldest{};
  std::optional<std::uint64_t> most_bytes{};
};

class FactoryDay;  // factory_day.hpp, here and below
enum class Span;

/// Thread: safe from any; one at a time.
class Memory {
 public:
  /// Makes the file or raises its schema to this program's; a newer schema is Errc::NotSupported.
  [[nodiscard]] static Result<Memory> open(const std::filesystem::path& file);
  /// To look only; also while the service writes.  Errc::FileNotFound where there is none.
  [[nodiscard]] static Result<Memory> open_to_read(const std::filesystem::path& file);

  /// The shoe's row, its log line and what the statistics need, all or nothing; a row of that name is
  /// replaced and its mark kept.
  [[nodiscard]] Result<void> put_scan(const Scan& scan, const LogRow& event,
                                      const std::optional<Places>& places = {});
  [[nodiscard]] Result<std::optional<Scan>> scan(const std::string& name) const;
  [[nodiscard]] Result<ScanPage> scans(const ScanFilter& filter) const;
  /// The newest scan of this part number that a path was sent for, apart from the one of this name.
  [[nodiscard]] Result<std::optional<Scan>> sent_before(const std::string& part,
                                                        const std::string& scan) const;
  /// Pre: the scan has a row.
  [[nodiscard]] Result<void> put_evidence(const std::string& scan, const Evidence& evidence);
  /// Nothing of scans that an older program wrote.
  [[nodiscard]] Result<std::optional<Evidence>> evidence(const std::string& scan) const;
  [[nodiscard]] Result<void> mark(const std::string& name, bool marked, const LogRow& event);
  /// Rows of scans that are to go, oldest first, never a marked one; the caller removes the folder, then
  /// calls forget_folder().  The row stays: history outlives pictures.
  [[nodiscard]] Result<std::vector<std::string>> folders_to_go(const Retention& retention,
                                                               const std::filesystem::path& results) const;
  [[nodiscard]] Result<void> forget_folder(const std::string& name, const LogRow& event);

  /// A new one (id 0) gets its number; the rest of its facts, and the log line where there is one, all or
  /// nothing.  Who began it and when does not change any more.
  [[nodiscard]] Result<std::int64_t> put_teaching(const Teaching& teaching,
                                                  const std::optional<LogRow>& event = {});
  /// Newest first; `before_id` 0: from the newest.
  [[nodiscard]] Result<std::vector<Teaching>> teachings(std::int64_t before_id, int limit) const;
  [[nodiscard]] Result<std::optional<Teaching>> teaching(std::int64_t id) const;
  /// The newest that is or was about this scan, and was not given up.
  [[nodiscard]] Result<std::optional<Teaching>> teaching_of(const std::string& scan) const;
  /// The newest scan of this time or later that waits for a person by its row; empty: none.
  [[nodiscard]] Result<std::string> held_since(UnixMs time) const;

  /// In the factory's hours, days or weeks; those without a shoe are left out.
  [[nodiscard]] Result<Trends> trends(const ScanFilter& filter, const FactoryDay& day, Span span) const;
  [[nodiscard]] Result<PlaceSums> place_sums(const std::string& model, std::optional<UnixMs> from,
                                             std::optional<UnixMs> to) const;

  [[nodiscard]] Result<void> log(const LogRow& row);
  /// Newest first, by their time; `before_id` 0: from the newest.
  [[nodiscard]] Result<std::vector<LogRow>> log_rows(std::int64_t before_id, int limit,
                                                     std::optional<UnixMs> from = {},
                                                     std::optional<UnixMs> to = {}) const;
  /// Whether the log is as it was written; `kept`: links that were kept elsewhere.  Also while it is written.
  [[nodiscard]] Result<LogVerdict> verify_log(std::span<const LogLink> kept = {}) const;

  /// Change and log line in one transaction, here and below.
  [[nodiscard]] Result<void> put_user(const User& user, const LogRow& event);
  [[nodiscard]] Result<void> note_login(const std::string& name, UnixMs time);
  [[nodiscard]] Result<void> remove_user(const std::string& name, const LogRow& event);
  [[nodiscard]] Result<std::vector<User>> users() const;
  [[nodiscard]] Result<void> put_session(const Session& session, const LogRow& event);
  [[nodiscard]] Result<std::optional<Session>> session(const std::string& token_hash) const;
  [[nodiscard]] Result<std::vector<Session>> sessions() const;
  [[nodiscard]] Result<void> remove_session(const std::string& token_hash, const LogRow& event);
  [[nodiscard]] Result<void> remove_sessions_before(UnixMs time);
  [[nodiscard]] Result<std::optional<std::string>> setting(const std::string& key) const;
  [[nodiscard]] Result<void> put_setting(const std::string& key, const std::string& value,
                                         const LogRow& event);

  /// A copy of this moment as one file.
  [[nodiscard]] Result<void> copy_to(const std::filesystem::path& target) const;
  [[nodiscard]] const std::filesystem::path& file() const { return database_->file(); }

 private:
  explicit Memory(Database database);
  /// Pre: within a transaction; its link is made of the row before it.
  Result<void> add_log(const LogRow& row);

  std::unique_ptr<Database> database_;
  std::unique_ptr<std::mutex> mutex_;
};

}  // namespace biteline::memory

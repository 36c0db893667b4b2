// SPDX-License-Identifier: MIT
#pragma once
/// \file Scan after scan with faults, and the account of each.

#include <optional>
#include <random>
#include <set>

#include "tests/soak/books.hpp"
#include "tests/soak/faults.hpp"
#include "tests/soak/light_book.hpp"
#include "tests/soak/stand.hpp"
#include "tests/support/wakeup_probe.hpp"

namespace biteline::soak {

struct SoakSettings {
  double minutes{2};
  std::uint64_t seed{1};
};

/// Hears the service, makes one fault in each scan, and balances the books when the next one begins:
/// shoes = results + refusals, the laser dark when it must be, no script that the gate did not permit.
/// Thread: one owner.
class Soak {
 public:
  Soak(Stand& stand, const SoakSettings& settings);

  /// Until the time is over and the scan of that moment has its account.
  void run();
  /// What did not come out even, one line each; printed when it is found, too.
  [[nodiscard]] const std::vector<std::string>& wrong() const { return wrong_; }
  void print_tables() const;

 private:
  using Clock = std::chrono::steady_clock;
  using Wakeups = test::WakeupProbe;

  /// The scan that is under way, and its fault.
  struct Running {
    std::string name;
    const Fault* fault{nullptr};
    std::chrono::milliseconds delay{0};
    Fault::Undo undo{};
    std::optional<Clock::time_point> sent{}, on_line{}, made{}, dark{}, rest{};
    Vec3 made_at_mm{Vec3::Zero()}, rest_at_mm{Vec3::Zero()};
    bool repaired{false};
    bool in_aftermath{false};  ///< begun while the fault of the scan before still had its effect
  };
  struct Row {
    int scans{0}, excused{0}, aftermaths{0};
    int outcomes[k_outcomes]{};
    double worst_ms{0};       ///< until the laser's line fell, or the arm stood
    double worst_gone_mm{0};  ///< that the tip went on
  };

  void begin(const std::string& scan);
  void settle();
  void settle_scripts(const ScanAccount& account);
  void work_fault();
  /// The moment of the fault has come.
  [[nodiscard]] bool fault_due();
  void watch_dark(Clock::time_point now);
  void watch_rest(Clock::time_point now);
  void watch_light(Clock::time_point now);
  void keep_programs();
  void hear(const HostWord& word);
  /// All that the service has said.  False: the time is over, and the next scan has begun.
  [[nodiscard]] bool hear_all(Clock::time_point until);
  void balance_light(std::uint64_t lit);
  void end();
  void find(const std::string& what);
  [[nodiscard]] const Fault& next_fault();
  [[nodiscard]] std::chrono::milliseconds delay_of(Fault::When when);
  /// From one instant to another, less the time that the machine did not give to `machine`'s rank.
  [[nodiscard]] static double own_ms(const Wakeups& machine, Clock::time_point from, Clock::time_point until);
  void probe_anew();

  Stand& stand_;
  SoakSettings settings_;
  std::mt19937_64 random_;
  std::vector<std::size_t> bag_;  ///< faults that are still to come in this round
  std::optional<Running> running_;
  std::unique_ptr<Wakeups> urgent_;    ///< as the sensor's threads
  std::unique_ptr<Wakeups> ordinary_;  ///< as the service
  std::vector<std::string> scripts_;   ///< of paths, seen on the wire and not yet accounted for
  std::set<std::string> begun_;
  std::optional<Clock::time_point> must_be_dark_since_;
  Clock::time_point heard_{Clock::now()};
  Clock::time_point aftermath_until_{};     ///< of the newest fault
  std::size_t dark_scans_{0};               ///< that ended before a profile came, so perhaps before the light
  std::optional<Clock::time_point> ended_;  ///< a program
  bool violated_{false};                    ///< the light's rule, now
  std::map<std::string, Row> rows_;
  MemoryBook memory_;
  LightBook light_;
  std::uint64_t asked_{0};  ///< the service, for a scan
  std::vector<std::string> wrong_;
};

}  // namespace biteline::soak

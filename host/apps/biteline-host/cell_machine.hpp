// SPDX-License-Identifier: MIT
#pragma once
/// \file The one state of a cell: what the sensor does, what becomes of a shoe, and whether scans are asked
/// for.

#include <cstdint>
#include <optional>
#include <string>

namespace biteline::service {

/// Between the sensor and the service.
enum class Sensing : std::uint8_t {
  Starting,  ///< nobody has answered yet
  Away,      ///< no link, or one that has said nothing yet
  Idle,
  Asked,  ///< for a scan that has neither begun nor been refused
  Scanning
};

/// Of the scan whose end is in.
enum class Shoe : std::uint8_t {
  None,
  Working,     ///< its line and path are worked out
  Held,        ///< it waits for a person
  Planning,    ///< it was held: a person's word is worked out, and then it is held again, or goes on
  Looking,     ///< it is held, and the sensor looks whether it has moved
  Accepted,    ///< it was held, and its path goes to the gate
  InAir,       ///< it was held, and the arm runs its path in the air
  Following,   ///< the arm follows its path
  Inspecting,  ///< it was worked, and the sensor looks at what was done
};

/// Whether the next scan is asked for.
enum class Going : std::uint8_t { Goes, WaitsForStart, Stopped };

/// What a person is to do about a shoe that is held.
enum class Waits : std::uint8_t { ForWord, ForPath, ForModel };

/// Why no scan is asked for although one would be.
enum class Hindrance : std::uint8_t {
  None,
  Robot,  ///< it is not ready
  Rest    ///< the machine spoilt the last scan, or the sensor did not begin it
};

enum class CellEvent : std::uint8_t {
  // The sensor.
  Heard,
  Lost,
  Asks,
  Refuses,
  ScanBegins,
  ScanIsIn,
  // The service's work.
  Works,
  ArmSetsOut,
  AirSetsOut,  ///< the arm sets out in the air
  Holds,
  Done,
  Inspects,  ///< a look at what was done is to be taken
  // A person about what is held.
  Accept,
  Plan,  ///< another process, a model, a mended line, a run in the air
  Look,
  Reject,
  // A person about the cell.
  Start,
  Stop,
  Spent,      ///< each start is one scan, and this one was asked for or given up
  AsksPerson  ///< of what was done to the last shoe nobody may go on before a person has looked
};

/// What doors are told: one word for all of it.
enum class CellState : std::uint8_t {
  Starting,
  NoSensor,
  NotReady,
  Resting,
  Idle,
  WaitsForStart,
  Stopped,
  Scanning,
  Working,
  Held,
  Following
};

/// Three tables, as three things go on at once: a sensor may begin a scan while the shoe before is in work,
/// and a stop is taken always.  An event that no row names changes nothing, and on() says so.
///
/// | sensing  | Heard    | Lost     | Asks  | Refuses | ScanBegins | ScanIsIn |
/// |----------|----------|----------|-------|---------|------------|----------|
/// | Starting | Idle     | Away     |       |         | Scanning   |          |
/// | Away     | Idle     | Away     |       |         | Scanning   |          |
/// | Idle     | Idle     | Away     | Asked | Idle    | Scanning   |          |
/// | Asked    | Idle     | Away     |       | Idle    | Scanning   |          |
/// | Scanning | Scanning | Scanning |       |         | Scanning   | Idle     |
///
/// A scan that was cut off goes on where it stood: Lost does not end it.
///
/// | shoe       | Works   | ArmSetsOut | AirSetsOut | Holds | Done | Accept   | Plan     | Look    | Reject |
/// |------------|---------|------------|------------|-------|------|----------|----------|---------|--------|
/// | None       | Working |            |            |       | None |          |          |         |        |
/// | Working    | Working | Following  |            | Held  | None |          |          |         |        |
/// | Held       |         |            |            | Held  |      | Accepted | Planning | Looking | None   |
/// | Planning   | Working | Following  | InAir      | Held  | None |          |          |         |        |
/// | Looking    | Working |            |            | Held  | None |          |          |         |        |
/// | Accepted   | Working | Following  |            | Held  | None |          |          |         |        |
/// | InAir      | Working |            |            | Held  | None |          |          |         |        |
/// | Following  | Working |            |            | Held  | None |          |          |         |        |
/// | Inspecting | Working |            |            |       | None |          |          |         |        |
///
/// Inspects makes Inspecting of Following, and of nothing else.
/// Stop makes None of Held, and leaves each other state as it is.
/// What a stop ends in work ends by its mark (robot::StopMark): Done, or Holds of what waits no longer.
///
/// | going         | Start | Stop    | Spent         | AsksPerson    |
/// |---------------|-------|---------|---------------|---------------|
/// | Goes          | Goes  | Stopped | WaitsForStart | WaitsForStart |
/// | WaitsForStart | Goes  | Stopped | WaitsForStart | WaitsForStart |
/// | Stopped       | Goes  | Stopped | Stopped       | Stopped       |
///
/// Thread: one at a time; the owner locks.  Pure: no clock of its own.
class CellMachine {
 public:
  /// False: not taken in this state, and nothing has changed.
  bool on(CellEvent event);

  [[nodiscard]] Sensing sensing() const { return sensing_; }
  [[nodiscard]] Shoe shoe() const { return shoe_; }
  [[nodiscard]] Going going() const { return going_; }
  /// on(event) would take it.
  [[nodiscard]] bool takes(CellEvent event) const;
  /// The next scan, a look at what is held, or one at what was done may be asked for.
  [[nodiscard]] bool may_ask() const;
  [[nodiscard]] bool arm_moves() const { return shoe_ == Shoe::Following || shoe_ == Shoe::InAir; }
  /// It moves, or a person has said yes to that.
  [[nodiscard]] bool arm_will_move() const { return arm_moves() || shoe_ == Shoe::Accepted; }
  /// It was held, and will be held again: a person's word about it is being worked out.
  [[nodiscard]] bool goes_on() const {
    return shoe_ == Shoe::Planning || shoe_ == Shoe::Looking || shoe_ == Shoe::InAir;
  }
  [[nodiscard]] CellState state(Hindrance hindrance) const;

 private:
  Sensing sensing_{Sensing::Starting};
  Shoe shoe_{Shoe::None};
  Going going_{Going::Goes};
};

}  // namespace biteline::service

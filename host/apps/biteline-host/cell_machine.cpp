// SPDX-License-Identifier: MIT
#include "host/apps/biteline-host/cell_machine.hpp"

#include <algorithm>
#include <array>
#include <span>

namespace biteline::service {
namespace {

template <class State>
struct Row {
  State from;
  CellEvent event;
  State to;
};

// clang-format off
constexpr auto k_sensing_rows = [] {
  using enum Sensing;
  using enum CellEvent;
  return std::to_array<Row<Sensing>>({
      {Starting, Heard, Idle},     {Starting, Lost, Away},     {Starting, ScanBegins, Scanning},
      {Away, Heard, Idle},         {Away, Lost, Away},         {Away, ScanBegins, Scanning},
      {Idle, Heard, Idle},         {Idle, Lost, Away},         {Idle, ScanBegins, Scanning},
      {Idle, Asks, Asked},         {Idle, Refuses, Idle},
      {Asked, Heard, Idle},        {Asked, Lost, Away},        {Asked, ScanBegins, Scanning},
      {Asked, Refuses, Idle},
      {Scanning, Heard, Scanning}, {Scanning, Lost, Scanning}, {Scanning, ScanBegins, Scanning},
      {Scanning, ScanIsIn, Idle}});
}();

constexpr auto k_shoe_rows = [] {
  using enum Shoe;
  using enum CellEvent;
  return std::to_array<Row<Shoe>>({
      {None, Works, Working},      {None, Done, None},      {None, Stop, None},
      {Working, Works, Working},   {Working, Done, None},   {Working, Stop, Working},
      {Working, Holds, Held},      {Working, ArmSetsOut, Following},
      {Held, Accept, Accepted},    {Held, Plan, Planning},  {Held, Look, Looking},
      {Held, Reject, None},        {Held, Stop, None},      {Held, Holds, Held},
      {Planning, Works, Working},  {Planning, Done, None},  {Planning, Stop, Planning},
      {Planning, Holds, Held},     {Planning, ArmSetsOut, Following},
      {Planning, AirSetsOut, InAir},
      {Looking, Works, Working},   {Looking, Done, None},   {Looking, Stop, Looking},
      {Looking, Holds, Held},
      {Accepted, Works, Working},  {Accepted, Done, None},  {Accepted, Stop, Accepted},
      {Accepted, Holds, Held},     {Accepted, ArmSetsOut, Following},
      {InAir, Works, Working},     {InAir, Done, None},     {InAir, Stop, InAir},
      {InAir, Holds, Held},
      {Following, Works, Working}, {Following, Done, None}, {Following, Stop, Following},
      {Following, Holds, Held},    {Following, Inspects, Inspecting},
      {Inspecting, Works, Working}, {Inspecting, Done, None}, {Inspecting, Stop, Inspecting}});
}();

constexpr auto k_going_rows = [] {
  using enum Going;
  using enum CellEvent;
  return std::to_array<Row<Going>>({
      {Goes, Start, Goes},          {Goes, Stop, Stopped},          {Goes, Spent, WaitsForStart},
      {WaitsForStart, Start, Goes}, {WaitsForStart, Stop, Stopped}, {WaitsForStart, Spent, WaitsForStart},
      {Stopped, Start, Goes},       {Stopped, Stop, Stopped},       {Stopped, Spent, Stopped},
      {Goes, AsksPerson, WaitsForStart}, {WaitsForStart, AsksPerson, WaitsForStart},
      {Stopped, AsksPerson, Stopped}});
}();
// clang-format on

template <class State>
std::optional<State> after(std::span<const Row<State>> rows, State from, CellEvent event) {
  const auto row = std::ranges::find_if(
      rows, [&](const Row<State>& one) { return one.from == from && one.event == event; });
  return row == rows.end() ? std::nullopt : std::optional{row->to};
}

}  // namespace

bool CellMachine::takes(CellEvent event) const {
  return after<Sensing>(k_sensing_rows, sensing_, event) || after<Shoe>(k_shoe_rows, shoe_, event) ||
         after<Going>(k_going_rows, going_, event);
}

bool CellMachine::on(CellEvent event) {
  const bool taken = takes(event);
  sensing_ = after<Sensing>(k_sensing_rows, sensing_, event).value_or(sensing_);
  shoe_ = after<Shoe>(k_shoe_rows, shoe_, event).value_or(shoe_);
  going_ = after<Going>(k_going_rows, going_, event).value_or(going_);
  return taken;
}

bool CellMachine::may_ask() const {
  if (sensing_ != Sensing::Idle) return false;
  if (shoe_ == Shoe::Inspecting) return going_ != Going::Stopped;
  return shoe_ == Shoe::Looking || (shoe_ == Shoe::None && going_ == Going::Goes);
}

CellState CellMachine::state(Hindrance hindrance) const {
  // An arm that comes to rest is told as it is.
  if (arm_moves()) return CellState::Following;
  if (going_ == Going::Stopped) return CellState::Stopped;
  if (shoe_ == Shoe::Accepted) return CellState::Following;
  if (shoe_ == Shoe::Held) return CellState::Held;
  if (shoe_ == Shoe::Working || shoe_ == Shoe::Planning) return CellState::Working;
  const bool looks = shoe_ == Shoe::Looking || shoe_ == Shoe::Inspecting;
  if (sensing_ == Sensing::Scanning || looks) return CellState::Scanning;
  if (sensing_ == Sensing::Starting) return CellState::Starting;
  if (sensing_ == Sensing::Away) return CellState::NoSensor;
  if (hindrance == Hindrance::Robot) return CellState::NotReady;
  if (hindrance == Hindrance::Rest) return CellState::Resting;
  return going_ == Going::Goes ? CellState::Idle : CellState::WaitsForStart;
}

}  // namespace biteline::service

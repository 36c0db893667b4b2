// SPDX-License-Identifier: MIT
// The table of counts against the schema that strangers read, and through every message that carries it.
#include "common/profile/counts.hpp"

#include <CppUTest/TestHarness.h>

#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "common/wire/messages.hpp"
#include "tests/support/errors.hpp"

namespace biteline::wire {
namespace {

/// The fields of one table of protocol.fbs, in order.
std::vector<std::string> fields_of(const std::string& table) {
  std::ifstream stream{BITELINE_SCHEMA};
  const std::string schema{std::istreambuf_iterator<char>{stream}, {}};
  const std::size_t begin = schema.find("table " + table + " {");
  CHECK_TEXT(begin != std::string::npos, table.c_str());
  std::istringstream lines{schema.substr(begin, schema.find('}', begin) - begin)};
  std::vector<std::string> fields;
  std::string line;
  std::getline(lines, line);
  while (std::getline(lines, line)) {
    const std::size_t colon = line.find(':');
    const std::size_t first = line.find_first_not_of(' ');
    if (colon != std::string::npos && line.compare(first, 2, "//") != 0)
      fields.push_back(line.substr(first, colon - first));
  }
  return fields;
}

template <class Rows>
void rows_are_the_schemas(const std::string& table, const Rows& rows) {
  const std::vector<std::string> fields = fields_of(table);
  for (const auto& row : rows) {
    CHECK_TEXT(row.slot < fields.size(), row.name);
    STRCMP_EQUAL(fields[row.slot].c_str(), row.name);
  }
}

/// Every count another number.
template <class Counts, class Rows>
void number(Counts& counts, const Rows& rows, std::uint64_t first) {
  for (const auto& row : rows) counts.*row.value = first++;
}
template <class Counts, class Rows>
void is_numbered(const Counts& counts, const Rows& rows, std::uint64_t first) {
  for (const auto& row : rows) LONGS_EQUAL_TEXT(first++, counts.*row.value, row.name);
}

}  // namespace

TEST_GROUP(Counts){};

TEST(Counts, EveryRowNamesItsFieldOfTheSchema) {
  rows_are_the_schemas("Counters", profile::k_scan_counts);
  rows_are_the_schemas("TriggerState", profile::k_trigger_counts);
  rows_are_the_schemas("Devices", profile::k_device_counts);
}

TEST(Counts, EveryRowComesThroughHealthAndEndOfScan) {
  Health health;
  number(health.counters, profile::k_scan_counts, 100);
  number(health.devices, profile::k_device_counts, 200);
  number(health.devices.trigger.emplace(), profile::k_trigger_counts, 300);
  const EndOfScan end{.where = {}, .counters = health.counters, .stages = {}, .devices = health.devices};
  for (const Body& body : {Body{health}, Body{end}}) {
    Bytes bytes;
    encode({.body = body}, bytes);
    const Result<Message> message = decode(bytes);
    SUCCEEDS(message);
    const auto* got_health = std::get_if<Health>(&message->body);
    const auto* got_end = std::get_if<EndOfScan>(&message->body);
    const Counters& counters = got_health != nullptr ? got_health->counters : got_end->counters;
    const Devices& devices = got_health != nullptr ? got_health->devices : got_end->devices;
    is_numbered(counters, profile::k_scan_counts, 100);
    is_numbered(devices, profile::k_device_counts, 200);
    is_numbered(*devices.trigger, profile::k_trigger_counts, 300);
  }
}

}  // namespace biteline::wire

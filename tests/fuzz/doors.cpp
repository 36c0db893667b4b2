// SPDX-License-Identifier: MIT
// What others send to a cell and to the centre: requests of doors, words of cells, commands of Sparkplug's
// hosts, bytes of a PLC.  Each is read or refused in one line; what is read is told again and read the same
// way.
#include "host/apps/biteline-web/line/line_talk.hpp"
#include "host/fleet/messages.hpp"
#include "host/fleet/sparkplug/node.hpp"
#include "host/interfaces/control/messages.hpp"
#include "tests/fuzz/case.hpp"

using namespace biteline;

namespace {

void request_of_a_door(std::string_view text) {
  const auto read = control::read_from_door(text);
  if (!read) return fuzz::demand_clean(read.error());
  if (const auto* request = std::get_if<control::Request>(&*read)) {
    const auto again = control::read_from_door(control::to_text(*request));
    fuzz::demand(again.has_value() &&
                     control::to_text(std::get<control::Request>(*again)) == control::to_text(*request),
                 "a request that was read can be sent");
  }
}

void answer_of_the_service(std::string_view text) {
  const auto read = control::read_from_service(text);
  if (!read) fuzz::demand_clean(read.error());
}

template <class Message>
void word_of_the_fleet(const Result<Message>& read, Result<Message> (*reader)(std::string_view)) {
  if (!read) return fuzz::demand_clean(read.error());
  const std::string text = fleet::to_text(*read);
  const auto again = reader(text);
  fuzz::demand(again.has_value() && fleet::to_text(*again) == text, "what a cell said can be said again");
}

void bytes_of_a_plc(web::LineTalk& talk, std::span<const std::uint8_t> bytes) {
  while (!bytes.empty()) {
    const web::LineCut cut = talk.cut(bytes);
    fuzz::demand(cut.used <= bytes.size(), "no more is used than came");
    if (cut.garbled || cut.farewell) return;
    if (cut.used == 0) return fuzz::demand(bytes.size() < web::k_most_request_bytes, "a request has an end");
    for (const std::optional<int>& number : {cut.command.job, cut.command.start})
      fuzz::demand(!number || (*number >= 0 && *number <= 65535), "a number has 16 bits");
    fuzz::demand(cut.command.fault == 0 || talk.answer(cut.command, {}).size() < 300,
                 "a fault's answer is short");
    (void)talk.answer(cut.command, {});
    bytes = bytes.subspan(cut.used);
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const std::unique_ptr<web::LineTalk> text = web::text_talk();
  static const auto modbus = web::modbus_talk();
  fuzz::Case input{data, size};
  const auto kind = input.take<std::uint8_t>();
  const std::vector<std::uint8_t> bytes = input.rest();
  const std::string_view words{reinterpret_cast<const char*>(bytes.data()), bytes.size()};
  switch (kind % 8) {
    case 0:
      request_of_a_door(words);
      break;
    case 1:
      answer_of_the_service(words);
      break;
    case 2:
      word_of_the_fleet<fleet::ShoeMessage>(fleet::read_shoe(words), fleet::read_shoe);
      break;
    case 3:
      word_of_the_fleet<fleet::HealthMessage>(fleet::read_health(words), fleet::read_health);
      break;
    case 4:
      word_of_the_fleet<fleet::CommittedMessage>(fleet::read_committed(words), fleet::read_committed);
      break;
    case 5:
      (void)fleet::sparkplug::Node::asks_rebirth(words);
      break;
    case 6:
      bytes_of_a_plc(*text, bytes);
      break;
    default:
      if (modbus) bytes_of_a_plc(**modbus, bytes);
      break;
  }
  return 0;
}

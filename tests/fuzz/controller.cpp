// SPDX-License-Identifier: MIT
// Two RTDE ends talk to each other; in between bytes are changed, doubled, cut and made up: a controller that
// lies, and a client that does.
#include "common/rtde/client_session.hpp"
#include "common/rtde/controller_session.hpp"
#include "common/rtde/fields.hpp"
#include "tests/fuzz/case.hpp"

using namespace biteline;

namespace {

struct Ears final : rtde::ClientListener, rtde::ControllerListener, rtde::ValueSource {
  void on_data(std::size_t, std::span<const rtde::Value>) override {}
  void on_inputs(const rtde::Recipe&, std::span<const rtde::Value>) override {}
  void on_text(const rtde::TextMessage&) override {}
  rtde::Value value_of(std::string_view name) const override {
    const auto type = rtde::output_type(name);
    return rtde::zero_of(type ? *type : rtde::FieldType::Double);
  }
};

/// What one end said, as the other hears it.
std::vector<std::uint8_t> meddled(rtde::Bytes& said, fuzz::Case& bytes) {
  std::vector<std::uint8_t> heard(said.begin(), said.end());
  said.clear();
  switch (bytes.take<std::uint8_t>() % 6U) {
    case 0:  // one byte is another
      if (!heard.empty()) heard[bytes.take<std::uint16_t>() % heard.size()] = bytes.take<std::uint8_t>();
      break;
    case 1:  // the end is missing
      if (!heard.empty()) heard.resize(bytes.take<std::uint16_t>() % heard.size());
      break;
    case 2: {  // said twice
      const std::vector<std::uint8_t> copy = heard;
      heard.insert(heard.end(), copy.begin(), copy.end());
      break;
    }
    case 3: {  // something made up before it
      std::vector<std::uint8_t> made_up = bytes.take_bytes(bytes.take<std::uint8_t>());
      made_up.insert(made_up.end(), heard.begin(), heard.end());
      heard = std::move(made_up);
      break;
    }
    default:
      break;
  }
  return heard;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  fuzz::Case bytes{data, size};
  rtde::ClientSession client(
      {.outputs = {{.variables = {{"timestamp"}, {"actual_q"}, {"robot_mode"}}, .frequency_hz = 125}},
       .inputs = {}});
  rtde::ControllerSession controller({.newest = bytes.take<std::uint8_t>() % 2 == 0
                                                    ? rtde::ProtocolVersion::V2
                                                    : rtde::ProtocolVersion::V1});
  Ears ears;
  client.start();
  controller.start();
  std::uint64_t cycle = 0;
  for (int turn = 0; turn < 200 && !bytes.empty(); ++turn) {
    const std::vector<std::uint8_t> to_controller = meddled(client.outgoing(), bytes);
    if (const auto heard = controller.consume(to_controller, ears); !heard) {
      fuzz::demand_clean(heard.error());
      controller.start();
    }
    for (int i = 0; i < 5; ++i) controller.append_outputs(cycle++, ears);
    const std::vector<std::uint8_t> to_client = meddled(controller.outgoing(), bytes);
    if (const auto heard = client.consume(to_client, ears); !heard) {
      fuzz::demand_clean(heard.error());
      client.start();
    }
    fuzz::demand(client.outgoing().size() < (1U << 20U), "a client's questions are bounded");
  }
  return 0;
}

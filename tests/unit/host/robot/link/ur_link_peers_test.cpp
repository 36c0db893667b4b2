// SPDX-License-Identifier: MIT
// Controllers that answer otherwise than ours: types, texts, versions, numbers, silence.
#include <CppUTest/TestHarness.h>
#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <functional>
#include <limits>
#include <thread>

#include "common/rtde/controller_session.hpp"
#include "host/robot/link/ur/ur_link.hpp"
#include "tests/support/timed_test.hpp"

namespace biteline::robot::ur {
namespace {

// Generous: a busy machine must not fail the test, and a right answer comes in milliseconds.
constexpr Nanoseconds k_patience{20'000'000'000};

struct Numbers final : rtde::ValueSource {
  double timestamp_s{10};
  double pose_x_m{0.5};
  rtde::Value value_of(std::string_view name) const override {
    if (name == "timestamp") return timestamp_s;
    if (name == "actual_TCP_pose") return rtde::Vector6{pose_x_m, 0, 0, 0, 0, 0};
    return rtde::zero_of(*rtde::output_type(name));
  }
};

/// Speaks as the codec does, through `spoil`, which changes what is about to be sent.
class OddController final : public rtde::ControllerListener {
 public:
  using Spoil = std::function<void(rtde::Bytes&)>;
  explicit OddController(Spoil spoil, Numbers numbers = {}, rtde::ControllerSession::Config config = {},
                         rtde::Bytes greeting = {})
      : spoil_{std::move(spoil)}, numbers_{numbers}, session_{config}, greeting_{std::move(greeting)} {
    listener_ = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof address;
    CHECK_EQUAL(0, bind(listener_, reinterpret_cast<const sockaddr*>(&address), size));
    CHECK_EQUAL(0, listen(listener_, 4));
    getsockname(listener_, reinterpret_cast<sockaddr*>(&address), &size);
    port_ = ntohs(address.sin_port);
    thread_ = std::thread{[this] { serve(); }};
  }
  ~OddController() override {
    stopping_ = true;
    thread_.join();
    close(listener_);
  }
  OddController(const OddController&) = delete;
  OddController& operator=(const OddController&) = delete;

  [[nodiscard]] Result<std::unique_ptr<UrLink>> open(double patience_s = 20) const {
    return UrLink::open({.host = "127.0.0.1", .rtde_port = port_, .connect_patience_s = patience_s});
  }
  [[nodiscard]] int connections() const { return connections_; }

  void on_inputs(const rtde::Recipe&, std::span<const rtde::Value>) override {}
  void on_text(const rtde::TextMessage&) override {}

 private:
  void serve() {
    int client = -1;
    for (std::uint64_t cycle = 0; !stopping_; ++cycle) {
      pollfd entry{listener_, POLLIN, 0};
      if (poll(&entry, 1, 2) > 0) {
        if (client >= 0) close(client);
        client = accept(listener_, nullptr, nullptr);
        ++connections_;
        session_.start();
        static_cast<void>(send(client, greeting_.data(), greeting_.size(), MSG_NOSIGNAL));
      }
      if (client < 0) continue;
      std::uint8_t bytes[4096];
      const ssize_t got = recv(client, bytes, sizeof bytes, MSG_DONTWAIT);
      if (got > 0) static_cast<void>(session_.consume({bytes, static_cast<std::size_t>(got)}, *this));
      session_.append_outputs(cycle, numbers_);
      if (spoil_) spoil_(session_.outgoing());
      static_cast<void>(send(client, session_.outgoing().data(), session_.outgoing().size(), MSG_NOSIGNAL));
      session_.outgoing().clear();
    }
    if (client >= 0) close(client);
  }

  Spoil spoil_;
  Numbers numbers_;
  rtde::ControllerSession session_;
  rtde::Bytes greeting_;
  int listener_{-1};
  std::uint16_t port_{0};
  std::atomic<int> connections_{0};
  std::atomic<bool> stopping_{false};
  std::thread thread_;
};

/// Replaces words of the types that the controller tells.
OddController::Spoil instead_of(std::string was, std::string is) {
  return [was, is](rtde::Bytes& bytes) {
    const auto at = std::search(bytes.begin(), bytes.end(), was.begin(), was.end());
    if (at == bytes.end()) return;
    const std::size_t place = static_cast<std::size_t>(at - bytes.begin());
    bytes.erase(at, at + static_cast<std::ptrdiff_t>(was.size()));
    for (std::size_t i = 0; i < is.size(); ++i)
      bytes.insert(bytes.begin() + static_cast<std::ptrdiff_t>(place + i), static_cast<std::uint8_t>(is[i]));
    // Its package is the first one in these bytes: nothing else is answered before the recipe is.
    bytes[1] = static_cast<std::uint8_t>(bytes[1] + is.size() - was.size());
  };
}

/// Ten states, each newer than the one before.
bool states_come(const UrLink& link) {
  std::uint64_t sequence = 0;
  for (int i = 0; i < 10; ++i) {
    const auto state = link.wait_newer(sequence, k_patience);
    if (!state) return false;
    sequence = state->sequence;
  }
  return true;
}

}  // namespace

TEST_GROUP(UrLinkPeers){};

ORDINARY_TIMED_TEST(UrLinkPeers, FieldsOfAnotherTypeAreRefusedByNameAndAtOnce) {
  const std::string all = "DOUBLE,VECTOR6D,VECTOR6D,VECTOR6D,INT32,INT32,UINT32,DOUBLE";
  const struct {
    const char *told, *reason;
  } rows[] = {
      {"UINT64,VECTOR6D,VECTOR6D,VECTOR6D,INT32,INT32,UINT32,DOUBLE", "timestamp: UINT64, DOUBLE expected"},
      {"DOUBLE,VECTOR6D,VECTOR3D,VECTOR6D,INT32,INT32,UINT32,DOUBLE",
       "actual_TCP_pose: VECTOR3D, VECTOR6D expected"},
      {"DOUBLE,VECTOR6D,VECTOR6D,VECTOR6D,UINT32,INT32,UINT32,DOUBLE", "robot_mode: UINT32, INT32 expected"},
      {"DOUBLE,VECTOR6D,VECTOR6D,VECTOR6D,INT32,UINT32,UINT32,DOUBLE", "safety_mode: UINT32, INT32 expected"},
      {"DOUBLE,VECTOR6D,VECTOR6D,VECTOR6D,INT32,INT32,INT32,DOUBLE", "runtime_state: INT32, UINT32 expected"},
      {"DOUBLE,VECTOR6D,VECTOR6D,VECTOR6D,INT32,INT32,UINT32,VECTOR6D",
       "speed_scaling: VECTOR6D, DOUBLE expected"},
      {"DOUBLE,NOT_FOUND,VECTOR6D,VECTOR6D,INT32,INT32,UINT32,DOUBLE", "actual_q: NOT_FOUND"},
      {"DOUBLE,VECTOR6D,VECTOR6D,NOT_FOUND,INT32,INT32,UINT32,DOUBLE",
       "tcp_offset: NOT_FOUND: the controller's software is too old, PolyScope 3.12.3 or 5.5.1"},
      {"DOUBLE,IN_USE,VECTOR6D,VECTOR6D,INT32,INT32,UINT32,DOUBLE", "actual_q: IN_USE"},
  };
  for (const auto& row : rows) {
    const OddController controller{instead_of(all, row.told)};
    // A patience that would end the test's own: the refusal is not asked for again until it is over.
    const auto link = controller.open(3600);
    CHECK_FALSE(link.has_value());
    STRCMP_CONTAINS(row.reason, link.error().where.c_str());
    CHECK(link.error().code == Errc::PeerRefused);
    CHECK_EQUAL(1, controller.connections());
  }
}

ORDINARY_TIMED_TEST(UrLinkPeers, NeitherVersionIsRefusedAtOnce) {
  const OddController controller{[](rtde::Bytes& bytes) {
    if (bytes.size() >= 4 && bytes[2] == 'V') bytes[3] = 0;
  }};
  const auto link = controller.open(3600);
  CHECK_FALSE(link.has_value());
  STRCMP_CONTAINS("neither RTDE version 2 nor 1", link.error().where.c_str());
}

ORDINARY_TIMED_TEST(UrLinkPeers, TextBeforeTheVersionsAnswerIsHeardAndCostsNothing) {
  rtde::Bytes greeting;
  append(greeting,
         rtde::ControllerMessage{
             rtde::TextMessage{.level = rtde::TextLevel::Warning, .text = "robot is off", .source = ""}},
         rtde::ProtocolVersion::V1);
  const OddController controller{{}, {}, {}, greeting};
  const auto link = controller.open();
  CHECK(link.has_value());
  CHECK(states_come(**link));
  STRCMP_EQUAL("robot is off", (*link)->status().last_text.c_str());
  CHECK_EQUAL(1, controller.connections());
}

ORDINARY_TIMED_TEST(UrLinkPeers, TextsCutShortAndUnknownPackagesAreCountedOnARunningLink) {
  const OddController controller{[](rtde::Bytes& bytes) {
    if (bytes.size() < 3 || bytes[2] != 'U') return;
    for (const char byte : {'\0', '\5', 'M', 'c', 'd', '\0', '\4', 'Z', '1'})
      bytes.push_back(static_cast<std::uint8_t>(byte));
  }};
  const auto link = controller.open();
  CHECK(link.has_value());
  // What stands behind a state is read after it.
  for (int i = 0; i < 1000 && (*link)->status().unknown_packages < 9; ++i) CHECK(states_come(**link));
  CHECK((*link)->status().unreadable_texts >= 9);
  CHECK((*link)->status().unknown_packages >= 9);
  CHECK_EQUAL(1U, (*link)->status().connections);
}

ORDINARY_TIMED_TEST(UrLinkPeers, Version1AndTheRateOfACb3AreTaken) {
  const OddController controller{{},
                                 {},
                                 {.version = {.major = 3, .minor = 15, .bugfix = 8, .build = 106339},
                                  .newest = rtde::ProtocolVersion::V1,
                                  .rate_hz = 125}};
  const auto link = controller.open();
  CHECK(link.has_value());
  CHECK(states_come(**link));
  CHECK_EQUAL(0U, (*link)->status().unusable_states);
}

ORDINARY_TIMED_TEST(UrLinkPeers, NumbersThatNobodyCanMeanAreToldAndCounted) {
  constexpr double k_nan = std::numeric_limits<double>::quiet_NaN();
  const struct {
    Numbers numbers;
    const char* reason;
  } rows[] = {{[] {
                 Numbers n;
                 n.timestamp_s = 1e300;
                 return n;
               }(),
               "timestamp of 1e+300 s"},
              {[] {
                 Numbers n;
                 n.timestamp_s = k_nan;
                 return n;
               }(),
               "timestamp of nan s"},
              {[] {
                 Numbers n;
                 n.pose_x_m = k_nan;
                 return n;
               }(),
               "actual_TCP_pose without numbers"}};
  for (const auto& row : rows) {
    const OddController controller{{}, row.numbers};
    const auto link = controller.open(0.5);
    CHECK_FALSE(link.has_value());
    STRCMP_CONTAINS(row.reason, link.error().where.c_str());
    STRCMP_CONTAINS("none of use", link.error().where.c_str());
  }
}

ORDINARY_TIMED_TEST(UrLinkPeers, HandshakesThatAreNotDoneInTimeAreToldSo) {
  const OddController silent{[](rtde::Bytes& bytes) { bytes.clear(); }};
  const auto none = silent.open(0.3);
  CHECK_FALSE(none.has_value());
  STRCMP_CONTAINS("hand-shake not done", none.error().where.c_str());
  const OddController no_data{[](rtde::Bytes& bytes) {
    if (bytes.size() >= 3 && bytes[2] == 'U') bytes.clear();
    if (bytes.size() >= 3 && bytes[2] == 'S') bytes.resize(4);  // the answer, without the data behind it
  }};
  const auto nothing = no_data.open(0.5);
  CHECK_FALSE(nothing.has_value());
  STRCMP_CONTAINS("no data", nothing.error().where.c_str());
}

}  // namespace biteline::robot::ur

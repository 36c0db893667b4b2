// SPDX-License-Identifier: MIT
#include "host/robot/link/ur/pendant_watch.hpp"

#include <CppUTest/TestHarness.h>

#include <memory>

#include "host/robot/link/ur/remote_control.hpp"
#include "tests/unit/host/robot/link/fake_controller.hpp"

namespace biteline::robot::ur {
namespace {

constexpr const char* k_remote_question = "is in remote control";

using namespace std::chrono_literals;

constexpr auto k_most = 20s;  // of a loaded machine

}  // namespace

TEST_GROUP(PendantWatch) {
  std::unique_ptr<test::FakeController> controller = std::make_unique<test::FakeController>();
  std::atomic<int> taken{0};
  std::unique_ptr<PendantWatch> sut;

  void setup() override {
    controller->answers = {{k_remote_question, "true"}};
  }
  void teardown() override {
    sut.reset();
    controller.reset();
  }
  void watch() {
    sut = std::make_unique<PendantWatch>(
        PendantWatch::Config{.doors = {.dashboard = {"127.0.0.1", controller->dashboard_port()}},
                             .period = 5ms,
                             .patience = 2s,
                             .retry = 20ms},
        [this] { ++taken; });
  }
  std::size_t questions() const {
    const std::string said = controller->dashboard();
    std::size_t count = 0;
    for (std::size_t at = said.find(k_remote_question); at != std::string::npos;
         at = said.find(k_remote_question, at + 1))
      ++count;
    return count;
  }
  /// So many more questions have been answered.
  void hear_more(std::size_t count) const {
    const std::size_t wanted = questions() + count;
    const auto until = std::chrono::steady_clock::now() + k_most;
    while (questions() < wanted && std::chrono::steady_clock::now() < until) std::this_thread::sleep_for(1ms);
    CHECK(questions() >= wanted);
  }
};

TEST(PendantWatch, EachTimeThatTheArmIsTakenIsToldOnce) {
  watch();
  hear_more(3);
  LONGS_EQUAL(0, taken);
  for (int time = 1; time <= 3; ++time) {
    controller->local_control = true;
    hear_more(5);
    LONGS_EQUAL(time, taken);
    controller->local_control = false;
    hear_more(5);
    LONGS_EQUAL(time, taken);
  }
}

TEST(PendantWatch, AnArmThatNobodyHadGivenIsTakenByNobody) {
  controller->local_control = true;
  watch();
  hear_more(5);
  LONGS_EQUAL(0, taken);
}

TEST(PendantWatch, OneNoIsAskedAgainAndTwoAreBelieved) {
  watch();
  hear_more(3);
  controller->noes = 1;
  hear_more(5);
  LONGS_EQUAL(0, taken);
  controller->noes = 2;
  hear_more(5);
  LONGS_EQUAL(1, taken);
}

TEST(PendantWatch, AControllerWithoutRemoteControlIsNeverTaken) {
  controller->answers[k_remote_question] = "could not understand: 'is in remote control'";
  watch();
  hear_more(5);
  LONGS_EQUAL(0, taken);
}

/// The key switch may close connections: what it says on the next one counts.
TEST(PendantWatch, AnArmThatWasTakenWhileTheDashboardWasAwayIsTold) {
  watch();
  hear_more(3);
  controller->mute_dashboard = true;
  controller->local_control = true;
  // Its patience ends, and so does the connection.
  std::this_thread::sleep_for(2500ms);
  LONGS_EQUAL(0, taken);
  controller->mute_dashboard = false;
  hear_more(5);
  LONGS_EQUAL(1, taken);
}

TEST(PendantWatch, WhoeverFollowsHasTheSay) {
  watch();
  hear_more(3);
  {
    const PendantWatch::Rest rest{sut.get()};
    // A question may be on its way.
    std::this_thread::sleep_for(100ms);
    const std::size_t before = questions();
    controller->local_control = true;
    std::this_thread::sleep_for(200ms);
    LONGS_EQUAL(before, questions());
    LONGS_EQUAL(0, taken);
    sut->tell_taken();
    LONGS_EQUAL(1, taken);
  }
  hear_more(5);
  LONGS_EQUAL(1, taken);
  const PendantWatch::Rest none{nullptr};
}

}  // namespace biteline::robot::ur

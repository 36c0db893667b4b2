// SPDX-License-Identifier: MIT
#include "host/robot/link/ur/pendant_watch.hpp"

#include <pthread.h>

#include <algorithm>
#include <chrono>
#include <utility>

#include "host/robot/link/ur/remote_control.hpp"

namespace biteline::robot::ur {
namespace {

/// How soon the thread notices that it should end.
constexpr Nanoseconds k_turn{50'000'000};

}  // namespace

PendantWatch::PendantWatch(const Config& config, std::function<void()> taken)
    : config_{config}, taken_{std::move(taken)}, thread_{[this] { run(); }} {}

PendantWatch::~PendantWatch() {
  stopping_ = true;
  thread_.join();
}

void PendantWatch::tell_taken() {
  remote_ = false;
  taken_();
}

void PendantWatch::run() {
  pthread_setname_np(pthread_self(), "bl-pendant");
  while (!stopping_) {
    if (const auto door = ControllerDoor::open(config_.doors, config_.patience))
      static_cast<void>(watch(**door));
    sleep(config_.retry);
  }
}

Result<void> PendantWatch::watch(ControllerDoor& door) {
  while (!stopping_) {
    if (resting_ == 0) {
      BITELINE_ASSIGN(const std::optional<bool> remote, ask(door));
      // A follower that began meanwhile has the say.
      if (remote && resting_ == 0 && remote_.exchange(*remote) && !*remote) taken_();
    }
    sleep(config_.period);
  }
  return {};
}

Result<std::optional<bool>> PendantWatch::ask(ControllerDoor& door) const {
  RemoteControl remote;
  while (true) {
    BITELINE_TRY(door.ask_remote());
    BITELINE_ASSIGN(const std::string answer, door.hear_remote(config_.patience));
    if (remote.hear(answer)) return remote.told();
  }
}

void PendantWatch::sleep(Nanoseconds time) const {
  const auto until = std::chrono::steady_clock::now() + time;
  while (!stopping_) {
    const Nanoseconds left = until - std::chrono::steady_clock::now();
    if (left <= Nanoseconds{0}) return;
    std::this_thread::sleep_for(std::min(left, k_turn));
  }
}

}  // namespace biteline::robot::ur

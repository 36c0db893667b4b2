// SPDX-License-Identifier: MIT
#include "host/apps/biteline-web/service_door.hpp"

#include <mutex>
#include <utility>

namespace biteline::web {
namespace {

control::Answer host_away() {
  return control::refusal(503, "host_away",
                          "biteline-host does not answer: nothing was done; it is tried again by itself, and "
                          "`biteline-host --control` or --web must run");
}

/// Told to the clients when the service goes or comes: they read the state again.
control::Event link_event(bool connected) {
  return {.name = "host", .data = {{"connected", connected}}, .seq = 0, .time = control::utc_now()};
}

/// The client's own refusals under the codes of the OpenAPI file.
control::Answer in_words_of_the_api(control::Answer answer) {
  const auto error = answer.body.is_object() ? answer.body.find("error") : answer.body.end();
  if ((answer.status != 503 && answer.status != 504) || error == answer.body.end()) return answer;
  const auto code = error->find("code");
  if (code == error->end()) return answer;
  if (*code == "service_gone") return host_away();
  if (*code == "busy") *code = "too_busy";
  if (*code == "no_answer") *code = "host_late";
  return answer;
}

class ControlDoor final : public ServiceDoor {
 public:
  Result<void> open(const control::ClientConfig& config) {
    BITELINE_ASSIGN(client_, control::Client::open(
                                 config, [this](const control::Event& event) { hear(event); },
                                 [this](bool connected) { hear(link_event(connected)); }));
    return {};
  }

  void ask(control::Request request, OnAnswer on_answer) override {
    // What would wait for a service that is away is told at once.
    if (!client_->connected()) return on_answer(host_away());
    client_->ask(std::move(request), [on_answer = std::move(on_answer)](control::Answer answer) {
      on_answer(in_words_of_the_api(std::move(answer)));
    });
  }

  void listen(OnEvent on_event) override {
    const std::lock_guard lock{mutex_};
    on_event_ = std::move(on_event);
    if (hello_) on_event_(*hello_);
    hello_.reset();
  }

 private:
  void hear(const control::Event& event) {
    const std::lock_guard lock{mutex_};
    if (on_event_) return on_event_(event);
    if (event.name == "hello") hello_ = event;
  }

  std::mutex mutex_;
  OnEvent on_event_;
  std::optional<control::Event> hello_;      // the service says it once: kept for who listens later
  std::unique_ptr<control::Client> client_;  // last: its thread uses the rest
};

class ClosedDoor final : public ServiceDoor {
 public:
  void ask(control::Request /*request*/, OnAnswer on_answer) override { on_answer(host_away()); }
  void listen(OnEvent /*on_event*/) override {}
};

}  // namespace

Result<std::unique_ptr<ServiceDoor>> open_service_door(const control::ClientConfig& config) {
  auto door = std::make_unique<ControlDoor>();
  BITELINE_TRY(door->open(config));
  return door;
}

std::unique_ptr<ServiceDoor> closed_service_door() {
  return std::make_unique<ClosedDoor>();
}

}  // namespace biteline::web

// SPDX-License-Identifier: MIT
#include "common/gige/control_channel.hpp"

#include "common/gige/bootstrap.hpp"

namespace biteline::gige {
namespace {

/// A device's server looks at its own clock a moment later than this does.
constexpr std::chrono::milliseconds k_server_is_later{20};

}  // namespace

std::optional<std::vector<std::uint8_t>> ControlChannel::answer_for(const Peer& from,
                                                                    std::span<const std::uint8_t> packet,
                                                                    Clock::time_point now) {
  if (controller_ && now - heard_ > timeout_ + k_server_is_later) controller_.reset();
  asking_ = from;
  asked_at_ = now;
  const std::optional<Command> command = read_command(packet);
  if (!command || command->body.size() < 4) return std::nullopt;
  const bool to_privilege = word_at(command->body, 0) == bootstrap::k_privilege;
  const bool controls = controller_ == from;
  if (controls) heard_ = now;
  if (command->code == command::k_read_register && to_privilege) {
    if (controls || !controller_) return std::nullopt;
    const std::uint8_t privilege[] = {0, 0, 0, static_cast<std::uint8_t>(privilege_)};
    return answer(Status::Success, *command, privilege);
  }
  if (command->code != command::k_write_register && command->code != command::k_write_memory)
    return std::nullopt;
  const bool takes_control = !controller_ && command->code == command::k_write_register && to_privilege;
  if (controls || takes_control) return std::nullopt;
  return answer(Status::AccessDenied, *command, {});
}

std::optional<Peer> ControlChannel::controller(Clock::time_point now) const {
  return controller_ && now - heard_ > timeout_ + k_server_is_later ? std::nullopt : controller_;
}

void ControlChannel::set_privilege(std::uint32_t privilege) {
  privilege_ = privilege;
  if (privilege == 0) return controller_.reset();
  controller_ = asking_;
  heard_ = asked_at_;
}

}  // namespace biteline::gige

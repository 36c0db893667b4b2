// SPDX-License-Identifier: MIT
#include "tests/soak/controller_between.hpp"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>

#include <cerrno>
#include <limits>
#include <utility>

#include "hal/sim/live/urgency.hpp"

namespace biteline::soak {
namespace {

hal::Descriptor connect_to(std::uint16_t port) {
  hal::Descriptor socket{::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)};
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(port);
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  if (::connect(socket.number(), reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0) return {};
  const int now = 1;
  ::setsockopt(socket.number(), IPPROTO_TCP, TCP_NODELAY, &now, sizeof now);
  return socket;
}

/// The value of `name` in a state, changed by the lie.
void tell_lie(Lie lie, const std::string& name, rtde::Value& value) {
  auto* const six = std::get_if<rtde::Vector6>(&value);
  if (lie == Lie::TipAside && name == "actual_TCP_pose" && six != nullptr) (*six)[2] -= 0.08;
  if (lie == Lie::NotANumber && name == "actual_TCP_pose" && six != nullptr)
    six->fill(std::numeric_limits<double>::quiet_NaN());
  if (lie == Lie::OtherTool && name == "tcp_offset" && six != nullptr) (*six)[2] += 0.05;
  if (lie == Lie::PowerOff && name == "robot_mode" && std::holds_alternative<std::int32_t>(value)) value = 3;
  if (lie == Lie::SaysEnded && name == "runtime_state") value = std::uint32_t{1};
  if (lie == Lie::ToolOn && name == "actual_digital_output_bits") value = std::uint64_t{1};
}

}  // namespace

Result<std::unique_ptr<ControllerBetween>> ControllerBetween::open(sim::UrController::Ports controller) {
  std::unique_ptr<ControllerBetween> between{new ControllerBetween};
  for (const auto& [kind, port] :
       {std::pair{Kind::Rtde, controller.rtde}, std::pair{Kind::Script, controller.primary},
        std::pair{Kind::Dashboard, controller.dashboard}}) {
    BITELINE_ASSIGN(sim::TcpListener listener, sim::listen_on_loopback(0));
    between->doors_.push_back({.kind = kind, .listener = std::move(listener), .controller_port = port});
  }
  // As the controller itself: a host's limits of time are for the arm, not for this machine.
  const sim::Urgently urgently{sim::k_robot_priority};
  between->thread_ = std::jthread{[self = between.get()](const std::stop_token& stop) { self->relay(stop); }};
  return between;
}

ControllerBetween::~ControllerBetween() = default;

std::vector<std::string> ControllerBetween::take_scripts() {
  const std::lock_guard lock{scripts_mutex_};
  return std::exchange(scripts_, {});
}

void ControllerBetween::relay(const std::stop_token& stop) {
  while (!stop.stop_requested()) {
    std::vector<pollfd> waits;
    for (const Door& door : doors_) waits.push_back({door.listener.socket.number(), POLLIN, 0});
    for (const auto& pair : pairs_) {
      waits.push_back({pair->host.number(), POLLIN, 0});
      waits.push_back({pair->controller.number(), POLLIN, 0});
    }
    const bool unplugged = lie == Lie::Unplugged;
    // Sockets that are not read would wake it at once.
    if (unplugged) {
      std::this_thread::sleep_for(std::chrono::milliseconds{5});
      continue;
    }
    ::poll(waits.data(), waits.size(), lie == Lie::Lagging ? 2 : 20);
    accept();
    std::erase_if(pairs_, [this](const std::unique_ptr<Pair>& pair) { return !pass(*pair); });
  }
}

void ControllerBetween::accept() {
  for (const Door& door : doors_) {
    hal::Descriptor host = sim::accept_from(door.listener);
    if (host.number() < 0) continue;
    auto pair = std::make_unique<Pair>();
    pair->kind = door.kind;
    pair->host = std::move(host);
    pair->controller = connect_to(door.controller_port);
    if (pair->controller.number() < 0) continue;
    if (door.kind == Kind::Rtde) {
      pair->from_host = std::make_unique<rtde::PackageSplitter>();
      pair->from_controller = std::make_unique<rtde::PackageSplitter>();
    }
    pairs_.push_back(std::move(pair));
  }
}

bool ControllerBetween::pass(Pair& pair) {
  if (lie == Lie::Cut && pair.kind == Kind::Rtde) return false;
  std::vector<std::uint8_t> bytes;
  const bool host_there = sim::read_available(pair.host, bytes);
  if (lie == Lie::DeafDoors && pair.kind != Kind::Rtde) bytes.clear();
  hear_host(pair, bytes);
  bytes.clear();
  const bool controller_there = sim::read_available(pair.controller, bytes);
  if (!hear_controller(pair, bytes)) return false;
  if (pair.kind == Kind::Rtde) hold_back(pair);
  const bool sent = sim::write_available(pair.controller, pair.to_controller) &&
                    sim::write_available(pair.host, pair.to_host);
  return host_there && controller_there && sent;
}

void ControllerBetween::hear_host(Pair& pair, std::span<const std::uint8_t> bytes) {
  pair.to_controller.insert(pair.to_controller.end(), bytes.begin(), bytes.end());
  if (pair.kind == Kind::Rtde) {
    while (!bytes.empty()) {
      bytes = bytes.subspan(pair.from_host->feed(bytes));
      for (auto next = pair.from_host->next(); next && *next; next = pair.from_host->next()) {
        if ((*next)->type != rtde::PackageType::SetupOutputs) continue;
        const auto message = rtde::read_client_message(**next, pair.version);
        if (!message) continue;
        if (const auto* setup = std::get_if<rtde::SetupOutputsRequest>(&*message)) pair.asked = setup->names;
      }
    }
    return;
  }
  pair.words.append(bytes.begin(), bytes.end());
  const std::string end = pair.kind == Kind::Script ? "\nend\n" : "\n";
  for (std::size_t at; (at = pair.words.find(end)) != std::string::npos;) {
    const std::string whole = pair.words.substr(0, at + end.size());
    pair.words.erase(0, at + end.size());
    if (pair.kind == Kind::Dashboard) {
      if (whole.starts_with("stop")) ++stops_;
      continue;
    }
    const std::lock_guard lock{scripts_mutex_};
    scripts_.push_back(whole);
  }
}

bool ControllerBetween::hear_controller(Pair& pair, std::span<const std::uint8_t> bytes) {
  if (pair.kind != Kind::Rtde) {
    pair.to_host.insert(pair.to_host.end(), bytes.begin(), bytes.end());
    return true;
  }
  while (!bytes.empty()) {
    bytes = bytes.subspan(pair.from_controller->feed(bytes));
    for (;;) {
      const auto next = pair.from_controller->next();
      if (!next) return false;
      if (!*next) break;
      take_reply(pair, **next);
      if ((*next)->type == rtde::PackageType::Data) {
        pass_state(pair, **next);
      } else {
        rtde::append_package(pair.to_host, (*next)->type, (*next)->payload);
      }
    }
  }
  return true;
}

void ControllerBetween::take_reply(Pair& pair, const rtde::Package& package) {
  if (package.type != rtde::PackageType::ProtocolVersion && package.type != rtde::PackageType::SetupOutputs)
    return;
  const auto message = rtde::read_controller_message(package, pair.version);
  if (!message) return;
  if (const auto* version = std::get_if<rtde::ProtocolVersionReply>(&*message); version && version->accepted)
    pair.version = rtde::ProtocolVersion::V2;
  const auto* setup = std::get_if<rtde::SetupOutputsReply>(&*message);
  if (setup == nullptr) return;
  rtde::Recipe recipe{.id = setup->recipe_id, .names = pair.asked, .types = {}};
  for (const std::string& name : setup->types) {
    if (const auto type = rtde::field_type_of(name)) recipe.types.push_back(*type);
  }
  if (recipe.types.size() == recipe.names.size()) pair.recipes.push_back(std::move(recipe));
}

void ControllerBetween::hold_back(Pair& pair) {
  constexpr double k_more_s_per_s = 0.12;
  const Clock::time_point now = Clock::now();
  if (lie != Lie::Lagging) {
    lagging_since_.reset();
  } else {
    if (!lagging_since_) lagging_since_ = now;
    if (!pair.to_host.empty())
      pair.held.emplace_back(
          now + std::chrono::duration_cast<Clock::duration>(k_more_s_per_s * (now - *lagging_since_)),
          std::exchange(pair.to_host, {}));
  }
  while (!pair.held.empty() && (pair.held.front().first <= now || lie != Lie::Lagging)) {
    const auto& bytes = pair.held.front().second;
    pair.to_host.insert(pair.to_host.end(), bytes.begin(), bytes.end());
    pair.held.pop_front();
  }
}

void ControllerBetween::pass_state(Pair& pair, const rtde::Package& package) {
  const Lie told = lie;
  if (told == Lie::Silent) return;
  const rtde::DataHeader header = rtde::output_header(pair.version);
  const auto recipe = rtde::recipe_of(package, pair.recipes, header);
  std::vector<rtde::Value> values;
  if (told == Lie::None || !recipe || !rtde::read_data(package, pair.recipes[*recipe], header, values))
    return rtde::append_package(pair.to_host, package.type, package.payload);
  for (std::size_t i = 0; i < values.size(); ++i) tell_lie(told, pair.recipes[*recipe].names[i], values[i]);
  rtde::append_data(pair.to_host, pair.recipes[*recipe], values, header);
}

}  // namespace biteline::soak

// SPDX-License-Identifier: MIT
#include "host/fleet/broker.hpp"

#include <mosquitto.h>
#include <mqtt_protocol.h>

#include <algorithm>
#include <mutex>
#include <thread>
#include <utility>

#include "common/wire/endpoint.hpp"

namespace biteline::fleet {
namespace {

using Clock = std::chrono::steady_clock;

constexpr int k_keepalive_s = 10;
constexpr std::chrono::milliseconds k_between_tries{1000};
constexpr int k_at_least_once = 1;

/// The library's own state, begun with the first line and kept to the program's end.
void begin_library() {
  static std::once_flag once;
  std::call_once(once, [] { mosquitto_lib_init(); });
}

Result<void> check_files(const TlsFiles& files) {
  std::error_code error;
  for (const std::filesystem::path* file : {&files.authority, &files.certificate, &files.key}) {
    if (!std::filesystem::is_regular_file(*file, error))
      return fail(Errc::FileNotFound, "%.200s: a PEM file of the broker's TLS expected", file->c_str());
  }
  return {};
}

}  // namespace

struct Broker::State {
  BrokerConfig config;
  OnMessage on_message;
  OnReady on_ready;
  mosquitto* client{nullptr};
  bool begun{false};  ///< connect was called
  bool lost{true};    ///< no connection, as far as is known
  bool subscribed{false};
  int refused{0};  ///< the broker's reason, 0: none
  Clock::time_point tried{};

  ~State() {
    if (client == nullptr) return;
    if (begun && !lost) {
      mosquitto_disconnect_v5(client, 0, nullptr);
      // Written out where it can be at once; nobody waits for a broker that is away.
      mosquitto_loop(client, 0, 1);
    }
    mosquitto_destroy(client);
  }

  Result<void> open();
  Result<void> connect();
  void subscribe();
};

Result<void> Broker::State::open() {
  begin_library();
  client = mosquitto_new(config.client.c_str(), true, this);
  if (client == nullptr)
    return fail(Errc::InvalidArgument, "broker: '%.60s' is no client's name", config.client.c_str());
  mosquitto_int_option(client, MOSQ_OPT_PROTOCOL_VERSION, MQTT_PROTOCOL_V5);
  if (config.tls) {
    BITELINE_TRY(check_files(*config.tls));
    const TlsFiles& tls = *config.tls;
    mosquitto_int_option(client, MOSQ_OPT_TLS_USE_OS_CERTS, 0);
    const int set = mosquitto_tls_set(client, tls.authority.c_str(), nullptr, tls.certificate.c_str(),
                                      tls.key.c_str(), nullptr);
    if (set != MOSQ_ERR_SUCCESS || mosquitto_tls_opts_set(client, 1, "tlsv1.2", nullptr) != MOSQ_ERR_SUCCESS)
      return fail(Errc::FileUnreadable, "%.150s: PEM files of authority, certificate and key expected: %s",
                  tls.authority.c_str(), mosquitto_strerror(set));
  }
  if (!config.will_topic.empty()) {
    mosquitto_will_set_v5(client, config.will_topic.c_str(), static_cast<int>(config.will.size()),
                          config.will.data(), k_at_least_once, config.will_kept, nullptr);
  }
  mosquitto_connect_v5_callback_set(client,
                                    [](mosquitto*, void* self, int reason, int, const mosquitto_property*) {
                                      auto& state = *static_cast<State*>(self);
                                      state.refused = reason;
                                      if (reason == 0) state.subscribe();
                                    });
  mosquitto_disconnect_v5_callback_set(client, [](mosquitto*, void* self, int, const mosquitto_property*) {
    auto& state = *static_cast<State*>(self);
    state.lost = true;
    state.subscribed = false;
  });
  mosquitto_subscribe_v5_callback_set(
      client, [](mosquitto*, void* self, int, int, const int*, const mosquitto_property*) {
        auto& state = *static_cast<State*>(self);
        state.subscribed = true;
        state.on_ready();
      });
  mosquitto_message_v5_callback_set(client, [](mosquitto*, void* self, const mosquitto_message* message,
                                               const mosquitto_property*) {
    static_cast<State*>(self)->on_message(message->topic, {static_cast<const char*>(message->payload),
                                                           static_cast<std::size_t>(message->payloadlen)});
  });
  return {};
}

void Broker::State::subscribe() {
  std::vector<char*> topics;
  for (std::string& topic : config.subscriptions) topics.push_back(topic.data());
  const int told = mosquitto_subscribe_multiple(client, nullptr, static_cast<int>(topics.size()),
                                                topics.data(), k_at_least_once, 0, nullptr);
  if (told != MOSQ_ERR_SUCCESS) mosquitto_disconnect_v5(client, 0, nullptr);
}

Result<void> Broker::State::connect() {
  const Clock::time_point now = Clock::now();
  if (begun && now - tried < k_between_tries) {
    std::this_thread::sleep_for(
        std::min<Clock::duration>(k_between_tries - (now - tried), std::chrono::milliseconds{100}));
    return {};
  }
  tried = now;
  refused = 0;
  const int told = begun ? mosquitto_reconnect(client)
                         : mosquitto_connect_bind_v5(client, config.host.c_str(), config.port, k_keepalive_s,
                                                     nullptr, nullptr);
  begun = true;
  lost = told != MOSQ_ERR_SUCCESS;
  if (!lost) return {};
  return fail(Errc::ConnectFailed, "broker %.100s port %u: %s", config.host.c_str(), unsigned{config.port},
              mosquitto_strerror(told));
}

Broker::Broker(std::unique_ptr<State> state) : state_{std::move(state)} {}
Broker::~Broker() = default;

Result<std::unique_ptr<Broker>> Broker::open(const BrokerConfig& config, OnMessage on_message,
                                             OnReady on_ready) {
  const wire::Endpoint endpoint{.host = config.host, .port = config.port};
  if (!endpoint.loopback() && !config.tls)
    return fail(Errc::AuthenticationFailed,
                "broker %.100s is beyond loopback: it needs mqtts:// with --ca, "
                "--certificate and --key",
                config.host.c_str());
  auto state = std::make_unique<State>();
  state->config = config;
  state->on_message = std::move(on_message);
  state->on_ready = std::move(on_ready);
  BITELINE_TRY(state->open());
  return std::unique_ptr<Broker>{new Broker{std::move(state)}};
}

Result<void> Broker::turn(std::chrono::milliseconds timeout) {
  State& state = *state_;
  if (state.lost) {
    BITELINE_TRY(state.connect());
    if (state.lost) return {};
  }
  const int told = mosquitto_loop(state.client, static_cast<int>(timeout.count()), 1);
  if (state.refused != 0) {
    state.lost = true;
    return fail(Errc::PeerRefused, "broker %.100s: %s", state.config.host.c_str(),
                mosquitto_reason_string(state.refused));
  }
  if (told == MOSQ_ERR_SUCCESS) return {};
  state.lost = true;
  state.subscribed = false;
  return fail(Errc::ConnectionLost, "broker %.100s port %u: %s", state.config.host.c_str(),
              unsigned{state.config.port}, mosquitto_strerror(told));
}

bool Broker::ready() const {
  return !state_->lost && state_->subscribed;
}

bool Broker::publish(const std::string& topic, const std::string& payload, Delivery delivery) {
  if (!ready()) return false;
  const int qos = delivery == Delivery::AtMostOnce ? 0 : k_at_least_once;
  return mosquitto_publish_v5(state_->client, nullptr, topic.c_str(), static_cast<int>(payload.size()),
                              payload.data(), qos, delivery == Delivery::Kept, nullptr) == MOSQ_ERR_SUCCESS;
}

Result<BrokerConfig> parse_broker(const std::string& text) {
  BrokerConfig config;
  constexpr std::string_view k_tls = "mqtts://";
  constexpr std::string_view k_plain = "mqtt://";
  const bool tls = text.starts_with(k_tls);
  if (!tls && !text.starts_with(k_plain))
    return fail(Errc::InvalidArgument, "'%.100s': mqtts://HOST:PORT expected", text.c_str());
  BITELINE_ASSIGN(const wire::Endpoint endpoint,
                  wire::parse_endpoint("tcp://" + text.substr((tls ? k_tls : k_plain).size())));
  config.host = endpoint.host;
  config.port = endpoint.port;
  if (tls) config.tls.emplace();
  return config;
}

}  // namespace biteline::fleet

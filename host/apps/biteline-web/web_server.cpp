// SPDX-License-Identifier: MIT
#include "host/apps/biteline-web/web_server.hpp"

#include <openssl/ssl.h>

#include "host/apps/biteline-web/guards.hpp"
#include "host/apps/biteline-web/web_context.hpp"

namespace biteline::web {
namespace {

/// As an IPv6 address stands in an address of the web.
std::string bracketed(const std::string& text) {
  return std::string{"["}.append(text).append("]");
}

/// Every name under which a page may call a server that listens at `address`.
std::vector<std::string> names_of(const WebConfig& config, const net::ip::address& address) {
  std::vector<std::string> names;
  for (const std::string& name : config.names) names.push_back(host_name(name));
  const std::string text = address.to_string();
  names.push_back(address.is_v6() ? bracketed(text) : text);
  if (address.is_loopback() || address.is_unspecified()) {
    names.insert(names.end(), {"localhost", "127.0.0.1", "[::1]"});
  }
  return names;
}

Result<void> open_tls(const TlsFiles& files, std::optional<net::ssl::context>& tls) {
  tls.emplace(net::ssl::context::tls_server);
  SSL_CTX_set_min_proto_version(tls->native_handle(), TLS1_2_VERSION);
  SSL_CTX_set_options(tls->native_handle(), SSL_OP_NO_RENEGOTIATION | SSL_OP_CIPHER_SERVER_PREFERENCE);
  ErrorCode fault;
  tls->use_certificate_chain_file(files.certificate.string(), fault);
  if (fault) {
    return fail(Errc::FileUnreadable, "--certificate %s: a PEM certificate expected: %s",
                files.certificate.c_str(), fault.message().c_str());
  }
  tls->use_private_key_file(files.key.string(), net::ssl::context::pem, fault);
  if (fault) {
    return fail(Errc::FileUnreadable, "--key %s: the certificate's PEM key expected: %s", files.key.c_str(),
                fault.message().c_str());
  }
  return {};
}

}  // namespace

ServerCounts WebContext::counts() {
  return {.requests = requests,
          .refused = refused,
          .forwarded = forwarded,
          .host_away = host_away,
          .connections = places.count(),
          .watchers = feed.watchers(),
          .listeners = feed.listeners(),
          .pictures = feed.published(LiveKind::Picture),
          .profiles = feed.published(LiveKind::Profile)};
}

struct WebServer::State {
  WebContext context;
  ServiceDoor::OnEvent on_event;
  std::uint16_t port{0};
  // The loop goes before what its coroutines use.
  net::io_context loop{1};
  Tcp::acceptor acceptor{loop};

  Result<void> open(const WebConfig& config, std::unique_ptr<ServiceDoor> door);
  net::awaitable<void> accept_all();
  void hear(const control::Event& event);
};

Result<void> WebServer::State::open(const WebConfig& config, std::unique_ptr<ServiceDoor> door) {
  context.config = config;
  const WebLimits& limits = config.limits;
  context.places = Places{limits.connections, limits.connections_an_address, limits.kept_for_local};
  context.door = std::move(door);
  ErrorCode fault;
  const net::ip::address address = net::ip::make_address(config.address, fault);
  if (fault) {
    return fail(Errc::InvalidArgument, "--listen %s: the number of an interface expected, e.g. 127.0.0.1",
                config.address.c_str());
  }
  if (!address.is_loopback() && !config.tls) {
    return fail(Errc::AuthenticationFailed,
                "--listen %s is beyond loopback: it needs --certificate and --key there",
                config.address.c_str());
  }
  if (config.tls) BITELINE_TRY(open_tls(*config.tls, context.tls));
  context.host_names = names_of(config, address);
  acceptor.open(address.is_v6() ? Tcp::v6() : Tcp::v4(), fault);
  if (!fault) acceptor.set_option(Tcp::acceptor::reuse_address{true}, fault);
  if (!fault) acceptor.bind({address, config.port}, fault);
  if (!fault) acceptor.listen(128, fault);
  if (fault) {
    return fail_errno(Errc::PeerRefused, fault.value(),
                      "%s port %u: cannot listen there: choose another with --listen", config.address.c_str(),
                      unsigned{config.port});
  }
  port = acceptor.local_endpoint().port();
  context.door->listen(
      [this](const control::Event& event) { net::post(loop, [this, event] { hear(event); }); });
  net::co_spawn(loop, accept_all(), net::detached);
  return {};
}

/// On the loop.
void WebServer::State::hear(const control::Event& event) {
  if (on_event) on_event(event);
  if (event.name == "hello") {
    const auto results = event.data.find("results");
    if (results != event.data.end() && results->is_string()) context.results = results->get<std::string>();
    const auto accounts = event.data.find("accounts");
    if (accounts != event.data.end() && accounts->is_string())
      context.accounts = accounts->get<std::string>();
    return;
  }
  context.feed.publish_event(control::to_text(event));
}

net::awaitable<void> WebServer::State::accept_all() {
  for (;;) {
    ErrorCode fault;
    Tcp::socket socket{loop};
    co_await acceptor.async_accept(socket, net::redirect_error(net::use_awaitable, fault));
    if (fault == net::error::operation_aborted) co_return;
    if (fault) {
      // No descriptors left, or the client went at once: others go on; not in a busy loop.
      net::steady_timer pause{loop, std::chrono::milliseconds{50}};
      co_await pause.async_wait(net::redirect_error(net::use_awaitable, fault));
      continue;
    }
    net::co_spawn(loop, serve_connection(context, std::move(socket)), net::detached);
  }
}

WebServer::WebServer(std::unique_ptr<State> state) : state_{std::move(state)} {}

Result<std::unique_ptr<WebServer>> WebServer::open(const WebConfig& config, std::unique_ptr<ServiceDoor> door,
                                                   ServiceDoor::OnEvent on_event) {
  auto state = std::make_unique<State>();
  state->on_event = std::move(on_event);
  BITELINE_TRY(state->open(config, std::move(door)));
  return std::unique_ptr<WebServer>{new WebServer{std::move(state)}};
}

WebServer::~WebServer() {
  // First the door: its last answers still find the loop.
  state_->context.door.reset();
}

std::string WebServer::address() const {
  const WebConfig& config = state_->context.config;
  const bool six = config.address.find(':') != std::string::npos;
  return std::string{config.tls ? "https://" : "http://"} +
         (six ? bracketed(config.address) : config.address) + ":" + std::to_string(state_->port);
}

std::uint16_t WebServer::port() const {
  return state_->port;
}

void WebServer::run() {
  state_->loop.run();
}

void WebServer::stop() {
  state_->loop.stop();
}

int WebServer::watchers() const {
  return state_->context.watchers;
}

void WebServer::publish(LiveKind kind, LiveBytes bytes) {
  net::post(state_->loop,
            [this, kind, bytes = std::move(bytes)] { state_->context.feed.publish(kind, bytes); });
}

void WebServer::forget_scan() {
  net::post(state_->loop, [this] { state_->context.feed.forget_scan(); });
}

}  // namespace biteline::web

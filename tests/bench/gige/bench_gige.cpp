// SPDX-License-Identifier: MIT
// bench_gige [FRAMES]: the GigE Vision face to Aravis' client on loopback, as fast as the client takes
// frames: 10 000 of 1626 columns, each compared with its profile; then again with one packet in a hundred
// lost.
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <deque>
#include <random>

#include "host/interfaces/gige/server.hpp"
#include "tests/gige/aravis_client.hpp"
#include "tests/support/made_profile.hpp"

namespace {

using namespace biteline;
using Clock = std::chrono::steady_clock;

constexpr std::size_t k_columns = 1626, k_points = 780;
constexpr int k_buffers = 16, k_on_the_way = 8;
constexpr std::size_t k_different = 50;  ///< profiles, one after the other and again

void row(const char* what, double ours, const char* unit, const char* target) {
  std::printf("{\"bench\":\"devices.gige\",\"what\":\"%s\",\"ours\":%.6g,\"unit\":\"%s\",\"target\":%s}\n",
              what, ours, unit, target);
}

struct Counted {
  int right{0}, wrong{0};
};

/// Frames as they come, against the lines they are of.
void take(test::AravisClient& client, std::deque<std::size_t>& expected,
          const std::vector<std::vector<std::uint8_t>>& lines, std::size_t most_left, Counted& counted) {
  while (expected.size() > most_left) {
    const auto frame = client.next_frame(std::chrono::seconds{20});
    const std::vector<std::uint8_t>& line = lines[expected.front()];
    expected.pop_front();
    const bool same = frame && frame->complete && frame->payload.size() == line.size() &&
                      std::memcmp(frame->payload.data(), line.data(), line.size()) == 0;
    ++(same ? counted.right : counted.wrong);
  }
}

Result<void> run(int frames, bool noisy) {
  std::mt19937 random{7};
  bool losing = noisy;
  BITELINE_ASSIGN(const std::vector<gige::Interface> all, gige::interfaces());
  BITELINE_ASSIGN(const gige::Interface loopback, gige::choose_interface(all, "127.0.0.1"));
  gige::ServerConfig config;
  config.interface = loopback;
  config.lose = [&] { return losing && random() % 100 == 0; };
  BITELINE_ASSIGN(const auto server, gige::Server::open(config));
  server->set_head(k_columns, {});
  BITELINE_ASSIGN(const auto client, test::AravisClient::open("127.0.0.1"));
  BITELINE_TRY(client->start(k_buffers));

  std::vector<profile::Profile> profiles;
  std::vector<std::vector<std::uint8_t>> lines;
  for (std::size_t i = 0; i < k_different; ++i) {
    profiles.push_back(test::made_profile(i, k_points));
    lines.push_back(gige::line_of(gige::Format::Abc32f, k_columns, {}, profiles.back()));
  }
  std::deque<std::size_t> expected;
  Counted counted;
  const Clock::time_point begin = Clock::now();
  for (int i = 0; i < frames; ++i) {
    // The last ones' ends have nothing behind them that would show their loss.
    if (i + 2 >= frames) losing = false;
    const std::size_t which = static_cast<std::size_t>(i) % k_different;
    server->offer(1, profiles[which]);
    expected.push_back(which);
    take(*client, expected, lines, k_on_the_way, counted);
  }
  take(*client, expected, lines, 0, counted);
  const double seconds = std::chrono::duration<double>(Clock::now() - begin).count();
  BITELINE_TRY(client->stop());
  const gige::ServerCounts counts = server->counts();
  const char* one_percent = noisy ? " (1 % of packets lost)" : "";
  const auto told = [&](const char* what) { return std::string{what} + one_percent; };
  row(told("frames that are their profiles").c_str(), counted.right, "", std::to_string(frames).c_str());
  row(told("frames missing or different").c_str(), counted.wrong, "", "0");
  row(told("packets lost").c_str(), static_cast<double>(counts.lost), "", "null");
  row(told("packets sent again").c_str(), static_cast<double>(counts.stream.resent), "", "null");
  row(told("frames a second").c_str(), frames / seconds, "1/s", "100");
  return {};
}

}  // namespace

int main(int argc, char** argv) {
  const int frames = argc > 1 ? std::atoi(argv[1]) : 10'000;
  if (frames < 3) {
    std::fprintf(stderr, "bench_gige: a number of frames above 2 expected\n");
    return 2;
  }
  for (const bool noisy : {false, true}) {
    if (const Result<void> done = run(frames, noisy); !done) {
      std::fprintf(stderr, "bench_gige: %s\n", to_line(done.error()).c_str());
      return static_cast<int>(error_row(done.error().code).exit_status);
    }
  }
  return 0;
}

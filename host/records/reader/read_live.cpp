// SPDX-License-Identifier: MIT
// read_live tcp://HOST:PORT [--start]: an example of biteline_scan.hpp: one scan of a sensor, a line for each
// profile.
//     c++ -std=c++17 -O2 read_live.cpp -o read_live -lzmq
// Loopback without keys.  Beyond it set ZMQ_CURVE_SERVERKEY, ZMQ_CURVE_PUBLICKEY and ZMQ_CURVE_SECRETKEY
// before the connection; `biteline keys make` makes them.
#include <zmq.h>

#include <cstdio>
#include <cstring>

#include "biteline_scan.hpp"

namespace {

void say(void* socket, const biteline_scan::Bytes& message) {
  zmq_send(socket, message.data(), message.size(), 0);
}

/// Until the scan ends; its errc, or -1 when the sensor falls silent.
int read_scan(void* socket, bool start) {
  biteline_scan::Decoder decoder;
  biteline_scan::Bytes buffer(512 * 1024);
  std::uint64_t scan_id = 0, expected = 0;
  bool known = false;
  say(socket, biteline_scan::host_hello());
  while (true) {
    const int size = zmq_recv(socket, buffer.data(), buffer.size(), 0);
    if (size < 0 || static_cast<std::size_t>(size) > buffer.size()) return -1;
    const auto message = decoder.read(buffer.data(), static_cast<std::size_t>(size));
    if (!message) continue;  // damaged: without an Ack the sensor sends it again
    if (message->kind == biteline_scan::Kind::SensorHello && (!known || message->scan_id != scan_id)) {
      if (!known && start) say(socket, biteline_scan::start_scan());
      known = true;
      scan_id = message->scan_id;
      expected = 0;
    }
    const bool counted =
        message->kind == biteline_scan::Kind::Profile || message->kind == biteline_scan::Kind::EndOfScan;
    if (counted && message->scan_id == scan_id && message->sequence == expected) {
      ++expected;
      if (message->profile)
        std::printf("profile %llu: %zu points, %zu of them surface\n",
                    static_cast<unsigned long long>(message->profile->sequence), message->profile->x.size(),
                    biteline_scan::places_base(*message->profile).size());
    }
    say(socket, biteline_scan::ack(scan_id, expected));
    if (message->kind == biteline_scan::Kind::EndOfScan && message->scan_id == scan_id &&
        expected == message->sequence + 1)
      return message->errc;
  }
}

}  // namespace

int main(int argc, char** argv) {
  const bool start = argc == 3 && std::strcmp(argv[2], "--start") == 0;
  if (argc != 2 && !start) {
    std::fprintf(stderr, "read_live tcp://HOST:PORT [--start]\n");
    return 2;
  }
  void* context = zmq_ctx_new();
  void* socket = zmq_socket(context, ZMQ_DEALER);
  constexpr int k_silence_ms = 10'000;
  zmq_setsockopt(socket, ZMQ_RCVTIMEO, &k_silence_ms, sizeof k_silence_ms);
  // A sensor that is not there takes no last word: without this the end waits for ever.
  constexpr int k_last_words_ms = 1000;
  zmq_setsockopt(socket, ZMQ_LINGER, &k_last_words_ms, sizeof k_last_words_ms);
  int errc = -1;
  if (zmq_connect(socket, argv[1]) == 0) errc = read_scan(socket, start);
  zmq_close(socket);
  zmq_ctx_term(context);
  std::printf("end %d\n", errc);
  return errc == 0 ? 0 : 4;
}

// SPDX-License-Identifier: MIT
#pragma once
/// \file The firmware's threads: the one place that says how each of them runs.

#include <array>

#include "common/time/clocks.hpp"

namespace biteline::runtime {

struct ThreadSpec {
  const char* name;    ///< at most 15 characters, as the kernel shows it
  int priority;        ///< 1 .. 99 of SCHED_FIFO
  int cpu;             ///< pinned there; -1: anywhere
  Nanoseconds period;  ///< 0: driven by what arrives
  Nanoseconds budget;  ///< of one turn; more is a counted overrun
};

namespace threads {

using std::chrono::microseconds;
using std::chrono::milliseconds;

/// The laser goes off within 100 ms of a fault (laser_guard.hpp): ten looks in that time leave room for a
/// missed one. Above everything else, because nothing else may keep it from looking.
inline constexpr ThreadSpec k_safety{"bl-safety", 70, 0, milliseconds{10}, milliseconds{1}};
/// Poses are short and must not age behind a frame.
inline constexpr ThreadSpec k_pose{"bl-pose", 60, 0, milliseconds{0}, microseconds{200}};
/// Packets of a network camera, taken out of the socket: what waits there too long is lost.  Made by Aravis.
inline constexpr ThreadSpec k_receive{"bl-receive", 55, -1, milliseconds{0}, milliseconds{1}};
/// One frame's way, ARCHITECTURE "Time budget of one frame": 10 ms between frames at 100 Hz, half of it at
/// most.
inline constexpr ThreadSpec k_acquisition{"bl-acq", 50, 1, milliseconds{0}, milliseconds{5}};
/// Encodes and sends, below all that measures; and hears the hosts: one that asks for darkness gets it within
/// 100 ms, whatever programs run beside.
inline constexpr ThreadSpec k_stream{"bl-stream", 40, -1, milliseconds{0}, milliseconds{5}};
/// Between the stream thread and the network's sockets, or what that one promises ends here.  Made by ZeroMQ.
inline constexpr ThreadSpec k_network{"ZMQbg/IO/0", 40, -1, milliseconds{0}, milliseconds{5}};
/// Waits for signals.  Above ordinary threads only so that a killed process ends at once (realtime.cpp).
inline constexpr ThreadSpec k_main{"biteline-sensor", 10, -1, milliseconds{20}, milliseconds{1}};

/// Scales and packs live pictures for observers: below all that measures or watches, and never more than a
/// quarter of its time.  Not an ordinary thread, or a killed process would wait for it on a busy machine
/// (k_main).
inline constexpr ThreadSpec k_picture{"bl-picture", 5, -1, milliseconds{0}, milliseconds{20}};

/// Writes a recording.  Not an ordinary thread for the same reason.
inline constexpr ThreadSpec k_record{"bl-record", 4, -1, milliseconds{0}, milliseconds{1000}};

}  // namespace threads

inline constexpr std::array<ThreadSpec, 9> k_thread_table{
    threads::k_safety,  threads::k_pose, threads::k_receive, threads::k_acquisition, threads::k_stream,
    threads::k_network, threads::k_main, threads::k_picture, threads::k_record};

}  // namespace biteline::runtime

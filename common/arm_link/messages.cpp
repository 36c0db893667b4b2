// SPDX-License-Identifier: MIT
#include "common/arm_link/messages.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

namespace biteline::arm_link {
namespace {

constexpr std::uint32_t k_mark = 0x4B4E4C41;  // "ALNK"
constexpr std::size_t k_name_bytes = 24;
constexpr std::size_t k_sum_at = k_message_bytes - k_sum_bytes;

/// Kinds in the order of Body: the host's from 1 on, the controller's from 65.
constexpr std::array<std::uint8_t, std::variant_size_v<Body>> k_kinds{1, 2, 3, 4, 5, 6, 7, 65, 66, 67, 68};

class Writer {
 public:
  explicit Writer(Message& out) : out_{out} {}
  template <class Whole>
  void whole(Whole value) {
    for (std::size_t i = 0; i < sizeof(Whole); ++i)
      out_[at_++] = static_cast<std::uint8_t>(static_cast<std::uint64_t>(value) >> (8 * i));
  }
  void number(double value) { whole(std::bit_cast<std::uint32_t>(static_cast<float>(value))); }
  void vector(const Vec3& value) {
    for (const double part : value) number(part);
  }
  void motion(const SE3& T) {
    vector(T.translation());
    const Eigen::Quaterniond q{T.linear()};
    for (const double part : {q.w(), q.x(), q.y(), q.z()}) number(part);
  }
  void joints(const Joints& q_rad) {
    for (const double part : q_rad) number(part);
  }
  void name(const std::string& text) {
    for (std::size_t i = 0; i < k_name_bytes; ++i)
      out_[at_++] = i < text.size() ? static_cast<std::uint8_t>(text[i]) : std::uint8_t{0};
  }

 private:
  Message& out_;
  std::size_t at_{0};
};

class Fields {
 public:
  explicit Fields(const Message& in) : in_{in} {}
  template <class Whole>
  Whole whole() {
    std::uint64_t value = 0;
    for (std::size_t i = 0; i < sizeof(Whole); ++i)
      value |= static_cast<std::uint64_t>(in_[at_++]) << (8 * i);
    return static_cast<Whole>(value);
  }
  /// `most`: its size at most.
  double number(double most) {
    const double value = std::bit_cast<float>(whole<std::uint32_t>());
    const bool sane = std::isfinite(value) && std::abs(value) <= most;
    good_ = good_ && sane;
    return sane ? value : 0;
  }
  /// Not below 0.
  double size(double most) {
    const double value = number(most);
    good_ = good_ && value >= 0;
    return value;
  }
  Vec3 place_mm() {
    constexpr double k_most_mm = 100'000;
    const double x = number(k_most_mm), y = number(k_most_mm), z = number(k_most_mm);
    return {x, y, z};
  }
  SE3 motion() {
    constexpr double k_length_tolerance = 1e-3;
    const Vec3 at_mm = place_mm();
    const double w = number(1.01), x = number(1.01), y = number(1.01), z = number(1.01);
    const Eigen::Quaterniond q{w, x, y, z};
    if (std::abs(q.norm() - 1) > k_length_tolerance) {
      good_ = false;
      return SE3::Identity();
    }
    return geometry::make_se3(q.normalized(), at_mm);
  }
  Joints joints() {
    Joints q_rad;
    for (double& part : q_rad) part = number(100);
    return q_rad;
  }
  std::string name() {
    std::string text;
    for (std::size_t i = 0; i < k_name_bytes; ++i) {
      const auto letter = static_cast<char>(in_[at_++]);
      if (letter >= ' ' && letter <= '~') text += letter;
    }
    return text;
  }
  /// A number of a row of words.
  template <class Word>
  Word word(Word last) {
    using Whole = std::underlying_type_t<Word>;
    const auto value = whole<Whole>();
    good_ = good_ && value <= static_cast<Whole>(last);
    return static_cast<Word>(value);
  }
  [[nodiscard]] bool good() const { return good_; }

 private:
  const Message& in_;
  std::size_t at_{0};
  bool good_{true};
};

constexpr double k_most_speed = 10'000, k_most_acceleration = 1e6, k_most_blend_mm = 1000, k_most_kg = 10'000;

void write(Writer&, const Hello&) {}
void write(Writer&, const Stop&) {}
void write(Writer&, const Beat&) {}
void write(Writer& out, const PathBegin& body) {
  out.whole(body.path);
  out.whole(body.points);
  out.motion(body.T_flange_tcp);
  out.number(body.mass_kg);
  out.vector(body.centre_flange_mm);
  out.whole(body.output);
}
void write(Writer& out, const PathPoint& body) {
  out.whole(body.path);
  out.whole(body.index);
  out.whole(static_cast<std::uint8_t>(body.move));
  out.whole(static_cast<std::uint8_t>(body.tool_on));
  out.whole(std::uint16_t{0});
  out.motion(body.T_base_tcp);
  out.joints(body.q_rad);
  out.number(body.speed);
  out.number(body.acceleration);
  out.number(body.blend_mm);
}
void write(Writer& out, const PathEnd& body) {
  out.whole(body.path);
}
void write(Writer& out, const Go& body) {
  out.whole(body.path);
  out.whole(body.sum);
}
void write(Writer& out, const Robot& body) {
  out.name(body.make);
  out.name(body.model);
  out.name(body.serial);
  out.whole(body.joints);
}
void write(Writer& out, const State& body) {
  out.whole(body.stamp_us);
  out.motion(body.T_base_tcp);
  out.motion(body.T_flange_tcp);
  out.joints(body.q_rad);
  out.whole(static_cast<std::uint8_t>(body.phase));
  out.whole(static_cast<std::uint8_t>(body.powered));
  out.whole(static_cast<std::uint8_t>(body.safe));
  out.whole(body.outputs);
  out.whole(body.path);
  out.whole(body.index);
  out.whole(static_cast<std::uint16_t>(body.fault));
  out.number(body.speed_ratio);
}
void write(Writer& out, const PathSum& body) {
  out.whole(body.path);
  out.whole(body.points);
  out.whole(body.sum);
}
void write(Writer& out, const Refusal& body) {
  out.whole(body.of);
  out.whole(std::uint8_t{0});
  out.whole(static_cast<std::uint16_t>(body.reason));
}

void read(Fields&, Hello&) {}
void read(Fields&, Stop&) {}
void read(Fields&, Beat&) {}
void read(Fields& in, PathBegin& body) {
  body.path = in.whole<std::uint32_t>();
  body.points = in.whole<std::uint32_t>();
  body.T_flange_tcp = in.motion();
  body.mass_kg = in.size(k_most_kg);
  body.centre_flange_mm = in.place_mm();
  body.output = in.whole<std::int32_t>();
}
void read(Fields& in, PathPoint& body) {
  body.path = in.whole<std::uint32_t>();
  body.index = in.whole<std::uint32_t>();
  body.move = in.word(PathPoint::Move::Line);
  body.tool_on = in.whole<std::uint8_t>() != 0;
  static_cast<void>(in.whole<std::uint16_t>());
  body.T_base_tcp = in.motion();
  body.q_rad = in.joints();
  body.speed = in.size(k_most_speed);
  body.acceleration = in.size(k_most_acceleration);
  body.blend_mm = in.size(k_most_blend_mm);
}
void read(Fields& in, PathEnd& body) {
  body.path = in.whole<std::uint32_t>();
}
void read(Fields& in, Go& body) {
  body.path = in.whole<std::uint32_t>();
  body.sum = in.whole<std::uint32_t>();
}
void read(Fields& in, Robot& body) {
  body.make = in.name();
  body.model = in.name();
  body.serial = in.name();
  body.joints = in.whole<std::uint32_t>();
}
void read(Fields& in, State& body) {
  body.stamp_us = in.whole<std::uint64_t>();
  body.T_base_tcp = in.motion();
  body.T_flange_tcp = in.motion();
  body.q_rad = in.joints();
  body.phase = in.word(Phase::Stopped);
  body.powered = in.whole<std::uint8_t>() != 0;
  body.safe = in.whole<std::uint8_t>() != 0;
  body.outputs = in.whole<std::uint8_t>();
  body.path = in.whole<std::uint32_t>();
  body.index = in.whole<std::uint16_t>();
  body.fault = in.word(Fault::Motion);
  body.speed_ratio = in.size(k_most_speed);
}
void read(Fields& in, PathSum& body) {
  body.path = in.whole<std::uint32_t>();
  body.points = in.whole<std::uint32_t>();
  body.sum = in.whole<std::uint32_t>();
}
void read(Fields& in, Refusal& body) {
  body.of = in.whole<std::uint8_t>();
  static_cast<void>(in.whole<std::uint8_t>());
  body.reason = in.word(Reason::Unreachable);
}

/// The body of that place in the row, without its contents.
template <std::size_t... Places>
Body empty_body(std::size_t place, std::index_sequence<Places...>) {
  Body body;
  static_cast<void>(((place == Places && (body.emplace<Places>(), true)) || ...));
  return body;
}

std::uint32_t sum_of(std::span<const std::uint8_t> bytes) {
  Sum sum;
  sum.add(bytes);
  return sum.value();
}

/// The rest of a message behind its header, as its own beginning.
Message without_header(const Message& message) {
  Message body{};
  std::copy(message.begin() + k_header_bytes, message.begin() + k_sum_at, body.begin());
  return body;
}

}  // namespace

void Sum::add(std::span<const std::uint8_t> bytes) {
  constexpr std::uint32_t k_prime = 65521;
  for (const std::uint8_t byte : bytes) {
    low_ = (low_ + byte) % k_prime;
    high_ = (high_ + low_) % k_prime;
  }
}

std::uint8_t kind_of(const Body& body) {
  return k_kinds[body.index()];
}

std::span<const std::uint8_t> body_bytes(const Message& message) {
  return std::span{message}.subspan(k_header_bytes, k_sum_at - k_header_bytes);
}

Message encode(std::uint32_t number, const Body& body) {
  Message inside{}, out{};
  Writer contents{inside};
  std::visit([&](const auto& which) { write(contents, which); }, body);
  Writer header{out};
  header.whole(k_mark);
  header.whole(k_version);
  header.whole(kind_of(body));
  header.whole(std::uint16_t{0});
  header.whole(number);
  std::copy_n(inside.begin(), k_sum_at - k_header_bytes, out.begin() + k_header_bytes);
  const std::uint32_t sum = sum_of(std::span{out}.first(k_sum_at));
  for (std::size_t i = 0; i < k_sum_bytes; ++i) out[k_sum_at + i] = static_cast<std::uint8_t>(sum >> (8 * i));
  return out;
}

Result<Received> decode(const Message& message) {
  Fields header{message};
  if (header.whole<std::uint32_t>() != k_mark) return fail(Errc::ProtocolError, "arm link: no message of it");
  const auto version = header.whole<std::uint8_t>();
  if (version != k_version)
    return fail(Errc::ProtocolError, "arm link: version %d, %d expected", int{version}, int{k_version});
  const auto kind = header.whole<std::uint8_t>();
  static_cast<void>(header.whole<std::uint16_t>());
  Received received{.number = header.whole<std::uint32_t>(), .body = {}};
  std::uint32_t told = 0;
  for (std::size_t i = 0; i < k_sum_bytes; ++i)
    told |= static_cast<std::uint32_t>(message[k_sum_at + i]) << (8 * i);
  if (told != sum_of(std::span{message}.first(k_sum_at)))
    return fail(Errc::ProtocolError, "arm link: a message's sum does not fit");
  const auto known = std::ranges::find(k_kinds, kind);
  if (known == k_kinds.end()) return fail(Errc::ProtocolError, "arm link: kind %d is not known", int{kind});
  received.body = empty_body(static_cast<std::size_t>(known - k_kinds.begin()),
                             std::make_index_sequence<std::variant_size_v<Body>>{});
  const Message inside = without_header(message);
  Fields contents{inside};
  std::visit([&](auto& which) { read(contents, which); }, received.body);
  if (!contents.good()) return fail(Errc::BadValue, "arm link: kind %d without sound numbers", int{kind});
  return received;
}

Result<std::optional<Received>> Reader::next() {
  if (waiting_.size() < k_message_bytes) return std::optional<Received>{};
  std::copy_n(waiting_.begin(), k_message_bytes, last_.begin());
  waiting_.erase(waiting_.begin(), waiting_.begin() + k_message_bytes);
  BITELINE_ASSIGN(Received received, decode(last_));
  if (number_ && received.number != *number_ + 1)
    return fail(Errc::ProtocolError, "arm link: message %u after %u", received.number, *number_);
  number_ = received.number;
  return std::optional{std::move(received)};
}

const char* name_of(Fault fault) {
  switch (fault) {
    case Fault::None:
      return "none";
    case Fault::Host:
      return "the host said stop";
    case Fault::DeadMan:
      return "the host's beats ended";
    case Fault::PeerGone:
      return "the host's connection ended";
    case Fault::Safety:
      return "a safety stop, or power off";
    case Fault::Motion:
      return "the controller could not do a move";
  }
  return "not known";
}

const char* name_of(Reason reason) {
  switch (reason) {
    case Reason::None:
      return "none";
    case Reason::Busy:
      return "a path runs, or another host is connected";
    case Reason::Order:
      return "the message has no place now";
    case Reason::Points:
      return "a point is missing, told twice, or too many";
    case Reason::WrongPath:
      return "another path's name or sum";
    case Reason::Stale:
      return "the path is too old";
    case Reason::NotReady:
      return "no power, or a safety stop";
    case Reason::Unreachable:
      return "a move cannot be done";
  }
  return "not known";
}

}  // namespace biteline::arm_link

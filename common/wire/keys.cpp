// SPDX-License-Identifier: MIT
#include "common/wire/keys.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zmq.h>

#include <array>
#include <cerrno>
#include <sstream>

#include "common/system/file.hpp"

namespace biteline::wire {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t k_key_characters = 40;
constexpr std::uint64_t k_most_key_bytes = 1U << 20U;  // some ten thousand hosts
constexpr std::string_view k_z85_letters =
    "0123456789abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ.-:+=^!/*?&<>()[]{}@%$#";  // ZeroMQ RFC 32

bool is_key(const std::string& text) {
  return text.size() == k_key_characters && text.find_first_not_of(k_z85_letters) == std::string::npos;
}

Result<KeyPair> make_pair() {
  std::array<char, k_key_characters + 1> public_key{};
  std::array<char, k_key_characters + 1> secret_key{};
  if (zmq_curve_keypair(public_key.data(), secret_key.data()) != 0) {
    return fail_errno(Errc::NotSupported, zmq_errno(), "libzmq without CURVE");
  }
  return KeyPair{.public_key = public_key.data(), .secret_key = secret_key.data()};
}

/// A new file only: O_EXCL, so that no key is lost and no link is followed.
Result<void> write_new(const fs::path& file, const std::string& line, mode_t mode) {
  const int fd = ::open(file.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, mode);
  if (fd < 0) {
    const int reason = errno;
    return fail_errno(reason == EEXIST ? Errc::WrongState : Errc::WriteFailed, reason, "%s", file.c_str());
  }
  const std::string text = line + "\n";
  const bool written = ::write(fd, text.data(), text.size()) == static_cast<ssize_t>(text.size());
  const int reason = errno;
  if (::close(fd) != 0 || !written) return fail_errno(Errc::WriteFailed, reason, "%s", file.c_str());
  return {};
}

Result<std::string> read_key(const fs::path& file) {
  BITELINE_ASSIGN(const std::string text, read_regular_file(file, k_most_key_bytes));
  const std::string line = text.substr(0, text.find('\n'));
  if (!is_key(line))
    return fail(Errc::BadFormat, "%s line 1: a key of 40 Z85 characters expected", file.c_str());
  return line;
}

Result<std::string> read_secret(const fs::path& file) {
  struct stat status {};
  if (::stat(file.c_str(), &status) != 0) return fail_errno(Errc::FileNotFound, errno, "%s", file.c_str());
  if ((status.st_mode & (S_IRWXG | S_IRWXO)) != 0) {
    return fail(Errc::AuthenticationFailed, "%s: a secret that others may use; chmod 600 it", file.c_str());
  }
  return read_key(file);
}

Result<KeyPair> read_pair(const fs::path& folder, const std::string& name) {
  KeyPair pair;
  BITELINE_ASSIGN(pair.public_key, read_key(folder / (name + ".public")));
  BITELINE_ASSIGN(pair.secret_key, read_secret(folder / (name + ".secret")));
  return pair;
}

/// One key per line; what follows a blank is its owner's name; # begins a comment.
Result<std::vector<std::string>> read_allow_list(const fs::path& file) {
  BITELINE_ASSIGN(std::string text, read_regular_file(file, k_most_key_bytes));
  std::istringstream stream{std::move(text)};
  std::vector<std::string> keys;
  std::string line;
  for (int row = 1; std::getline(stream, line); ++row) {
    // '#' is itself a Z85 letter: only in front of a line, or instead of a key, is it a comment.
    const std::string key = line.substr(0, line.find_first_of(" \t\r"));
    if (key.empty() || (line.front() == '#' && !is_key(key))) continue;
    if (!is_key(key))
      return fail(Errc::BadFormat, "%s line %d: a key of 40 Z85 characters expected", file.c_str(), row);
    keys.push_back(key);
  }
  return keys;
}

}  // namespace

Result<void> make_keys(const fs::path& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) return fail_errno(Errc::WriteFailed, error.value(), "%s", folder.c_str());
  // All or nothing: half a set beside an older half would never fit.
  for (const char* name : {"sensor.public", "sensor.secret", "host.public", "host.secret", "hosts.allowed"}) {
    if (fs::exists(folder / name, error)) {
      return fail(Errc::WrongState, "%s exists; keys are never overwritten", (folder / name).c_str());
    }
  }
  BITELINE_ASSIGN(const KeyPair sensor, make_pair());
  BITELINE_ASSIGN(const KeyPair host, make_pair());
  BITELINE_TRY(write_new(folder / "sensor.public", sensor.public_key, 0644));
  BITELINE_TRY(write_new(folder / "sensor.secret", sensor.secret_key, 0600));
  BITELINE_TRY(write_new(folder / "host.public", host.public_key, 0644));
  BITELINE_TRY(write_new(folder / "host.secret", host.secret_key, 0600));
  return write_new(folder / "hosts.allowed", host.public_key + " host", 0644);
}

Result<SensorKeys> read_sensor_keys(const fs::path& folder) {
  SensorKeys keys;
  BITELINE_ASSIGN(keys.own, read_pair(folder, "sensor"));
  BITELINE_ASSIGN(keys.allowed_hosts, read_allow_list(folder / "hosts.allowed"));
  return keys;
}

Result<HostKeys> read_host_keys(const fs::path& folder) {
  HostKeys keys;
  BITELINE_ASSIGN(keys.own, read_pair(folder, "host"));
  BITELINE_ASSIGN(keys.sensor_public_key, read_key(folder / "sensor.public"));
  return keys;
}

}  // namespace biteline::wire

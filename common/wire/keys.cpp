// SPDX-License-Identifier: MIT
#include "common/wire/keys.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zmq.h>

#include <array>
#include <cerrno>
#include <cstdio>
#include <sstream>

#include "common/core/text.hpp"
#include "common/system/file.hpp"

namespace biteline::wire {
namespace {

namespace fs = std::filesystem;

constexpr const char* k_allowed_file = "hosts.allowed";
constexpr std::size_t k_key_characters = 40;
constexpr std::uint64_t k_most_key_bytes = 1U << 20U;  // some ten thousand hosts
constexpr std::string_view k_z85_letters =
    "0123456789abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ.-:+=^!/*?&<>()[]{}@%$#";  // ZeroMQ RFC 32

bool is_key(const std::string& text) {
  if (text.size() != k_key_characters || text.find_first_not_of(k_z85_letters) != std::string::npos)
    return false;
  // Five letters may say more than four bytes hold: libzmq refuses such a key later, by number only.
  std::array<std::uint8_t, 32> raw{};
  return zmq_z85_decode(raw.data(), text.c_str()) != nullptr;
}

constexpr const char* k_key_expected = "a key of 40 Z85 characters (32 bytes) expected";

Result<KeyPair> make_pair() {
  std::array<char, k_key_characters + 1> public_key{};
  std::array<char, k_key_characters + 1> secret_key{};
  if (zmq_curve_keypair(public_key.data(), secret_key.data()) != 0) {
    return fail_errno(Errc::NotSupported, zmq_errno(), "libzmq without CURVE");
  }
  return KeyPair{.public_key = public_key.data(), .secret_key = secret_key.data()};
}

/// A new file only: O_EXCL, so that no key is lost and no link is followed.
Result<void> write_new(const fs::path& file, const std::string& text, mode_t mode) {
  const int fd = ::open(file.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, mode);
  if (fd < 0) {
    const int reason = errno;
    return fail_errno(reason == EEXIST ? Errc::WrongState : Errc::WriteFailed, reason, "%s", file.c_str());
  }
  const bool written = ::write(fd, text.data(), text.size()) == static_cast<ssize_t>(text.size());
  const int reason = errno;
  if (::close(fd) != 0 || !written) return fail_errno(Errc::WriteFailed, reason, "%s", file.c_str());
  return {};
}

Result<std::string> read_key(const fs::path& file) {
  BITELINE_ASSIGN(const std::string text, read_regular_file(file, k_most_key_bytes));
  const std::string line = text.substr(0, text.find_first_of("\n"));
  if (!is_key(line)) return fail(Errc::BadFormat, "%s line 1: %s", file.c_str(), k_key_expected);
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
  std::array<char, k_key_characters + 1> belongs{};
  if (zmq_curve_public(belongs.data(), pair.secret_key.c_str()) != 0 || pair.public_key != belongs.data()) {
    return fail(Errc::AuthenticationFailed,
                "%s: it does not belong to %s.public: copy both of one set, or make new ones",
                (folder / (name + ".secret")).c_str(), name.c_str());
  }
  return pair;
}

/// A line of hosts.allowed: a key, a blank, its owner's name; '#' begins a comment.
struct AllowedLine {
  std::string text;
  std::string key;  ///< empty: a comment or nothing
  std::string name;
};

Result<std::vector<AllowedLine>> read_allowed_lines(const fs::path& file) {
  BITELINE_ASSIGN(std::string text, read_regular_file(file, k_most_key_bytes));
  std::istringstream stream{std::move(text)};
  std::vector<AllowedLine> lines;
  std::string line;
  for (int row = 1; std::getline(stream, line); ++row) {
    // '#' is itself a Z85 letter: only in front of a line, or instead of a key, is it a comment.
    const std::size_t blank = line.find_first_of(" \t\r");
    const std::string key = line.substr(0, blank);
    if (key.empty() || (line.front() == '#' && !is_key(key))) {
      lines.push_back({.text = line, .key = {}, .name = {}});
      continue;
    }
    if (!is_key(key)) return fail(Errc::BadFormat, "%s line %d: %s", file.c_str(), row, k_key_expected);
    const std::size_t named = blank == std::string::npos ? blank : line.find_first_not_of(" \t\r", blank);
    lines.push_back({.text = line, .key = key, .name = named == std::string::npos ? "" : line.substr(named)});
  }
  return lines;
}

/// Beside and renamed: a sensor that reads at this moment sees the old list or the new one.
Result<void> write_allowed(const fs::path& file, const std::vector<AllowedLine>& lines) {
  const fs::path beside = file.string() + ".part";
  std::error_code ignored;
  fs::remove(beside, ignored);
  std::string text;
  for (const AllowedLine& line : lines) text += line.text + "\n";
  BITELINE_TRY(write_new(beside, text, 0600));
  if (std::rename(beside.c_str(), file.c_str()) != 0)
    return fail_errno(Errc::WriteFailed, errno, "%s", file.c_str());
  return {};
}

Result<void> make_folder(const fs::path& folder) {
  std::error_code error;
  const bool made = fs::create_directories(folder, error);
  if (error) return fail_errno(Errc::WriteFailed, error.value(), "%s", folder.c_str());
  // Names of keys and of hosts are nobody else's business; a folder that stood before is its owner's matter.
  if (made && ::chmod(folder.c_str(), 0700) != 0)
    return fail_errno(Errc::WriteFailed, errno, "%s", folder.c_str());
  return {};
}

Result<void> write_pair(const fs::path& folder, const std::string& name) {
  BITELINE_TRY(make_folder(folder));
  std::error_code ignored;
  // All or nothing: half a set beside an older half would never fit.
  for (const char* end : {".public", ".secret"}) {
    if (fs::exists(folder / (name + end), ignored))
      return fail(Errc::WrongState, "%s exists; keys are never overwritten", (folder / (name + end)).c_str());
  }
  BITELINE_ASSIGN(const KeyPair pair, make_pair());
  BITELINE_TRY(write_new(folder / (name + ".public"), pair.public_key + "\n", 0644));
  return write_new(folder / (name + ".secret"), pair.secret_key + "\n", 0600);
}

}  // namespace

Result<void> make_sensor_keys(const fs::path& folder) {
  BITELINE_TRY(write_pair(folder, "sensor"));
  std::error_code ignored;
  if (fs::exists(folder / k_allowed_file, ignored)) return {};
  return write_new(folder / k_allowed_file, "# One host a line: its host.public, a blank, its name.\n", 0600);
}

Result<void> make_host_keys(const fs::path& folder) {
  return write_pair(folder, "host");
}

Result<void> rotate_keys(const fs::path& folder, KeyOwner owner) {
  const std::string name = owner == KeyOwner::Sensor ? "sensor" : "host";
  BITELINE_TRY(read_pair(folder, name));  // there is something to rotate, and it is whole
  BITELINE_ASSIGN(const KeyPair pair, make_pair());
  std::error_code error;
  for (const char* end : {".public.new", ".secret.new"}) fs::remove(folder / (name + end), error);
  BITELINE_TRY(write_new(folder / (name + ".public.new"), pair.public_key + "\n", 0644));
  BITELINE_TRY(write_new(folder / (name + ".secret.new"), pair.secret_key + "\n", 0600));
  // The secret first: a halt between the two is told at the next start, and the new halves are still there.
  for (const char* end : {".secret", ".public"}) {
    const fs::path file = folder / (name + end);
    fs::rename(file.string() + ".new", file, error);
    if (error) return fail_errno(Errc::WriteFailed, error.value(), "%s", file.c_str());
  }
  return {};
}

Result<void> allow_host(const fs::path& folder, const std::string& name, const fs::path& public_key_file) {
  if (name.empty() || name != clean_text(name, 64))
    return fail(Errc::InvalidArgument, "'%s': a host's name of at most 64 letters expected", name.c_str());
  BITELINE_ASSIGN(const std::string key, read_key(public_key_file));
  BITELINE_ASSIGN(std::vector<AllowedLine> lines, read_allowed_lines(folder / k_allowed_file));
  // A host has one key: its new one takes the old one's place.
  std::erase_if(lines, [&](const AllowedLine& line) { return !line.key.empty() && line.name == name; });
  lines.push_back({.text = key + " " + name, .key = key, .name = name});
  return write_allowed(folder / k_allowed_file, lines);
}

Result<void> revoke_host(const fs::path& folder, const std::string& name_or_key) {
  BITELINE_ASSIGN(std::vector<AllowedLine> lines, read_allowed_lines(folder / k_allowed_file));
  const std::size_t gone = std::erase_if(lines, [&](const AllowedLine& line) {
    return !line.key.empty() && (line.name == name_or_key || line.key == name_or_key);
  });
  if (gone == 0) {
    return fail(Errc::InvalidArgument, "%s: no host '%s' in it", (folder / k_allowed_file).c_str(),
                name_or_key.c_str());
  }
  return write_allowed(folder / k_allowed_file, lines);
}

Result<std::vector<std::string>> read_allowed_hosts(const fs::path& folder) {
  BITELINE_ASSIGN(const std::vector<AllowedLine> lines, read_allowed_lines(folder / k_allowed_file));
  std::vector<std::string> keys;
  for (const AllowedLine& line : lines) {
    if (!line.key.empty()) keys.push_back(line.key);
  }
  return keys;
}

Result<SensorKeys> read_sensor_keys(const fs::path& folder) {
  SensorKeys keys{.own = {}, .allowed_hosts = {}, .folder = folder};
  BITELINE_ASSIGN(keys.own, read_pair(folder, "sensor"));
  BITELINE_ASSIGN(keys.allowed_hosts, read_allowed_hosts(folder));
  if (keys.allowed_hosts.empty()) {
    return fail(Errc::AuthenticationFailed,
                "%s: it names no host, so none could come in (biteline keys allow)",
                (folder / k_allowed_file).c_str());
  }
  return keys;
}

Result<HostKeys> read_host_keys(const fs::path& folder) {
  HostKeys keys;
  BITELINE_ASSIGN(keys.own, read_pair(folder, "host"));
  BITELINE_ASSIGN(keys.sensor_public_key, read_key(folder / "sensor.public"));
  return keys;
}

}  // namespace biteline::wire

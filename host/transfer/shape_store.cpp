// SPDX-License-Identifier: MIT
#include "host/transfer/shape_store.hpp"

#include <sys/stat.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <optional>
#include <type_traits>
#include <vector>

#include "common/core/fixed_text.hpp"
#include "common/core/numbers.hpp"
#include "common/system/file.hpp"
#include "common/wire/checksum.hpp"
#include "host/records/report/report.hpp"

namespace biteline::transfer {
namespace {

namespace fs = std::filesystem;

constexpr const char* k_folder = ".shapes";
constexpr std::uint32_t k_format = 1;  // of the note, and of how a rough shape is drawn
constexpr std::uint64_t k_most_note_bytes = 1U << 20U;
constexpr std::uint32_t k_most_places = 4096;

/// What changes when any file of the model does; empty when the folder cannot be looked at.
std::string stamps_of(const fs::path& folder) {
  std::vector<std::string> lines;
  std::error_code error;
  for (fs::directory_iterator at{folder, error}; !error && at != fs::directory_iterator{};
       at.increment(error)) {
    struct stat stat {};
    if (::stat(at->path().c_str(), &stat) != 0) return {};
    lines.push_back(at->path().filename().string() +
                    FixedText<120>::format(" %lld %lld.%09ld %llu\n", static_cast<long long>(stat.st_size),
                                           static_cast<long long>(stat.st_mtim.tv_sec),
                                           static_cast<long>(stat.st_mtim.tv_nsec),
                                           static_cast<unsigned long long>(stat.st_ino))
                        .c_str());
  }
  if (error) return {};
  std::sort(lines.begin(), lines.end());
  std::string all;
  for (const std::string& line : lines) all += line;
  return all;
}

std::uint32_t checksum_of(const std::string& bytes) {
  return wire::crc32c({reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()});
}

/// Values as this machine holds them: a note never leaves it.
class Writer {
 public:
  template <class T>
  void put(const T& value) {
    static_assert(std::is_trivially_copyable_v<T>);
    bytes_.append(reinterpret_cast<const char*>(&value), sizeof value);
  }
  void put(const std::string& text) {
    put(static_cast<std::uint32_t>(text.size()));
    bytes_ += text;
  }
  void put(const Surfels& surfels) {
    put(surfels.pitch_mm);
    put(static_cast<std::uint32_t>(surfels.size()));
    for (const auto* vectors : {&surfels.positions, &surfels.normals}) {
      for (const Eigen::Vector3f& v : *vectors) {
        for (const float value : {v.x(), v.y(), v.z()}) put(value);
      }
    }
  }
  [[nodiscard]] std::string&& take() { return std::move(bytes_); }

 private:
  std::string bytes_;
};

/// Reads what Writer wrote; once something is amiss, it stays so.
class Reader {
 public:
  explicit Reader(const std::string& bytes) : bytes_{bytes} {}

  template <class T>
  T get() {
    T value{};
    if (bytes_.size() - at_ < sizeof value) good_ = false;
    if (!good_) return value;
    std::memcpy(&value, bytes_.data() + at_, sizeof value);
    at_ += sizeof value;
    return value;
  }
  std::string text() {
    const auto size = get<std::uint32_t>();
    if (bytes_.size() - at_ < size) good_ = false;
    if (!good_) return {};
    at_ += size;
    return bytes_.substr(at_ - size, size);
  }
  Surfels surfels() {
    Surfels out{.pitch_mm = get<float>()};
    const auto count = get<std::uint32_t>();
    if (count > k_most_places || !(out.pitch_mm > 0)) good_ = false;
    for (auto* vectors : {&out.positions, &out.normals}) {
      for (std::uint32_t i = 0; good_ && i < count; ++i) {
        Eigen::Vector3f v;
        for (float& value : v) value = get<float>();
        if (!(v.cwiseAbs().maxCoeff() < k_far_mm)) good_ = false;
        vectors->push_back(v);
      }
    }
    return out;
  }
  [[nodiscard]] bool good() const { return good_; }
  [[nodiscard]] bool at_end() const { return good_ && at_ == bytes_.size(); }

 private:
  const std::string& bytes_;
  std::size_t at_{0};
  bool good_{true};
};

/// The note's content; nothing when it is damaged or of other files than `stamps`.
std::optional<RoughShape> shape_in(const std::string& note, const std::string& stamps) {
  if (note.size() < sizeof(std::uint32_t)) return std::nullopt;
  const std::string content = note.substr(sizeof(std::uint32_t));
  Reader head{note};
  if (head.get<std::uint32_t>() != checksum_of(content)) return std::nullopt;
  Reader reader{content};
  if (reader.get<std::uint32_t>() != k_format || reader.text() != stamps) return std::nullopt;
  RoughShape shape{.coarse = reader.surfels(), .few = reader.surfels()};
  if (!reader.at_end()) return std::nullopt;
  return shape;
}

std::string note_of(const RoughShape& shape, const std::string& stamps) {
  Writer content;
  content.put(k_format);
  content.put(stamps);
  content.put(shape.coarse);
  content.put(shape.few);
  const std::string bytes = content.take();
  Writer note;
  note.put(checksum_of(bytes));
  return note.take() + bytes;
}

}  // namespace

Result<RoughShape> ShapeStore::shape_of(const std::string& name) const {
  const fs::path folder = library_.folder() / k_folder;
  // Before the model is read: what is written meanwhile makes the note stale.
  const std::string stamps = stamps_of(library_.path_of(name));
  if (!stamps.empty()) {
    if (const Result<std::string> note = read_regular_file(folder / name, k_most_note_bytes)) {
      if (std::optional<RoughShape> shape = shape_in(*note, stamps)) return *std::move(shape);
    }
  }
  BITELINE_ASSIGN(const SampleFiles files, library_.load(name));
  BITELINE_ASSIGN(const Sample sample, prepare_sample(files.cloud, files.line));
  RoughShape shape = rough_shape_of(sample);
  // A library that may be read only: the next one reads the model again.
  if (report::prepare_folder(folder))
    (void)report::write_file_atomically(folder / name, note_of(shape, stamps));
  return shape;
}

}  // namespace biteline::transfer

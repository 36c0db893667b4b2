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
#include "host/report/report.hpp"

namespace biteline::transfer {
namespace {

namespace fs = std::filesystem;

constexpr const char* k_folder = ".shapes";
constexpr std::uint32_t k_format = 2;  // of the note, and of how a rough shape is drawn
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
    for (const Foot& foot : surfels.feet) {
      for (const float value : {foot.place.x(), foot.place.y(), foot.outward.x(), foot.outward.y()})
        put(value);
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
    for (std::uint32_t i = 0; good_ && i < count; ++i) {
      Foot foot;
      for (Eigen::Vector2f* v : {&foot.place, &foot.outward}) {
        for (float& value : *v) value = get<float>();
        if (!(v->cwiseAbs().maxCoeff() < k_far_mm)) good_ = false;
      }
      out.feet.push_back(foot);
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

/// A note: its checksum, the format, what it is of, and content.
std::string note_of(const std::string& stamps, std::string&& content) {
  Writer head;
  head.put(k_format);
  head.put(stamps);
  const std::string bytes = head.take() + content;
  Writer note;
  note.put(checksum_of(bytes));
  return note.take() + bytes;
}

/// What `read` makes of a note's content; nothing where the note is damaged, or of other files than `stamps`.
template <class Read>
auto noted(const fs::path& file, const std::string& stamps, Read read)
    -> decltype(read(std::declval<Reader&>())) {
  const Result<std::string> note = read_regular_file(file, k_most_note_bytes);
  if (!note || stamps.empty() || note->size() < sizeof(std::uint32_t)) return std::nullopt;
  const std::string bytes = note->substr(sizeof(std::uint32_t));
  Reader head{*note};
  if (head.get<std::uint32_t>() != checksum_of(bytes)) return std::nullopt;
  Reader reader{bytes};
  if (reader.get<std::uint32_t>() != k_format || reader.text() != stamps) return std::nullopt;
  auto content = read(reader);
  return reader.at_end() ? std::move(content) : std::nullopt;
}

std::optional<RoughShape> shape_in(Reader& reader) {
  RoughShape shape{.coarse = reader.surfels(), .few = reader.surfels(), .length_mm = reader.get<double>()};
  if (!(shape.length_mm > 0 && shape.length_mm < k_far_mm)) return std::nullopt;
  return shape;
}

/// The inner one: they teach nothing.
std::optional<std::optional<TaughtGrading>> grading_in(Reader& reader) {
  std::optional<TaughtGrading> grading;
  if (reader.get<std::uint8_t>() != 0) grading = reader.get<TaughtGrading>();
  return grading;
}

/// A library that may be read only keeps none: the next one reads the models again.
void keep(const fs::path& file, const std::string& note) {
  if (report::prepare_folder(file.parent_path())) (void)report::write_file_atomically(file, note);
}

Result<Sample> prepared(const Library& library, const std::string& name) {
  BITELINE_ASSIGN(const SampleFiles files, library.load(name));
  return prepare_sample(files.cloud, files.line);
}

}  // namespace

Result<RoughShape> ShapeStore::shape_of(const std::string& name) const {
  const fs::path file = library_.folder() / k_folder / name;
  // Before the model is read: what is written meanwhile makes the note stale.
  const std::string stamps = stamps_of(library_.path_of(name));
  if (std::optional<RoughShape> shape = noted(file, stamps, shape_in)) return *std::move(shape);
  BITELINE_ASSIGN(const Sample sample, prepared(library_, name));
  RoughShape shape = rough_shape_of(sample);
  Writer content;
  content.put(shape.coarse);
  content.put(shape.few);
  content.put(shape.length_mm);
  keep(file, note_of(stamps, content.take()));
  return shape;
}

Result<std::optional<TaughtGrading>> ShapeStore::grading_of(const std::string& sample,
                                                            const std::string& other, bool mirror) const {
  // No model's name has a plus.
  const fs::path file = library_.folder() / k_folder / (sample + "+" + other + (mirror ? "+mirrored" : ""));
  const std::string first = stamps_of(library_.path_of(sample)), second = stamps_of(library_.path_of(other));
  const std::string stamps = first.empty() || second.empty() ? std::string{} : first + "\n" + second;
  if (const auto grading = noted(file, stamps, grading_in)) return *grading;
  BITELINE_ASSIGN(const Sample one, prepared(library_, sample));
  BITELINE_ASSIGN(const Sample two, prepared(library_, other));
  const Result<TaughtGrading> taught = teach_grading(one, two, mirror);
  std::optional<TaughtGrading> grading;
  if (taught) grading = *taught;
  Writer content;
  content.put(static_cast<std::uint8_t>(grading ? 1 : 0));
  if (grading) content.put(*grading);
  keep(file, note_of(stamps, content.take()));
  return grading;
}

}  // namespace biteline::transfer

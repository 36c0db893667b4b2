// SPDX-License-Identifier: MIT
#include <bit>
#include <cerrno>
#include <cstdio>
#include <memory>
#include <string>

#include "host/cloud/ply.hpp"
#include "host/cloud/ply_file.hpp"

namespace biteline::cloud {
namespace {

static_assert(std::endian::native == std::endian::little, "write_cloud() writes memory as it is");

class BinaryWriter {
 public:
  static Result<BinaryWriter> open(const std::filesystem::path& file) {
    BinaryWriter writer{file};
    writer.stream_.reset(std::fopen(writer.beside_.c_str(), "wb"));
    if (!writer.stream_) return fail_errno(Errc::WriteFailed, errno, "%s", writer.beside_.c_str());
    return writer;
  }
  void put(const void* bytes, std::size_t count) {
    if (good_ && std::fwrite(bytes, 1, count, stream_.get()) != count) {
      good_ = false;
      errno_ = errno;
    }
  }
  void put(const std::string& text) { put(text.data(), text.size()); }
  Result<void> close() {
    if (good_ && std::fflush(stream_.get()) != 0) {
      good_ = false;
      errno_ = errno;
    }
    stream_.reset();
    if (!good_) {
      std::error_code ignored;
      std::filesystem::remove(beside_, ignored);
      return fail_errno(errno_ == ENOSPC ? Errc::DiskFull : Errc::WriteFailed, errno_, "%s", file_.c_str());
    }
    if (std::rename(beside_.c_str(), file_.c_str()) != 0)
      return fail_errno(Errc::WriteFailed, errno, "%s", file_.c_str());
    return {};
  }

 private:
  struct Closer {
    void operator()(std::FILE* stream) const { std::fclose(stream); }
  };
  explicit BinaryWriter(const std::filesystem::path& file) : file_{file}, beside_{file.string() + ".part"} {}
  std::filesystem::path file_, beside_;
  std::unique_ptr<std::FILE, Closer> stream_;
  bool good_{true};
  int errno_{0};
};

template <class T>
void put_field(std::string& row, const T& value) {
  row.append(reinterpret_cast<const char*>(&value), sizeof value);
}

Result<void> write(const std::filesystem::path& file, const PointCloud& cloud,
                   const Eigen::Vector3d& origin) {
  BITELINE_ASSIGN(BinaryWriter writer, BinaryWriter::open(file));
  const bool normals = !cloud.normals.empty(), order = cloud.organised(), sigma = !cloud.sigma_mm.empty(),
             flags = !cloud.flags.empty(), curvature = !cloud.mean_per_mm.empty(),
             amplitude = !cloud.amplitude.empty(), width = !cloud.width_px.empty(), far = !origin.isZero();
  const std::string type = far ? "double" : "float";
  std::string header =
      "ply\nformat binary_little_endian 1.0\ncomment lengths in mm, robot base frame\nelement vertex " +
      std::to_string(cloud.size()) + "\nproperty " + type + " x\nproperty " + type + " y\nproperty " + type +
      " z\n";
  if (normals) header += "property float nx\nproperty float ny\nproperty float nz\n";
  if (order) header += "property uint profile\nproperty ushort column\n";
  if (sigma) header += "property float sigma_mm\n";
  if (flags) header += "property ushort flags\n";
  if (curvature) header += "property float mean_curvature\n";
  if (amplitude) header += "property float amplitude\n";
  if (width) header += "property float width_px\n";
  writer.put(header + "end_header\n");
  std::string row;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    row.clear();
    for (int k = 0; k < 3; ++k) {
      if (far)
        put_field(row, static_cast<double>(cloud.points[i][k]) + origin[k]);
      else
        put_field(row, cloud.points[i][k]);
    }
    for (int k = 0; normals && k < 3; ++k) put_field(row, cloud.normals[i][k]);
    if (order) {
      put_field(row, cloud.profile[i]);
      put_field(row, cloud.column[i]);
    }
    if (sigma) put_field(row, cloud.sigma_mm[i]);
    if (flags) put_field(row, cloud.flags[i]);
    if (curvature) put_field(row, cloud.mean_per_mm[i]);
    if (amplitude) put_field(row, cloud.amplitude[i]);
    if (width) put_field(row, cloud.width_px[i]);
    writer.put(row);
  }
  return writer.close();
}

}  // namespace

Result<void> write_cloud(const std::filesystem::path& file, const PointCloud& cloud) {
  return write(file, cloud, Eigen::Vector3d::Zero());
}

Result<void> write_far_cloud(const std::filesystem::path& file, const PointCloud& cloud,
                             const Eigen::Vector3d& origin) {
  return write(file, cloud, origin);
}

}  // namespace biteline::cloud

// SPDX-License-Identifier: MIT
#include "tests/support/spoilt_pictures.hpp"

#include <fstream>

namespace biteline::test {

using Kind = Spoil::Kind;

std::string Spoil::name() const {
  switch (kind) {
    case Kind::AsTheyAre:
      return "as they are";
    case Kind::Mirrored:
      return "mirrored";
    case Kind::UpsideDown:
      return "upside down";
    case Kind::Turned:
      return "turned";
    case Kind::Halved:
      return "halved";
    case Kind::Small:
      return "small";
    case Kind::Rows:
      return "rows " + std::to_string(amount);
    case Kind::Columns:
      return "columns " + std::to_string(amount);
  }
  return {};
}

Vec2 spoilt(const Vec2& pixel, const geometry::Region& region, const Spoil& spoil) {
  const Vec2 corner(region.offset_u_px, region.offset_v_px);
  const Vec2 last(region.width_px - 1, region.height_px - 1);
  Vec2 at = pixel - corner;
  if (spoil.kind == Kind::Mirrored || spoil.kind == Kind::Turned) at.x() = last.x() - at.x();
  if (spoil.kind == Kind::UpsideDown || spoil.kind == Kind::Turned) at.y() = last.y() - at.y();
  if (spoil.kind == Kind::Halved || spoil.kind == Kind::Small) at /= 2;
  if (spoil.kind == Kind::Rows) at.y() += spoil.amount;
  if (spoil.kind == Kind::Columns) at.x() += spoil.amount;
  return at + corner;
}

image::GreyImage spoilt(const image::GreyImage& picture, const Spoil& spoil) {
  const int w = picture.width_px, h = picture.height_px;
  const bool small = spoil.kind == Kind::Small;
  image::GreyImage out{.width_px = small ? w / 2 : w, .height_px = small ? h / 2 : h, .pixels = {}};
  out.pixels.reserve(picture.pixels.size());
  const auto grey = [&](int u, int v) {
    return u >= 0 && v >= 0 && u < w && v < h ? static_cast<int>(picture.at(u, v)) : 0;
  };
  const auto came_from = [&](int u, int v) {
    switch (spoil.kind) {
      case Kind::Mirrored:
        return grey(w - 1 - u, v);
      case Kind::UpsideDown:
        return grey(u, h - 1 - v);
      case Kind::Turned:
        return grey(w - 1 - u, h - 1 - v);
      case Kind::Halved:
      case Kind::Small:
        return (grey(2 * u, 2 * v) + grey(2 * u + 1, 2 * v) + grey(2 * u, 2 * v + 1) +
                grey(2 * u + 1, 2 * v + 1)) /
               4;
      case Kind::Rows:
        return grey(u, v - spoil.amount);
      case Kind::Columns:
        return grey(u - spoil.amount, v);
      case Kind::AsTheyAre:
        break;
    }
    return grey(u, v);
  };
  for (int v = 0; v < out.height_px; ++v) {
    for (int u = 0; u < out.width_px; ++u) out.pixels.push_back(static_cast<std::uint8_t>(came_from(u, v)));
  }
  return out;
}

Result<void> write_spoilt_session(const std::filesystem::path& session, const std::filesystem::path& out,
                                  const Spoil& spoil, int every) {
  namespace fs = std::filesystem;
  fs::remove_all(out);
  fs::create_directories(out / "cam0" / "data");
  fs::copy(session / "cam0" / "sensor.yaml", out / "cam0" / "sensor.yaml");
  for (const char* part : {"pose0", "truth"}) {
    if (fs::exists(session / part)) fs::copy(session / part, out / part, fs::copy_options::recursive);
  }
  std::ifstream rows{session / "cam0" / "data.csv"};
  std::ofstream kept{out / "cam0" / "data.csv"};
  int count = 0;
  for (std::string row; std::getline(rows, row);) {
    if (row.starts_with("#")) {
      kept << row << "\n";
      continue;
    }
    if (count++ % every != 0) continue;
    kept << row << "\n";
    std::string name = row.substr(row.find(',') + 1);
    while (!name.empty() && std::isspace(static_cast<unsigned char>(name.back())) != 0) name.pop_back();
    BITELINE_ASSIGN(const image::GreyImage picture, image::read_png(session / "cam0" / "data" / name));
    BITELINE_TRY(image::write_png(out / "cam0" / "data" / name, spoilt(picture, spoil)));
  }
  return {};
}

}  // namespace biteline::test

// SPDX-License-Identifier: MIT
#include "hal/sim/contact/contact_world.hpp"

#include <mujoco/mujoco.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <string>

#include "common/core/fixed_text.hpp"

namespace biteline::sim {
namespace {

constexpr double k_m_per_mm = 1e-3, k_step_s = 1e-3;
/// How much of a contact's acceleration the engine's soft constraint takes.  Near 0 each contact is a plain
/// spring; near 1 it would weigh as much as the tool, and a dozen of them a dozen times as much.
constexpr double k_impedance = 0.001;
/// Of an upper, from its stiffness to its damping.
constexpr double k_relaxation_s = 0.002;

using Row = FixedText<400>;

Row vector_text(const Vec3& v_mm) {
  const Vec3 v = k_m_per_mm * v_mm;
  return Row::format("%.9g %.9g %.9g", v.x(), v.y(), v.z());
}

std::string mjcf(const UpperStrip& strip, const ContactTool& tool) {
  const double stiffness = tool.newton_per_mm / k_m_per_mm;
  const double damping = 2 * tool.damping_ratio * std::sqrt(stiffness * tool.moving_kg);
  std::string text =
      "<mujoco><compiler autolimits=\"false\" inertiafromgeom=\"false\"/>"
      "<option gravity=\"0 0 0\" timestep=\"0.001\" cone=\"elliptic\"/>"
      "<size nconmax=\"500\" njmax=\"1000\"/><worldbody>\n";
  for (const UpperPiece& piece : strip.pieces) {
    text += Row::format(
                "<geom type=\"sphere\" size=\"%g\" pos=\"%s\" contype=\"1\" conaffinity=\"0\" "
                "condim=\"1\" priority=\"1\"/>\n",
                k_piece_head_mm * k_m_per_mm,
                vector_text(piece.point_base - k_piece_head_mm * piece.normal_base).c_str())
                .view();
  }
  text += "<body name=\"arm\" mocap=\"true\"><body name=\"tool\">\n";
  text += Row::format(
              "<inertial mass=\"%g\" pos=\"0 0 0\" diaginertia=\"0.01 0.01 0.01\"/>"
              "<joint type=\"slide\" axis=\"0 0 1\" stiffness=\"%g\" damping=\"%g\"/>\n",
              tool.moving_kg, stiffness, damping)
              .view();
  text += Row::format(
              "<geom name=\"disc\" type=\"cylinder\" size=\"%g %g\" zaxis=\"0 1 0\" contype=\"0\" "
              "conaffinity=\"1\" condim=\"1\"/>\n",
              tool.radius_mm * k_m_per_mm, 0.5 * tool.width_mm * k_m_per_mm)
              .view();
  return text + "</body></body></worldbody></mujoco>\n";
}

}  // namespace

ContactTool grinding_disc() {
  return {};
}
ContactTool roughing_brush() {
  // Wires give: some 15 N/mm over a contact of 10 x 8 mm.
  return {.radius_mm = 28,
          .width_mm = 10,
          .lead_rad = 0.1745,
          .face_newton_per_mm3 = 0.2,
          .friction_ratio = 0.5,
          .surface_mm_s = 8000,
          .wear_mm2_per_newton = 2e-4};
}
ContactTool pressing_roller() {
  return {.radius_mm = 10, .width_mm = 8, .friction_ratio = 0, .surface_mm_s = 0, .wear_mm2_per_newton = 0};
}

ContactWorld::ContactWorld(const UpperStrip& strip, const ContactTool& tool)
    : strip_{strip}, tool_{tool}, removed_mm_(strip.pieces.size(), 0.0) {}

ContactWorld::~ContactWorld() {
  if (data_ != nullptr) mj_deleteData(data_);
  if (model_ != nullptr) mj_deleteModel(model_);
}

Result<std::unique_ptr<ContactWorld>> ContactWorld::create(const UpperStrip& strip, const ContactTool& tool) {
  if (strip.columns() < 2) return fail(Errc::BadValue, "contact: a strip without pieces");
  std::unique_ptr<ContactWorld> world{new ContactWorld{strip, tool}};
  BITELINE_TRY(world->load());
  return world;
}

Result<void> ContactWorld::load() {
  constexpr const char* k_name = "upper.xml";
  const std::string text = mjcf(strip_, tool_);
  char reason[300] = "";
  // The engine reads files alone; this one lies in memory.
  mjVFS files;
  mj_defaultVFS(&files);
  if (mj_makeEmptyFileVFS(&files, k_name, static_cast<int>(text.size())) == 0) {
    std::memcpy(files.filedata[mj_findFileVFS(&files, k_name)], text.data(), text.size());
    model_ = mj_loadXML(k_name, &files, reason, sizeof reason);
  }
  mj_deleteVFS(&files);
  if (model_ == nullptr) return fail(Errc::BadValue, "contact: MuJoCo: %.200s", reason);
  data_ = mj_makeData(model_);
  disc_ = mj_name2id(model_, mjOBJ_GEOM, "disc");
  const double per_kg = model_->body_invweight0[2 * mj_name2id(model_, mjOBJ_BODY, "tool")];
  // At rest a soft contact's force is stiffness * depth / ((1 - impedance) * diagonal), the diagonal being
  // what the engine takes for the inverse mass behind it.
  for (std::size_t i = 0; i < strip_.pieces.size(); ++i) {
    const UpperPiece& piece = strip_.pieces[i];
    const double face = tool_.face_newton_per_mm3 * piece.area_mm2;
    const double newton_per_mm =
        face > 0 ? piece.newton_per_mm * face / (piece.newton_per_mm + face) : piece.newton_per_mm;
    const double stiffness = newton_per_mm / k_m_per_mm * (1 - k_impedance) * per_kg;
    mjtNum* solref = model_->geom_solref + mjNREF * i;
    solref[0] = -stiffness;
    solref[1] = -k_relaxation_s * stiffness;
    mjtNum* solimp = model_->geom_solimp + mjNIMP * i;
    solimp[0] = solimp[1] = k_impedance;
  }
  return {};
}

std::size_t ContactWorld::nearest_column(const Vec3& tip_base) const {
  const std::size_t row = strip_.rows / 2, count = strip_.columns();
  const auto off = [&](std::size_t column) { return (strip_.at(column, row).point_base - tip_base).norm(); };
  std::size_t best = now_.column;
  // From there the nearest one may lie on the shoe's other side.
  constexpr double k_near_mm = 20;
  if (off(best) > k_near_mm) {
    for (std::size_t i = 0; i < count; ++i) best = off(i) < off(best) ? i : best;
    return best;
  }
  for (std::size_t step = 0; step < count; ++step) {
    const std::size_t next = (best + 1) % count, before = (best + count - 1) % count;
    if (off(next) < off(best)) {
      best = next;
    } else if (off(before) < off(best)) {
      best = before;
    } else {
      break;
    }
  }
  return best;
}

Mat3 ContactWorld::face_at(const SE3& T_base_tcp, std::size_t column) const {
  const std::size_t row = strip_.rows / 2, count = strip_.columns();
  const Vec3 way = strip_.at((column + 1) % count, row).point_base -
                   strip_.at((column + count - 1) % count, row).point_base;
  const Vec3 body = -T_base_tcp.linear().col(2);
  // Along the line, and square to it the tool's axis before its lead (host/robot/path/tool_path).
  const Vec3 line = way.normalized();
  const Vec3 upright = (body - body.dot(line) * line).normalized();
  const Vec3 out = std::cos(tool_.tilt_rad) * upright - std::sin(tool_.tilt_rad) * upright.cross(line);
  Mat3 R;
  R.col(2) = -out;
  R.col(1) = line.cross(out).normalized();
  R.col(0) = R.col(1).cross(R.col(2));
  return R;
}

void ContactWorld::carry(const Vec3& centre_base, const Mat3& R_base_face) {
  const Eigen::Quaterniond turn{R_base_face};
  const double quaternion[4] = {turn.w(), turn.x(), turn.y(), turn.z()};
  for (int i = 0; i < 3; ++i) data_->mocap_pos[i] = k_m_per_mm * centre_base[i];
  std::copy_n(quaternion, 4, data_->mocap_quat);
}

void ContactWorld::feel(const Mat3& R_base_face) {
  now_.depth_mm = 0;
  Vec3 force = Vec3::Zero();
  for (int i = 0; i < data_->ncon; ++i) {
    const mjContact& contact = data_->contact[i];
    if (contact.efc_address < 0) continue;
    mjtNum along[6];
    mj_contactForce(model_, data_, i, along);
    // The frame's first row points from the first body to the second.
    const double towards_disc = contact.geom2 == disc_ ? 1 : -1;
    force += towards_disc * along[0] * Vec3{contact.frame[0], contact.frame[1], contact.frame[2]};
    now_.depth_mm = std::max(now_.depth_mm, -contact.dist / k_m_per_mm);
    const auto piece = static_cast<std::size_t>(contact.geom2 == disc_ ? contact.geom1 : contact.geom2);
    removed_mm_[piece] +=
        tool_.wear_mm2_per_newton * along[0] / strip_.pieces[piece].area_mm2 * tool_.surface_mm_s * k_step_s;
  }
  const double pressed = -force.dot(R_base_face.col(2));
  now_.pressed_newton += pressed;
  // A rim that slides fast pulls one way, whatever the tool's own speed (Coulomb).
  now_.force_base += force + tool_.friction_ratio * pressed * R_base_face.col(0);
}

const ContactNow& ContactWorld::step(const SE3& T_base_tcp, double step_s) {
  now_.column = nearest_column(T_base_tcp.translation());
  const Mat3 R = face_at(T_base_tcp, now_.column);
  const Vec3 centre = T_base_tcp.translation() - tool_.radius_mm * R.col(2);
  if (!begun_) centre_base_ = centre;
  begun_ = true;
  const int steps = std::max(1, static_cast<int>(std::lround(step_s / k_step_s)));
  now_.force_base.setZero();
  now_.pressed_newton = 0;
  for (int i = 1; i <= steps; ++i) {
    const double part = static_cast<double>(i) / steps;
    carry((1 - part) * centre_base_ + part * centre, R);
    mj_step(model_, data_);
    feel(R);
  }
  now_.force_base /= steps;
  now_.pressed_newton /= steps;
  centre_base_ = centre;
  return now_;
}

std::vector<double> ContactWorld::removed_width_mm(double least_mm) const {
  std::vector<double> widths;
  for (std::size_t column = 0; column < strip_.columns(); ++column) {
    double width_mm = 0;
    const auto removed = [&](std::size_t row) { return removed_mm_[column * strip_.rows + row] - least_mm; };
    for (std::size_t row = 0; row + 1 < strip_.rows; ++row) {
      const double a = removed(row), b = removed(row + 1);
      if (a > 0 && b > 0) {
        width_mm += strip_.piece_mm;
      } else if (a > 0 || b > 0) {
        width_mm += strip_.piece_mm * std::max(a, b) / std::abs(a - b);
      }
    }
    widths.push_back(width_mm);
  }
  return widths;
}

}  // namespace biteline::sim

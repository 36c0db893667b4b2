// SPDX-License-Identifier: MIT
// The Python module: the library's functions with numpy arrays.
#include <pybind11/eigen.h>
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <cmath>
#include <limits>

#include "biteline/biteline.hpp"
#include "host/library/python/arrays.hpp"
#ifdef BITELINE_HAS_SENSOR
#include "biteline/sensor.hpp"
#endif

namespace bl = biteline::sdk;

namespace {

using namespace biteline::python;

/// Python's two exception classes, set by the package; never freed: they may be asked for at its very end.
struct Exceptions {
  PyObject* error{PyExc_RuntimeError};
  PyObject* refused{PyExc_RuntimeError};
};
Exceptions& exceptions() {
  static Exceptions both;
  return both;
}

void raise(PyObject* type, const bl::Error& error, const std::string& reason_code) {
  const py::object made = py::reinterpret_borrow<py::object>(type)(error.what());
  made.attr("next_step") = error.next_step();
  if (!reason_code.empty()) made.attr("reason_code") = reason_code;
  PyErr_SetObject(type, made.ptr());
}

void translate(std::exception_ptr thrown) {
  try {
    if (thrown) std::rethrow_exception(thrown);
  } catch (const bl::Refused& refused) {
    raise(exceptions().refused, refused, refused.reason_code());
  } catch (const bl::Error& error) {
    raise(exceptions().error, error, {});
  }
}

std::vector<Eigen::Vector3f> points_of(const Array<float>& points) {
  if (points.ndim() != 2 || points.shape(1) != 3) throw py::value_error("points: an array (N, 3) expected");
  std::vector<Eigen::Vector3f> out(static_cast<std::size_t>(points.shape(0)));
  for (std::size_t i = 0; i < out.size(); ++i)
    out[i] = Eigen::Map<const Eigen::Vector3f>(points.data() + 3 * i);
  return out;
}

py::array points_view(const py::object& self) {
  const auto points = self.cast<const bl::Cloud&>().points_mm();
  py::array out(py::dtype::of<float>(), {static_cast<py::ssize_t>(points.size()), py::ssize_t{3}}, {},
                reinterpret_cast<const float*>(points.data()), self);
  out.attr("setflags")(false);
  return out;
}

bl::Unit unit_of(const std::string& word) {
  if (word == "mm") return bl::Unit::Millimetre;
  if (word == "cm") return bl::Unit::Centimetre;
  if (word == "m") return bl::Unit::Metre;
  if (word == "in") return bl::Unit::Inch;
  throw py::value_error("unit: mm, cm, m or in expected");
}

bl::Line line_of(const Array<double>& positions, const Array<double>& normals, const Array<double>& tangents,
                 double confidence) {
  for (const auto* array : {&positions, &normals, &tangents})
    if (array->ndim() != 2 || array->shape(1) != 3 || array->shape(0) != positions.shape(0))
      throw py::value_error("line: three arrays (N, 3) expected");
  bl::Line line;
  for (py::ssize_t i = 0; i < positions.shape(0); ++i) {
    const auto at = [i](const Array<double>& array) {
      return Eigen::Vector3d{Eigen::Map<const Eigen::Vector3d>(array.data() + 3 * i)};
    };
    line.points.push_back({.position_mm = at(positions),
                           .normal = at(normals),
                           .tangent = at(tangents),
                           .confidence = confidence});
  }
  return line;
}

constexpr double k_unknown = std::numeric_limits<double>::quiet_NaN();

void add_cloud(py::module_& m) {
  py::class_<bl::Cloud>(m, "Cloud")
      .def(py::init([](const Array<float>& points) { return bl::Cloud{points_of(points)}; }),
           py::arg("points_mm"))
      .def("__len__", &bl::Cloud::size)
      .def_property_readonly("points_mm", &points_view)
      .def_property_readonly(
          "profile",
          [](const py::object& self) { return view(self.cast<const bl::Cloud&>().profile(), self); })
      .def_property_readonly(
          "column", [](const py::object& self) { return view(self.cast<const bl::Cloud&>().column(), self); })
      .def_property_readonly("sigma_mm", [](const py::object& self) {
        return view(self.cast<const bl::Cloud&>().sigma_mm(), self);
      });
  m.def(
      "read_cloud",
      [](const std::filesystem::path& file, const std::string& unit) {
        return bl::read_cloud(file, unit_of(unit));
      },
      py::arg("file"), py::arg("unit") = "mm");
  m.def("write_cloud", &bl::write_cloud, py::arg("file"), py::arg("cloud"), Free());
}

void add_line(py::module_& m) {
  using bl::LinePoint;
  py::class_<bl::Line>(m, "Line")
      .def(py::init(&line_of), py::arg("positions_mm"), py::arg("normals"), py::arg("tangents"),
           py::arg("confidence") = 1.0)
      .def("__len__", [](const bl::Line& line) { return line.points.size(); })
      .def_property_readonly("length_mm", &bl::length_mm)
      .def_property_readonly("positions_mm",
                             [](const bl::Line& line) {
                               return rows<double>(line.points, 3,
                                                   [](const LinePoint& p) { return p.position_mm; });
                             })
      .def_property_readonly("normals",
                             [](const bl::Line& line) {
                               return rows<double>(line.points, 3,
                                                   [](const LinePoint& p) { return p.normal; });
                             })
      .def_property_readonly("tangents",
                             [](const bl::Line& line) {
                               return rows<double>(line.points, 3,
                                                   [](const LinePoint& p) { return p.tangent; });
                             })
      .def_property_readonly("confidence",
                             [](const bl::Line& line) {
                               return column<double>(line.points,
                                                     [](const LinePoint& p) { return p.confidence; });
                             })
      .def_property_readonly("u95_mm",
                             [](const bl::Line& line) {
                               return column<double>(line.points, [](const LinePoint& p) {
                                 return p.u95_mm.value_or(k_unknown);
                               });
                             })
      .def_property_readonly("unsure",
                             [](const bl::Line& line) {
                               return column<bool>(line.points, [](const LinePoint& p) { return p.unsure; });
                             })
      .def_property_readonly("source", [](const bl::Line& line) {
        constexpr std::array k_words{"seen", "bridged", "carried", "mended"};
        py::list words;
        for (const LinePoint& point : line.points)
          words.append(k_words.at(static_cast<std::size_t>(point.source)));
        return words;
      });
  m.def("read_line", &bl::read_line, py::arg("file"), Free());
  m.def("write_line", &bl::write_line, py::arg("file"), py::arg("line"), Free());
  py::class_<bl::FoundLine>(m, "FoundLine")
      .def_readonly("line", &bl::FoundLine::line)
      .def_readonly("confidence", &bl::FoundLine::confidence)
      .def_readonly("bridged_mm", &bl::FoundLine::bridged_mm)
      .def_readonly("review", &bl::FoundLine::review);
  m.def("find_line", &bl::find_line, py::arg("cloud"), Free());
}

void add_transfer(py::module_& m) {
  py::class_<bl::Sample>(m, "Sample")
      .def(py::init<const bl::Cloud&, const bl::Line&>(), py::arg("cloud"), py::arg("line"));
  m.def("read_sample", &bl::read_sample, py::arg("folder"), Free());
  py::class_<bl::CarriedLine>(m, "CarriedLine")
      .def_readonly("line", &bl::CarriedLine::line)
      .def_readonly("confidence", &bl::CarriedLine::confidence)
      .def_readonly("bound_mm", &bl::CarriedLine::bound_mm)
      .def_readonly("shape_rms_mm", &bl::CarriedLine::shape_rms_mm)
      .def_readonly("bridged_mm", &bl::CarriedLine::bridged_mm);
  m.def(
      "transfer_line",
      [](const bl::Sample& sample, const bl::Cloud& upper, bool mirror, bool grade) {
        return bl::transfer_line(sample, upper, {.mirror = mirror, .grade = grade});
      },
      py::arg("sample"), py::arg("upper"), py::arg("mirror") = false, py::arg("grade") = false, Free());
}

void add_plan(py::module_& m) {
  using bl::Waypoint;
  py::class_<bl::Path>(m, "Path")
      .def("__len__", [](const bl::Path& path) { return path.waypoints().size(); })
      .def_property_readonly("duration_s", &bl::Path::duration_s)
      .def_property_readonly(
          "T_base_tcp",
          [](const bl::Path& path) {
            const py::array flat = rows<double>(path.waypoints(), 16, [](const Waypoint& w) {
              const Eigen::Matrix<double, 4, 4, Eigen::RowMajor> T = w.T_base_tcp.matrix();
              return std::vector<double>(T.data(), T.data() + 16);
            });
            return flat.attr("reshape")(-1, 4, 4);
          })
      .def_property_readonly("joints_rad",
                             [](const bl::Path& path) {
                               return rows<double>(path.waypoints(), 6,
                                                   [](const Waypoint& w) { return w.joints_rad; });
                             })
      .def_property_readonly("time_s",
                             [](const bl::Path& path) {
                               return column<double>(path.waypoints(),
                                                     [](const Waypoint& w) { return w.time_s; });
                             })
      .def_property_readonly("speed_mm_s",
                             [](const bl::Path& path) {
                               return column<double>(path.waypoints(),
                                                     [](const Waypoint& w) { return w.speed_mm_s; });
                             })
      .def_property_readonly("u95_mm",
                             [](const bl::Path& path) {
                               return column<double>(path.waypoints(), [](const Waypoint& w) {
                                 return w.u95_mm.value_or(k_unknown);
                               });
                             })
      .def_property_readonly("segment",
                             [](const bl::Path& path) {
                               py::list words;
                               for (const Waypoint& waypoint : path.waypoints())
                                 words.append(waypoint.segment);
                               return words;
                             })
      .def("write_csv", &bl::Path::write_csv, py::arg("file"), Free());
  m.def(
      "plan",
      [](const bl::Line& line, const std::filesystem::path& process_file, const std::string& robot,
         const Eigen::Matrix4d& T_line_base, double table_z_mm, const std::optional<bl::Cloud>& cloud,
         const std::optional<bl::Joints>& from_rad) {
        return bl::plan({.line = line,
                         .process_file = process_file,
                         .robot = robot,
                         .T_line_base = bl::Motion{T_line_base},
                         .table_z_mm = table_z_mm,
                         .cloud = cloud,
                         .from_rad = from_rad});
      },
      py::arg("line"), py::arg("process_file"), py::arg("robot"),
      py::arg("T_line_base") = Eigen::Matrix4d::Identity().eval(), py::arg("table_z_mm") = 0.0,
      py::arg("cloud") = py::none(), py::arg("from_rad") = py::none(), Free());
}

py::dict find_stripe(const Array<std::uint8_t>& picture, float threshold_grey, float width_min_px,
                     float width_max_px) {
  if (picture.ndim() != 2) throw py::value_error("picture: an array (height, width) of grey levels expected");
  const auto height = static_cast<int>(picture.shape(0)), width = static_cast<int>(picture.shape(1));
  const std::vector<bl::Peak> peaks = bl::find_stripe(
      {.pixels = picture.data(),
       .stride_bytes = static_cast<std::size_t>(width),
       .width_px = width,
       .height_px = height},
      {.threshold_grey = threshold_grey, .width_min_px = width_min_px, .width_max_px = width_max_px});
  py::dict out;
  out["column_px"] = column<std::int32_t>(peaks, [](const bl::Peak& p) { return p.column_px; });
  out["row_px"] = column<float>(peaks, [](const bl::Peak& p) { return p.row_px; });
  out["sigma_row_px"] = column<float>(peaks, [](const bl::Peak& p) { return p.sigma_row_px; });
  out["amplitude"] = column<float>(peaks, [](const bl::Peak& p) { return p.amplitude; });
  out["width_px"] = column<float>(peaks, [](const bl::Peak& p) { return p.width_px; });
  out["sound"] = column<bool>(peaks, [](const bl::Peak& p) { return p.sound; });
  return out;
}

py::array_t<double> triangulate(const bl::Head& head, const Array<double>& columns,
                                const Array<double>& rows_px) {
  if (columns.ndim() != 1 || rows_px.ndim() != 1 || columns.size() != rows_px.size())
    throw py::value_error("columns and rows: two arrays (N,) expected");
  std::vector<Eigen::Vector3d> points;
  for (py::ssize_t i = 0; i < columns.size(); ++i)
    points.push_back(head.triangulate(columns.data()[i], rows_px.data()[i]));
  return rows<double>(points, 3, [](const Eigen::Vector3d& point) { return point; });
}

void add_head(py::module_& m) {
  py::class_<bl::Head>(m, "Head")
      .def_property_readonly("width_px", &bl::Head::width_px)
      .def_property_readonly("height_px", &bl::Head::height_px)
      .def_property_readonly(
          "T_flange_cam", [](const bl::Head& head) { return Eigen::Matrix4d{head.T_flange_cam().matrix()}; })
      .def_property_readonly("laser_normal_cam", &bl::Head::laser_normal_cam)
      .def_property_readonly("laser_distance_mm", &bl::Head::laser_distance_mm)
      .def("project", &bl::Head::project, py::arg("point_cam_mm"))
      .def("triangulate", &triangulate, py::arg("columns_px"), py::arg("rows_px"))
      .def("yaml", &bl::Head::yaml);
  m.def("read_head", &bl::read_head, py::arg("file"), Free());
  m.def("find_stripe", &find_stripe, py::arg("picture"), py::arg("threshold_grey") = 12.0F,
        py::arg("width_min_px") = 1.5F, py::arg("width_max_px") = 24.0F);
  py::class_<bl::Calibration>(m, "Calibration")
      .def_readonly("head", &bl::Calibration::head)
      .def_readonly("good", &bl::Calibration::good)
      .def_readonly("reasons", &bl::Calibration::reasons)
      .def_readonly("retake", &bl::Calibration::retake);
  m.def("calibrate_head", &bl::calibrate_head, py::arg("folder"), Free());
}

void add_recording(py::module_& m) {
  using bl::Profile;
  const auto xyz = [](const Eigen::Vector3f& point) { return point; };
  py::class_<Profile>(m, "Profile")
      .def_readonly("sequence", &Profile::sequence)
      .def_readonly("exposure_mid_ns", &Profile::exposure_mid_ns)
      .def_readonly("usable", &Profile::usable)
      .def_property_readonly(
          "T_base_cam", [](const Profile& profile) { return Eigen::Matrix4d{profile.T_base_cam.matrix()}; })
      .def_property_readonly(
          "points_cam_mm",
          [xyz](const Profile& profile) { return rows<float>(profile.points_cam_mm, 3, xyz); })
      .def_property_readonly(
          "sigma_mm",
          [](const Profile& profile) { return column<float>(profile.sigma_mm, [](float v) { return v; }); })
      .def_property_readonly("column_px", [](const Profile& profile) {
        return column<std::uint16_t>(profile.column_px, [](std::uint16_t v) { return v; });
      });
  py::class_<bl::Recording>(m, "Recording")
      .def_readonly("head", &bl::Recording::head)
      .def_readonly("profiles", &bl::Recording::profiles)
      .def_readonly("cloud", &bl::Recording::cloud)
      .def_readonly("lacks", &bl::Recording::lacks);
  m.def("read_recording", &bl::read_recording, py::arg("file"), Free());
#ifdef BITELINE_HAS_SENSOR
  py::class_<bl::SensorClient>(m, "SensorClient")
      .def(py::init(
               [](const std::string& endpoint, const std::filesystem::path& keys, const std::string& name) {
                 return bl::SensorClient{{.endpoint = endpoint, .keys = keys, .name = name}};
               }),
           py::arg("endpoint"), py::arg("keys") = std::filesystem::path{},
           py::arg("name") = "biteline-python")
      .def(
          "scan",
          [](bl::SensorClient& client, const std::filesystem::path& file, double timeout_s) {
            if (!(timeout_s > 0 && timeout_s < 1e6))
              throw py::value_error("timeout_s: above 0 and below 1e6 expected");
            return client.scan(file, std::chrono::milliseconds{std::llround(1000 * timeout_s)});
          },
          py::arg("file"), py::arg("timeout_s"), Free());
#endif
}

}  // namespace

PYBIND11_MODULE(_native, m) {
  m.attr("__version__") = bl::version();
  m.def("_raise_as", [](const py::object& error, const py::object& refused) {
    exceptions() = {.error = error.inc_ref().ptr(), .refused = refused.inc_ref().ptr()};
  });
  py::register_exception_translator(&translate);
  add_cloud(m);
  add_line(m);
  add_transfer(m);
  add_plan(m);
  add_head(m);
  add_recording(m);
}

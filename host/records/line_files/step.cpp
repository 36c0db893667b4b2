// SPDX-License-Identifier: MIT
// STEP (ISO 10303-21) by the schema AUTOMOTIVE_DESIGN (AP214): one product whose shape is a set with one
// closed B-spline curve.
#include "common/core/fixed_text.hpp"
#include "host/records/line_files/spline.hpp"
#include "host/records/line_files/writers.hpp"

namespace biteline::line_files {
namespace {

/// Instances of the data section, numbered as they come.
class Instances {
 public:
  /// Adds one; its reference ("#7").
  std::string add(const std::string& instance) {
    std::string reference{'#'};
    reference += std::to_string(++count_);
    text_ += reference + "=" + instance + ";\n";
    return reference;
  }
  [[nodiscard]] const std::string& text() const { return text_; }

 private:
  std::string text_;
  int count_{0};
};

/// "(a,b,c)"
template <class Range, class ToText>
std::string list(const Range& values, ToText to_text) {
  std::string text = "(";
  for (const auto& value : values) {
    if (text.size() > 1) text += ",";
    text += to_text(value);
  }
  return text + ")";
}

/// A real of STEP has a point.
std::string real(double value) {
  return std::string(FixedText<40>::format("%.6f", value).view());
}

std::string point(const Vec3& p) {
  return "CARTESIAN_POINT('',(" + real(p.x()) + "," + real(p.y()) + "," + real(p.z()) + "))";
}

std::string add_curve(Instances& instances, const cloud::ClosedLine& line) {
  const ClosedSpline spline = spline_through(line);
  std::vector<std::string> control;
  for (const Vec3& p : spline.control) control.push_back(instances.add(point(p)));
  std::vector<int> multiplicity(spline.knots.size(), 3);
  multiplicity.front() = multiplicity.back() = 4;
  return instances.add("B_SPLINE_CURVE_WITH_KNOTS('bite line',3," +
                       list(control, [](const std::string& reference) { return reference; }) +
                       ",.UNSPECIFIED.,.T.,.F.," +
                       list(multiplicity, [](int m) { return std::to_string(m); }) + "," +
                       list(spline.knots, real) + ",.UNSPECIFIED.)");
}

/// Lengths in mm, angles in radians.
std::string add_context(Instances& instances) {
  const std::string mm = instances.add("(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT(.MILLI.,.METRE.))");
  const std::string radian = instances.add("(NAMED_UNIT(*)PLANE_ANGLE_UNIT()SI_UNIT($,.RADIAN.))");
  const std::string steradian = instances.add("(NAMED_UNIT(*)SI_UNIT($,.STERADIAN.)SOLID_ANGLE_UNIT())");
  const std::string accuracy = instances.add("UNCERTAINTY_MEASURE_WITH_UNIT(LENGTH_MEASURE(1.E-05)," + mm +
                                             ",'distance_accuracy_value','')");
  return instances.add("(GEOMETRIC_REPRESENTATION_CONTEXT(3)GLOBAL_UNCERTAINTY_ASSIGNED_CONTEXT((" +
                       accuracy + "))GLOBAL_UNIT_ASSIGNED_CONTEXT((" + mm + "," + radian + "," + steradian +
                       "))REPRESENTATION_CONTEXT('base','3D'))");
}

void add_product(Instances& instances, const std::string& shape) {
  const std::string application =
      instances.add("APPLICATION_CONTEXT('core data for automotive mechanical design processes')");
  instances.add("APPLICATION_PROTOCOL_DEFINITION('international standard','automotive_design',2000," +
                application + ")");
  const std::string product_context = instances.add("PRODUCT_CONTEXT(''," + application + ",'mechanical')");
  const std::string product = instances.add("PRODUCT('bite_line','bite line','',(" + product_context + "))");
  instances.add("PRODUCT_RELATED_PRODUCT_CATEGORY('part',$,(" + product + "))");
  const std::string formation = instances.add("PRODUCT_DEFINITION_FORMATION('',''," + product + ")");
  const std::string definition_context =
      instances.add("PRODUCT_DEFINITION_CONTEXT('part definition'," + application + ",'design')");
  const std::string definition =
      instances.add("PRODUCT_DEFINITION('design',''," + formation + "," + definition_context + ")");
  const std::string its_shape = instances.add("PRODUCT_DEFINITION_SHAPE('',''," + definition + ")");
  instances.add("SHAPE_DEFINITION_REPRESENTATION(" + its_shape + "," + shape + ")");
}

}  // namespace

std::string step_text(const cloud::ClosedLine& line) {
  Instances instances;
  const std::string context = add_context(instances);
  const std::string curve = add_curve(instances, line);
  const std::string set = instances.add("GEOMETRIC_CURVE_SET('',(" + curve + "))");
  add_product(instances, instances.add("GEOMETRICALLY_BOUNDED_WIREFRAME_SHAPE_REPRESENTATION('',(" + set +
                                       ")," + context + ")"));
  // No time stamp: the same line gives the same bytes.
  return "ISO-10303-21;\nHEADER;\nFILE_DESCRIPTION(('bite line, mm, robot base frame'),'2;1');\n"
         "FILE_NAME('','',(''),(''),'','biteline','');\n"
         "FILE_SCHEMA(('AUTOMOTIVE_DESIGN { 1 0 10303 214 1 1 1 1 }'));\nENDSEC;\nDATA;\n" +
         instances.text() + "ENDSEC;\nEND-ISO-10303-21;\n";
}

}  // namespace biteline::line_files

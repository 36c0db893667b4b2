// SPDX-License-Identifier: MIT
// read_step FILE.step LINE.csv: reads the file with OpenCASCADE and prints its number of edges, whether the
// first one is closed, its length [mm], and the greatest distance [mm] of the rows' places from it.
#include <BRepAdaptor_Curve.hxx>
#include <BRep_Tool.hxx>
#include <GCPnts_AbscissaPoint.hxx>
#include <GeomAPI_ProjectPointOnCurve.hxx>
#include <STEPControl_Reader.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>
#include <algorithm>
#include <cstdio>
#include <fstream>
#include <string>

int main(int argc, char** argv) {
  if (argc != 3) return 2;
  STEPControl_Reader reader;
  if (reader.ReadFile(argv[1]) != IFSelect_RetDone || reader.TransferRoots() < 1) {
    std::fprintf(stderr, "read_step: %s: no shape\n", argv[1]);
    return 3;
  }
  int edges = 0;
  TopoDS_Edge edge;
  for (TopExp_Explorer at(reader.OneShape(), TopAbs_EDGE); at.More(); at.Next(), ++edges)
    edge = TopoDS::Edge(at.Current());
  if (edges == 0) return 3;
  const BRepAdaptor_Curve curve(edge);
  double first = 0, last = 0;
  const Handle(Geom_Curve) geometry = BRep_Tool::Curve(edge, first, last);
  const bool closed = curve.Value(first).Distance(curve.Value(last)) < 1e-6;
  double worst = 0;
  std::ifstream rows(argv[2]);
  for (std::string row; std::getline(rows, row);) {
    double x = 0, y = 0, z = 0;
    if (std::sscanf(row.c_str(), "%lf,%lf,%lf", &x, &y, &z) != 3) continue;
    const gp_Pnt place(x, y, z);
    double least = std::min(place.Distance(curve.Value(first)), place.Distance(curve.Value(last)));
    const GeomAPI_ProjectPointOnCurve foot(place, geometry);
    if (foot.NbPoints() > 0) least = std::min(least, foot.LowerDistance());
    worst = std::max(worst, least);
  }
  std::printf("%d %d %.6f %.9f\n", edges, closed ? 1 : 0, GCPnts_AbscissaPoint::Length(curve), worst);
  return 0;
}

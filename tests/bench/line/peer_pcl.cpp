// SPDX-License-Identifier: MIT
#include <pcl/features/normal_3d.h>
#include <pcl/features/principal_curvatures.h>
#include <pcl/search/kdtree.h>

#include "tests/bench/line/peers.hpp"

namespace biteline::bench::peers {

bool has_pcl() {
  return true;
}

Values pcl_curvature(std::span<const Eigen::Vector3f> points, std::size_t neighbours, float radius_mm) {
  pcl::PointCloud<pcl::PointXYZ>::Ptr cloud{new pcl::PointCloud<pcl::PointXYZ>};
  cloud->reserve(points.size());
  for (const Eigen::Vector3f& p : points) cloud->push_back({p.x(), p.y(), p.z()});
  pcl::search::KdTree<pcl::PointXYZ>::Ptr tree{new pcl::search::KdTree<pcl::PointXYZ>};
  pcl::PointCloud<pcl::Normal>::Ptr normals{new pcl::PointCloud<pcl::Normal>};
  pcl::NormalEstimation<pcl::PointXYZ, pcl::Normal> normal_estimation;
  pcl::PrincipalCurvaturesEstimation<pcl::PointXYZ, pcl::Normal, pcl::PrincipalCurvatures>
      curvature_estimation;
  pcl::PointCloud<pcl::PrincipalCurvatures> curvatures;
  normal_estimation.setInputCloud(cloud);
  normal_estimation.setSearchMethod(tree);
  curvature_estimation.setInputCloud(cloud);
  curvature_estimation.setSearchMethod(tree);
  if (radius_mm > 0) {
    normal_estimation.setRadiusSearch(static_cast<double>(radius_mm));
    curvature_estimation.setRadiusSearch(static_cast<double>(radius_mm));
  } else {
    normal_estimation.setKSearch(static_cast<int>(neighbours));
    curvature_estimation.setKSearch(static_cast<int>(neighbours));
  }
  normal_estimation.compute(*normals);
  curvature_estimation.setInputNormals(normals);
  curvature_estimation.compute(curvatures);
  Values values;
  values.mean_per_mm.reserve(points.size());
  values.gaussian_per_mm2.reserve(points.size());
  for (const pcl::PrincipalCurvatures& c : curvatures) {
    values.mean_per_mm.push_back(0.5F * (c.pc1 + c.pc2));
    values.gaussian_per_mm2.push_back(c.pc1 * c.pc2);
  }
  return values;
}

}  // namespace biteline::bench::peers

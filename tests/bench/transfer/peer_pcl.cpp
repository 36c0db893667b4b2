// SPDX-License-Identifier: MIT
#include <pcl/features/normal_3d.h>
#include <pcl/filters/voxel_grid.h>
#include <pcl/registration/icp.h>
#include <pcl/search/kdtree.h>

#include "tests/bench/transfer/peers.hpp"

namespace biteline::bench::peers {
namespace {

using Cloud = pcl::PointCloud<pcl::PointNormal>;

Cloud::Ptr prepared(std::span<const Eigen::Vector3f> points, float voxel_mm) {
  pcl::PointCloud<pcl::PointXYZ>::Ptr all{new pcl::PointCloud<pcl::PointXYZ>},
      thin{new pcl::PointCloud<pcl::PointXYZ>};
  all->reserve(points.size());
  for (const Eigen::Vector3f& p : points) all->push_back({p.x(), p.y(), p.z()});
  pcl::VoxelGrid<pcl::PointXYZ> grid;
  grid.setLeafSize(voxel_mm, voxel_mm, voxel_mm);
  grid.setInputCloud(all);
  grid.filter(*thin);
  pcl::NormalEstimation<pcl::PointXYZ, pcl::PointNormal> normals;
  normals.setInputCloud(thin);
  normals.setSearchMethod(pcl::search::KdTree<pcl::PointXYZ>::Ptr{new pcl::search::KdTree<pcl::PointXYZ>});
  normals.setKSearch(20);
  Cloud::Ptr cloud{new Cloud};
  normals.compute(*cloud);
  for (std::size_t i = 0; i < thin->size(); ++i) (*cloud)[i].getVector3fMap() = (*thin)[i].getVector3fMap();
  return cloud;
}

}  // namespace

bool has_pcl() {
  return true;
}

Eigen::Isometry3d pcl_align(const Problem& problem) {
  pcl::IterativeClosestPointWithNormals<pcl::PointNormal, pcl::PointNormal> icp;
  icp.setInputSource(prepared(problem.source, problem.voxel_mm));
  icp.setInputTarget(prepared(problem.target, problem.voxel_mm));
  icp.setMaxCorrespondenceDistance(problem.reach_mm);
  icp.setMaximumIterations(problem.max_iterations);
  icp.setTransformationEpsilon(1e-9);
  Cloud aligned;
  icp.align(aligned);
  Eigen::Isometry3d T;
  T.matrix() = icp.getFinalTransformation().cast<double>();
  return T;
}

}  // namespace biteline::bench::peers

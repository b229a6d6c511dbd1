// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <span>
#include <string>

#include "slamdb/model/rigid.h"

// Which numbers of another program's file can be a pose, a point or a camera: the rule of all importers. A file that
// has others is damaged; its reader says where.
//
// Each function tells why numbers are none, and the likely cause, as the end of an error; an empty text: they are one.
namespace slamdb::detail {

// Finite, and no farther than distances in 32-bit floats can be counted.
std::string WhyNoPosition(const Eigen::Vector3d& position);

// A quaternion of any length that is not about 0: programs make it 1 when they load it. A matrix must be a rotation.
std::string WhyNoPose(const Eigen::Quaterniond& rotation, const Eigen::Vector3d& position);
std::string WhyNoPose(const Eigen::Matrix3d& rotation, const Eigen::Vector3d& position);

// Of a similarity: above 0.
std::string WhyNoScale(double scale);

// Focal lengths above 0; the principal point, distortion and what else there is finite.
std::string WhyNoCamera(double fx, double fy, std::span<const double> others);
// The same, where zeros alone stand for a camera that nobody knows.
std::string WhyNoCameraOrNone(double fx, double fy, std::span<const double> others);
// Pixels.
std::string WhyNoImageSize(double width, double height);

// What is a pose as atlases record it. A quaternion keeps its bits where its length is 1.
Rigid3f PoseOf(const Eigen::Quaterniond& rotation, const Eigen::Vector3d& translation);
Rigid3f PoseOf(const Eigen::Matrix3d& rotation, const Eigen::Vector3d& translation);

}  // namespace slamdb::detail

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <string>

#include "slamdb/base/atomic_folder.h"
#include "slamdb/formats/colmap/detail/models.h"
#include "slamdb/pictures/color_picture.h"

// What scenes for training have in common: pictures, and points coloured by them.
namespace slamdb::splats {

// One map, with the pictures that its keyframes were made of.
struct Scene {
  colmap::MapOutline outline;
  colmap::Model model;
  std::string folder;        // in the output: empty, or `1/`
  std::size_t left_out = 0;  // images without a picture
};

// Takes what a picture makes, in the order of the views.
struct Developed {
  std::string name, bytes;  // of a file to be written; no bytes: none
};

// Reads the pictures of a scene, several at a time, colours the model's points by them, and gives each, with its view,
// to `develop`, whose result `take` gets in order. Colours are means over all views; points that no picture shows stay
// grey.
//
// Throws Error as ReadColorPicture does, and kNotPossible for a picture of another size than the camera has.
void ShowPictures(
    const colmap::Outline& outline, Scene& scene, const WriteOptions& options,
    const std::function<Developed(const colmap::View&, const std::string& bytes, const ColorPicture&)>& develop,
    const std::function<void(Developed)>& take);

// Points as a PLY file of the kind that trainers read: x y z, normals of zero, red green blue; each turned by `turn`.
std::string PlyOf(const colmap::Model& model, const Eigen::Matrix3d& turn);

// The scenes of an atlas: the one map in the folder itself, several in folders `0`, `1`, ... Where pictures were named,
// images without one are left out.
std::vector<Scene> ScenesOf(const colmap::Outline& outline, const WriteOptions& options, colmap::Unheld& unheld);

// Says how many keyframes and points were written, and warns of those left out and where there are no pictures.
void Tell(const std::vector<Scene>& scenes, const colmap::Outline& outline, const colmap::Unheld& unheld,
          Notices& notices);

}  // namespace slamdb::splats

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "slamdb/plot/detail/axis.h"
#include "slamdb/plot/detail/scene.h"
#include "slamdb/plot/detail/view.h"

// The other plots, a function and a file each. Every one fills the box that it is given.
namespace slamdb::plot {

// How many things fall into each bin of equal width, map by map.
struct Histogram {
  double first = 0, width = 1;                     // of the bins
  std::vector<std::vector<std::uint64_t>> counts;  // [map][bin]
  bool open = false;                               // the last bin holds what is beyond it, too

  std::size_t bins() const { return counts.empty() ? 0 : counts.front().size(); }
};

// Good points by how many keyframes observe them: bin i holds those of i, the last those of more.
Histogram TrackHistogram(const Scene& scene);
void DrawTracks(Canvas& canvas, const Scene& scene, const Box& box);

// Good keyframes by how many good points they observe.
Histogram ObservationHistogram(const Scene& scene);
void DrawObservations(Canvas& canvas, const Scene& scene, const Box& box);

void DrawCovisibility(Canvas& canvas, const Scene& scene, const Box& box);

void DrawReprojectionImage(Canvas& canvas, const Scene& scene, const ImageErrors& errors, const Box& box);
void DrawReprojectionHistogram(Canvas& canvas, const Scene& scene, const ImageErrors& errors, const Box& box);
double HeightOfReprojection(const Scene& scene, double width);
void DrawReprojection(Canvas& canvas, const Scene& scene, const Box& box);

double HeightOfTimeline(const Scene& scene);
void DrawTimeline(Canvas& canvas, const Scene& scene, const Box& box);

// The trajectory of each map, laid onto the reference of the options where there is one.
// Throws Error (kNotPossible) when none can be.
void DrawTrajectory(Canvas& canvas, const Scene& scene, const Box& box);
double HeightOfTrajectory(const Scene& scene, double width);
// `rmse 0.0176 m`, of each map where there are several; empty without a reference.
std::string ErrorText(const Scene& scene);

// What the plan shows is counted.
ViewCounts DrawOverview(Canvas& canvas, const Scene& scene, const Box& box);
double HeightOfOverview(const Scene& scene, double width);

// Bars of a histogram, those of maps on top of each other.
void DrawBars(Canvas& canvas, const Scene& scene, const Diagram& diagram, const Histogram& histogram);
// The highest bar.
std::uint64_t Tallest(const Histogram& histogram);
// An upright line with its name.
void DrawMark(Canvas& canvas, const Theme& theme, const Diagram& diagram, double at, const std::string& name);

}  // namespace slamdb::plot

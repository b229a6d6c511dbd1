// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

// What is measured, one thing at a time, each in a process of its own: nothing is warm but the page cache.
namespace slamdb::bench {

struct Sample {
  double seconds = 0;
  double peak_megabytes = 0;  // of anonymous memory, where it is sampled
};

// Where a measurement finds its input and leaves its output. Prepare() makes all of them from one .osa file.
struct Workplace {
  std::string folder;
  std::string name;
  std::string slamdb;  // the command

  std::string binary() const { return Path(".osa"); }
  std::string other() const { return Path(".other.osa"); }  // the same with one time changed: another session
  std::string text() const { return Path(".text.osa"); }
  std::string store() const { return Path(".db"); }
  std::string output() const { return Path(".out"); }
  std::vector<std::string> inputs() const { return {binary(), other(), text(), store()}; }

 private:
  std::string Path(std::string_view suffix) const { return folder + "/" + name + std::string(suffix); }
};

enum class FromFile { kNo, kYes };

struct Measurement {
  std::string_view id;
  Sample (*run)(const Workplace&);
  FromFile from_file = FromFile::kNo;  // what is measured reads a file, so that it matters whether that is in memory
};

// Ours, on every core that the process may use; references.h has what they are held against.
std::span<const Measurement> Measurements();
const Measurement& MeasurementById(std::string_view id);  // of both; throws Error

// Writes the binary form of the atlas, twice, and its text and store form. They hold what stock Boost can read, so
// without the nan and inf of uninitialised members.
void Prepare(const std::string& atlas, const Workplace& workplace);

// Writes a synthetic RGB-D atlas of about that size (1000 features a keyframe) as .osa. With `points` other than 0 it
// has that many map points, whatever its size.
void Synthesize(double megabytes, std::size_t points, const std::string& path);

}  // namespace slamdb::bench

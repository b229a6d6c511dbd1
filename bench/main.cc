// SPDX-License-Identifier: BSD-3-Clause
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <map>
#include <set>
#include <sstream>

#include "bench/machine.h"
#include "bench/measure.h"
#include "bench/process.h"
#include "bench/references.h"
#include "bench/rounds.h"
#include "slamdb/base/error.h"

// The benchmark: starts itself once for each measurement, see rounds.h, and prints a Markdown table.
namespace {

using namespace slamdb::bench;  // NOLINT(google-build-using-namespace): this is its program

constexpr const char* kUsage =
    "usage: slamdb_bench [options] [ATLAS.osa ...]\n"
    "  --sizes MB,MB,...  also synthetic RGB-D atlases of these sizes, e.g. 50,200,500\n"
    "  --points N         also a synthetic atlas with N map points, e.g. 1000000\n"
    "  --rounds N         pairs per row (default 15)\n"
    "  --cores one|all    each row on one core, or on all that there are (default: both)\n"
    "  --cold             rows that read files also with these out of memory\n"
    "  --only ID,ID,...   rows whose measurement is one of these, e.g. read-binary,check\n"
    "  --slamdb FILE      the command (default: beside the folder of this program)\n"
    "  --folder DIR       where the files go that are measured (default: a new one in the temporary folder)\n"
    "  --keep             leave them there\n"
    "  --list             print the measurements\n";

struct Arguments {
  std::map<std::string, std::string> options;  // by name; flags are empty
  std::vector<std::string> atlases;

  bool Has(const std::string& option) const { return options.contains(option); }
  std::string Get(const std::string& option, const std::string& otherwise = {}) const {
    const auto found = options.find(option);
    return found == options.end() ? otherwise : found->second;
  }
  std::vector<std::string> List(const std::string& option) const {
    std::vector<std::string> parts;
    std::istringstream stream(Get(option));
    for (std::string part; std::getline(stream, part, ',');) parts.push_back(part);
    return parts;
  }
};

Arguments Parse(int count, char** values) {
  static const std::set<std::string> kFlags = {"--keep", "--list", "--cold"};
  static const std::set<std::string> kOptions = {"--sizes",   "--points",  "--rounds",    "--only",
                                                 "--cores",   "--slamdb",  "--folder",    "--name",
                                                 "--measure", "--prepare", "--synthesize"};
  Arguments arguments;
  for (int i = 1; i < count; ++i) {
    const std::string option = values[i];
    if (kFlags.contains(option)) {
      arguments.options[option];
    } else if (kOptions.contains(option) && i + 1 < count) {
      arguments.options[option] = values[++i];
    } else if (option.starts_with("-")) {
      throw slamdb::Error(slamdb::ErrorKind::kUsage, "unknown option or no value: " + option + "\n" + kUsage);
    } else {
      arguments.atlases.push_back(option);
    }
  }
  return arguments;
}

// What the fresh processes do. False: this is not one.
bool RunChild(const Arguments& arguments) {
  const Workplace workplace{arguments.Get("--folder"), arguments.Get("--name"), arguments.Get("--slamdb")};
  if (arguments.Has("--measure")) {
    const Sample sample = MeasurementById(arguments.Get("--measure")).run(workplace);
    std::printf("%.9f %.3f\n", sample.seconds, sample.peak_megabytes);
  } else if (arguments.Has("--prepare")) {
    Prepare(arguments.Get("--prepare"), workplace);
  } else if (arguments.Has("--synthesize")) {
    Synthesize(std::strtod(arguments.Get("--sizes").c_str(), nullptr),
               std::strtoull(arguments.Get("--points").c_str(), nullptr, 10), arguments.Get("--synthesize"));
  } else {
    return false;
  }
  std::fflush(stdout);
  return true;
}

class Benchmark {
 public:
  explicit Benchmark(const Arguments& arguments)
      : arguments_(arguments), program_(std::filesystem::read_symlink("/proc/self/exe")), folder_(Folder(arguments)) {
    std::filesystem::create_directories(folder_);
  }

  void Run() {
    PrintMachine(folder_, std::cout);
    PrintTableHead(std::cout);
    for (const std::string& atlas : arguments_.atlases) Measure(atlas, std::filesystem::path(atlas).stem().string());
    for (const std::string& size : arguments_.List("--sizes")) MeasureSynthetic(size, "0", "synthetic_" + size + "MB");
    if (arguments_.Has("--points")) {
      const std::string points = arguments_.Get("--points");
      const std::string megabytes = std::to_string(std::strtod(points.c_str(), nullptr) * 1e-3);  // as a usual atlas
      MeasureSynthetic(megabytes, points, "synthetic_" + points + "_points");
    }
    if (!arguments_.Has("--folder") && !arguments_.Has("--keep")) std::filesystem::remove_all(folder_);
  }

 private:
  static std::string Folder(const Arguments& arguments) {
    const auto own = std::filesystem::temp_directory_path() / ("slamdb_bench_" + std::to_string(getpid()));
    return arguments.Get("--folder", own.string());
  }

  static std::string SlamdbBeside(const std::filesystem::path& program) {
    return program.parent_path().parent_path() / "slamdb";
  }

  RoundOptions Rounds() const {
    RoundOptions options{.program = program_, .only = arguments_.List("--only"), .cold = arguments_.Has("--cold")};
    if (arguments_.Has("--rounds")) options.rounds = std::max(1, std::atoi(arguments_.Get("--rounds").c_str()));
    const std::string cores = arguments_.Get("--cores", "both");
    if (cores == "one") options.cores = {Cores::kOne};
    if (cores == "all") options.cores = {Cores::kAll};
    return options;
  }

  void Measure(const std::string& atlas, const std::string& name) const {
    const Workplace workplace{folder_, name, arguments_.Get("--slamdb", SlamdbBeside(program_))};
    RunProgram({program_, "--prepare", atlas, "--folder", folder_, "--name", name});
    MeasureRows(workplace, Rounds(), std::cout);
    if (arguments_.Has("--keep")) return;
    std::filesystem::remove(workplace.output());
    for (const std::string& path : workplace.inputs())
      for (const char* beside : {"", "-wal", "-shm"}) std::filesystem::remove(path + beside);
  }

  void MeasureSynthetic(const std::string& megabytes, const std::string& points, const std::string& name) const {
    const std::string atlas = folder_ + "/" + name + ".synthetic.osa";
    RunProgram({program_, "--synthesize", atlas, "--sizes", megabytes, "--points", points});
    Measure(atlas, name);
    if (!arguments_.Has("--keep")) std::filesystem::remove(atlas);
  }

  const Arguments& arguments_;
  const std::string program_, folder_;
};

void RunParent(const Arguments& arguments) {
  if (arguments.Has("--list")) {
    for (const auto& measurements : {Measurements(), References()})
      for (const Measurement& measurement : measurements) std::cout << measurement.id << "\n";
  } else if (arguments.atlases.empty() && !arguments.Has("--sizes") && !arguments.Has("--points")) {
    std::cout << kUsage;
  } else {
    Benchmark(arguments).Run();
  }
}

}  // namespace

int main(int count, char** values) {
  try {
    const Arguments arguments = Parse(count, values);
    if (RunChild(arguments)) _exit(0);  // tearing down is not measured, so it need not be waited for
    RunParent(arguments);
    return 0;
  } catch (const std::exception& error) {
    std::cerr << "slamdb_bench: " << error.what() << "\n";
    return 1;
  }
}

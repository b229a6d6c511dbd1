// SPDX-License-Identifier: BSD-3-Clause
// Runs every example that the help of a verb gives, in a folder that has the files they speak of.
#include <gmock/gmock.h>

#include <array>
#include <map>
#include <regex>
#include <set>
#include <sstream>

#include "slamdb/optimize/bundle_adjustment.h"
#include "slamdb/view/page.h"
#include "tests/support/cli.h"

namespace slamdb::testing {
namespace {

namespace fs = std::filesystem;

// What makes the files that examples read. An example that reads any other fails: it needs a line here.
constexpr std::array kWorld = {
    "slamdb synthesize lab.osa --sensor stereo --keyframes 100 --points 5000 --features 400 -q",
    "slamdb synthesize mono.osa --keyframes 30 -q",
    "slamdb synthesize atlas.osa --maps 3 --keyframes 24 -q",
    "slamdb synthesize two_maps.osa --sensor stereo --maps 2 --keyframes 50 -q",
    "slamdb merge atlas.osa mono.osa -o merged.osa -q",
    "slamdb synthesize yesterday.osa --sensor fisheye --keyframes 12 --points 400 -q",
    "ln -s $FIXTURES/session_small_a/session_small_a.osa session_a.osa",
    "ln -s $FIXTURES/session_small_b/session_small_b.osa session_b.osa",
    "for name in session a before; do ln -s session_a.osa $name.osa; done",
    "for name in b robot1 robot2; do ln -s session_b.osa $name.osa; done",
    "ln -s $FIXTURES/mono_small_twice/mono_small_twice.osa saved_twice.osa",
    "slamdb cull session_a.osa after.osa -q",
    "slamdb renumber a.osa renumbered.osa --offset 100 -q",
    "ln -s a.osa there_and_back.osa",
    "mkdir maps && cp lab.osa mono.osa maps",
    "head -c 2000000 session_a.osa >cut.osa",
    "head -c 1000000 yesterday.osa >fisheye_cut.osa",
    "for name in b session_a map old lab; do slamdb convert lab.osa lab.db#$name -q; done; slamdb convert atlas.osa "
    "lab.db#a -q",
    "for seed in 1 2; do slamdb synthesize robot.osa --keyframes 6 --points 200 --seed $seed -O -q; slamdb convert "
    "robot.osa "
    "fleet.db#robot7 -O -q; done",
    "slamdb convert session_a.osa lab.db#monday -q; slamdb convert "
    "session_b.osa lab.db#tuesday -q",
    "cp lab.db lab-backup.db && cp lab.db damaged.db && printf damage | dd of=damaged.db bs=1 "
    "seek=200000 conv=notrunc status=none",
    "slamdb convert mono.osa ground_truth.txt --to tum -q",
    "slamdb convert lab.osa lab.txt --to tum -q",
    "(echo time,latitude,longitude,altitude; awk '{printf \"%s,%.9f,%.9f,%.3f\\n\", $1, 47 + $4 / 111195, 8 + $2 / "
    "75000, 400 - $3}' lab.txt) >gps.csv",
    "echo 1 0 0 0 0 0 1 >b_in_a.txt",
    "for days in start:0,1,2,3,4 monday:0,1,2,3,4,5,6,7 tuesday:0,1,2,3,4,8,9; do slamdb extract lab.osa "
    "${days%:*}.osa --keyframe ${days#*:} -q; done",
    "slamdb merge --base start.osa monday.osa tuesday.osa -o both.osa --json >merge.json",
    "printf 'first,second,tx,ty,tz,qx,qy,qz,qw\\n0,2,-0.1,-0.05,0.2,0,0,0,1\\n' >loops.csv",
    "cp $FIXTURES/vocabulary/small.txt ORBvoc.txt; cp ORBvoc.txt smaller.txt",
    "slamdb vocabulary recompute saved_twice.osa crashed.osa --vocabulary ORBvoc.txt -q",
    "slamdb vocabulary recompute session_a.osa known.osa --vocabulary ORBvoc.txt -q",
    "cp known.osa flipped.osa && printf x | dd of=flipped.osa bs=1 seek=900000 conv=notrunc status=none",
    "slamdb landmarks from-points session_a.osa landmarks.mrpt -q",
    "slamdb renumber session_a.osa dense.osa --id-map ids.csv -q",
    "slamdb convert session_a.osa keyframes.csv --to csv-keyframes -q",
    "slamdb convert lab.osa points.csv -q; slamdb convert lab.osa poses.keyframes.csv -q",
    "(printf 'P5\\n640 480\\n255\\n'; head -c 307200 /dev/zero) >frame.png; mkdir frames && cp frame.png frames",
    "printf 'Camera1.%s: 400\\n' fx fy cx cy >camera.yaml",
    "slamdb convert session_a.osa fork.osa --to-layout visible-found -q; slamdb layouts show visible-found >fork.json",
    "mkdir ORB_SLAM3_FORK && for class in Atlas Map KeyFrame MapPoint; do echo \"class $class { int a; "
    "template <class A> void serialize(A& ar, unsigned) { ar & a; } };\"; done >ORB_SLAM3_FORK/Map.h && echo "
    "'void Save(Atlas* a, Map* m, KeyFrame* k, MapPoint* p) { boost::archive::binary_oarchive oa(f); oa << a << m << k "
    "<< p; "
    "}' >>ORB_SLAM3_FORK/Map.h",
    "mkdir -p parts build .zfunc .config/fish/completions disk && cp lab.db disk",
};

ProcessResult RunShell(const std::string& folder, const std::string& command) {
  return RunProgram({"bash", "-c",
                     "cd '" + folder +
                         "' && export HOME=$PWD FIXTURES='" SLAMDB_FIXTURES "' && ln -sf '" SLAMDB_COMMAND
                         "' slamdb && PATH=\"$PWD:$PATH\" && set -o pipefail && { " +
                         command + "\n} 2>&1"});
}

struct HelpExample {
  std::string verb, command;
};

std::vector<HelpExample> Examples() {
  std::vector<HelpExample> examples;
  std::istringstream help(RunSlamdb({"--help"}).out);
  bool in_list = false;
  for (std::string line; std::getline(help, line);) {
    if (line == "Look:" || line == "Common options:") in_list = line == "Look:";
    if (!in_list || line.size() < 3 || line[2] == ' ' || line[0] != ' ') continue;
    const std::string verb = line.substr(2, line.find(' ', 2) - 2);
    std::istringstream page(RunSlamdb({verb, "--help"}).out);
    for (std::string said; std::getline(page, said);)
      if (said.starts_with("  $ ")) examples.push_back({verb, said.substr(4)});
  }
  return examples;
}

// What an example would write stands in the folder already where another one reads it: it makes room.
bool MakeRoom(const std::string& folder, const std::string& said) {
  static const std::regex file("error: (.*): (?:is there|exists) already"),
      row("error: (.*): holds an atlas named '(.*)' already");
  std::smatch match;
  if (std::regex_search(said, match, row))
    return RunShell(folder, "slamdb remove '" + match.str(1) + "#" + match.str(2) + "'").exit_code == 0;
  return std::regex_search(said, match, file) && fs::remove(folder + "/" + match.str(1));
}

TEST(HelpExamples, Run) {
  const TemporaryFolder world, folder;
  for (const char* command : kWorld) {
    const ProcessResult result = RunShell(world.path().string(), command);
    ASSERT_EQ(result.exit_code, 0) << command << "\n" << result.out;
  }
  const std::vector<HelpExample> examples = Examples();
  EXPECT_GT(examples.size(), 80U);
  const bool has_jq = RunProgram({"jq", "--version"}).exit_code == 0;
  int number = 0;
  for (const HelpExample& example : examples) {
    if (example.verb == "view" && !HasViewPage()) continue;      // built without esbuild
    if (example.verb == "optimize" && !CanOptimize()) continue;  // built without Ceres
    if (example.verb == "fleet") continue;  // needs servers: tests/formats/postgresql/fleet_test.cc
    const std::string place = folder.Path(std::to_string(number++));
    // Links to what only writing in place would change, and copies of stores.
    ASSERT_EQ(RunShell(world.path().string(), "cp -al . '" + place +
                                                  "' && find . -name '*.db' -exec cp --remove-destination '{}' '" +
                                                  place + "/{}' ';'")
                  .exit_code,
              0);
    std::string command = std::regex_replace(example.command, std::regex("/mnt/disk"), "disk");
    if (!has_jq) command = command.substr(0, command.find(" | jq"));
    if (command.find("man -l") != std::string::npos) command = command.substr(0, command.find(" | man"));
    ProcessResult result = RunShell(place, command);
    while (result.exit_code != 0 && MakeRoom(place, result.out)) result = RunShell(place, command);
    const bool judges = std::set<std::string_view>{"check", "diff", "locate", "report"}.contains(example.verb) ||
                        command.find("verify") != std::string::npos;
    EXPECT_TRUE(result.exit_code == 0 || result.exit_code == 3 || (judges && result.exit_code == 1))
        << "exit status " << result.exit_code << " of: " << example.command << "\n"
        << result.out;
    fs::remove_all(place);
  }
}

}  // namespace
}  // namespace slamdb::testing

// SPDX-License-Identifier: BSD-3-Clause
// keep_atlas ATLAS STORE: opens an atlas that ORB-SLAM3 saved, checks it, keeps it in a store, and reads part of it
// back.
#include <cstdio>
#include <exception>

#include "slamdb/checks/check.h"
#include "slamdb/formats/formats.h"
#include "slamdb/formats/store/store.h"

namespace {

void KeepAtlas(const char* atlas_path, const char* store_path) {
  const slamdb::Atlas atlas = slamdb::ReadAtlas(atlas_path);
  for (const slamdb::Map& map : atlas.maps)
    std::printf("%s: %zu keyframes, %zu map points\n", ToString(map.id).c_str(), map.keyframes.size(),
                map.points.size());

  const slamdb::CheckReport report = slamdb::CheckAtlas(atlas, {});
  for (const slamdb::RuleResult& result : report.results)
    if (result.severity == slamdb::Severity::kError)
      std::printf("%s: %llu findings\n", result.id.c_str(), static_cast<unsigned long long>(result.count));
  std::puts(report.ok() ? "sound" : "not sound: ORB-SLAM3 may crash on it");

  slamdb::Store store = slamdb::Store::OpenForWriting(store_path);
  const slamdb::SaveReport saved = store.Save("lab", atlas, {.provenance = "keep_atlas"});
  std::printf("%llu rows written, %llu unchanged\n",
              static_cast<unsigned long long>(saved.Total().inserted + saved.Total().updated),
              static_cast<unsigned long long>(saved.Total().unchanged));

  slamdb::ReadOptions first_seconds;
  first_seconds.features = slamdb::FeatureColumns::kNone;
  first_seconds.selection.end_time = atlas.maps.front().keyframes.front().timestamp + 5;
  const slamdb::Atlas part = store.Load("lab", first_seconds);
  std::printf("%zu keyframes in the first seconds\n", part.maps.front().keyframes.size());
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) {
    std::fputs("usage: keep_atlas ATLAS STORE\n", stderr);
    return 2;
  }
  try {
    KeepAtlas(argv[1], argv[2]);
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "keep_atlas: %s\n", error.what());
    return 1;
  }
}

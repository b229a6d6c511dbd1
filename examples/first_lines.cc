// SPDX-License-Identifier: BSD-3-Clause
// first_lines ATLAS ATLAS STORE: reads two atlases, checks them, and keeps both as one in a store.
#include <iostream>

#include "slamdb/slamdb.h"

int main(int argc, char** argv) try {
  if (argc != 4) return 2;
  std::vector<slamdb::Atlas> atlases = {slamdb::ReadAtlas(argv[1]), slamdb::ReadAtlas(argv[2])};
  for (const slamdb::Atlas& atlas : atlases)
    if (!slamdb::CheckAtlas(atlas).ok()) std::cout << "ORB-SLAM3 may crash on it\n";
  const slamdb::MergeResult both = slamdb::MergeAtlases(std::move(atlases));
  slamdb::WriteAtlas(both.atlas, std::string(argv[3]) + "#both");
  std::cout << both.atlas.maps.size() << " maps kept\n";
} catch (const slamdb::Error& error) {
  std::cerr << error.what() << '\n';
  return error.kind() == slamdb::ErrorKind::kNotFound ? 4 : 1;
}

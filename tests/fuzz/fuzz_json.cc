// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/edit/ids/id_map.h"
#include "slamdb/edit/repair/journal.h"
#include "slamdb/synthetic/synthesize.h"
#include "slamdb/view/page.h"
#include "tests/fuzz/fuzz.h"
#include "tests/fuzz/require.h"

namespace slamdb {
namespace {

// The journals and ids of the seeds are of this atlas.
const Atlas& SmallAtlas() {
  static const Atlas atlas = SynthesizeAtlas({.maps = 2, .keyframes = 4, .points = 20, .features = 60, .threads = 1});
  return atlas;
}

// What can be read as a journal is read again from what is written of it, and takes edits back or refuses to.
void ReadJournal(std::string_view text) {
  const Journal journal = ParseJournal(text);
  const std::string written = ToJson(journal);
  fuzz::Require(ToJson(ParseJournal(written)) == written, "a journal that was written is read again");
  Atlas atlas = SmallAtlas();
  TakeBack(journal, atlas);
}

// And so are ids, which are given to the atlas or refused.
void ReadIdMaps(std::string_view text) {
  const std::vector<IdMap> maps = ParseIdMapsJson(text);
  fuzz::Require(ParseIdMapsJson(IdMapsToJson(maps)) == maps, "ids that were written are read again");
  Atlas atlas = SmallAtlas();
  for (const IdMap& ids : maps) ApplyIdMap(atlas, ids, 1);
}

}  // namespace
}  // namespace slamdb

// Any bytes as each kind of JSON file that slamdb reads. They are read or fail with an Error.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace slamdb;
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  fuzz::MayRefuse([&] { ReadJournal(text); });
  fuzz::MayRefuse([&] { ReadIdMaps(text); });
  fuzz::MayRefuse([&] { return ParseFindings(text); });
  return 0;
}

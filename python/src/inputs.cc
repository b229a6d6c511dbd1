// SPDX-License-Identifier: BSD-3-Clause
#include "python/src/inputs.h"

#include <algorithm>
#include <iterator>
#include <utility>

namespace slamdb::python {

std::vector<std::string> ManyInputs::Named() const {
  std::vector<std::string> named;
  for (const AtlasOrPath& source : sources) named.push_back(source.atlas ? name : source.path);
  return named;
}

AtlasInputs ManyInputs::Find() const {
  AtlasInputs found;
  for (const AtlasOrPath& source : sources) {
    if (source.atlas) {
      found.atlases.push_back({.location = Location(name), .below = {}, .failure = {}, .atlas = source.atlas});
      continue;
    }
    AtlasInputs more = FindAtlases({&source.path, 1}, options);
    std::ranges::move(more.atlases, std::back_inserter(found.atlases));
  }
  return found;
}

ManyInputs InputsOf(Arguments& given) {
  ManyInputs inputs{.sources = given.Sources("sources"), .name = given.Get<std::string>("name")};
  given.Take("recursive", inputs.options.recursive);
  given.Take("revisions", inputs.options.revisions);
  given.Take("wait", inputs.options.lock_timeout, cli::kNonNegative);
  inputs.options.progress = given.progress();
  return inputs;
}

}  // namespace slamdb::python

// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/rows/detail/find_revision.h"

namespace slamdb::rows {
namespace {

Error NotFound(RevisionCatalog& catalog, const Named& of, std::string_view which, std::string_view why = {}) {
  return NoSuchRevision(catalog.path(), of, which, catalog.Numbers(of.atlas), catalog.Tags(of.atlas), why);
}

Named FindAtlas(RevisionCatalog& catalog, std::string_view name) {
  if (std::optional<Named> named = catalog.Newest(name)) return *std::move(named);
  throw NoSuchAtlas(catalog.path(), name, catalog.Names());
}

// What stands behind the @ of an atlas.
std::int64_t NumberIn(RevisionCatalog& catalog, const Named& newest, std::string_view text) {
  const Which which = ParseWhich(text, newest.newest, catalog.path());
  if (which.kind == Which::Kind::kNumber) return which.number;
  if (which.kind == Which::Kind::kBy) {
    if (const std::optional<std::int64_t> last = catalog.LastBy(newest.atlas, which.by)) return *last;
    throw NotFound(catalog, newest, text, ": none that is left was saved by then");
  }
  if (const std::optional<std::int64_t> tagged = catalog.Tagged(newest.atlas, text)) return *tagged;
  throw NotFound(catalog, newest, text);
}

// Of an atlas, its revision of that number, which was asked for as `which`.
Named WithNumber(RevisionCatalog& catalog, Named named, std::int64_t number, std::string_view which) {
  named.number = number;
  if (!named.is_newest() && !catalog.HasNumber(named.atlas, number)) throw NotFound(catalog, named, which);
  return named;
}

}  // namespace

Named FindRevision(RevisionCatalog& catalog, std::string_view text) {
  if (std::optional<Named> whole = catalog.Newest(text)) return *std::move(whole);
  const std::optional<SplitName> split = SplitAtRevision(text);
  if (!split) throw NoSuchAtlas(catalog.path(), text, catalog.Names());
  const Named named = FindAtlas(catalog, split->name);
  return WithNumber(catalog, named, NumberIn(catalog, named, split->which), split->which);
}

Named FindRevision(RevisionCatalog& catalog, const RevisionName& revision) {
  return WithNumber(catalog, FindAtlas(catalog, revision.atlas), static_cast<std::int64_t>(revision.number),
                    std::to_string(revision.number));
}

}  // namespace slamdb::rows

// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/many/locate_in_store.h"

#include <algorithm>
#include <map>
#include <tuple>
#include <utility>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/detail/parallel.h"
#include "slamdb/base/error.h"
#include "slamdb/formats/rows/options.h"

namespace slamdb {
namespace {

using Places = std::vector<KeyFrameId>;  // the most alike first

// The pictures that look like one map, and where.
struct Question {
  std::string atlas;
  MapId map;
  std::map<std::size_t, Places> pictures;
};

std::vector<Question> QuestionsOf(const StoredPlaces& places) {
  std::map<std::pair<std::string, std::uint64_t>, Question> by_map;
  for (std::size_t picture = 0; picture < places.by_picture.size(); ++picture)
    for (const StoredPlace& place : places.by_picture[picture]) {
      Question& question = by_map[{place.atlas, place.map.value()}];
      question.atlas = place.atlas;
      question.map = place.map;
      question.pictures[picture].push_back(place.keyframe);
    }
  std::vector<Question> questions;
  for (auto& [key, question] : by_map) questions.push_back(std::move(question));
  return questions;
}

std::vector<KeyFrameRef> RowsOf(const Atlas& atlas, const Places& places) {
  std::vector<KeyFrameRef> rows;
  for (const KeyFrameId id : places)
    for (std::size_t map = 0; map < atlas.maps.size(); ++map) {
      const auto& keyframes = atlas.maps[map].keyframes;
      const auto found = std::ranges::find(keyframes, id, &KeyFrame::id);
      if (found != keyframes.end()) rows.push_back({map, static_cast<std::size_t>(found - keyframes.begin())});
    }
  return rows;
}

// By how sure it is. Inliers tell two of one verdict apart.
bool IsSurer(const AtlasLocalization& one, const AtlasLocalization& other) {
  const auto rank = [](const AtlasLocalization& each) {
    return std::tuple(each.localization.verdict, -static_cast<std::int64_t>(each.localization.evidence.inliers));
  };
  return rank(one) < rank(other);
}

// What a map answers, by picture in the order of the question.
std::vector<Localization> Ask(Store& store, const Question& question, const FeaturesFor& features_for,
                              const LocateInStoreOptions& options) {
  ReadOptions read;
  read.selection.map = question.map;
  read.threads = options.threads;
  const Atlas atlas = store.Load(question.atlas, read.With(StoreReadOptions{.lock_timeout = options.lock_timeout}));
  const Locator locator(atlas, {.places_are_known = true, .threads = options.threads, .progress = {}});
  const std::vector<std::pair<std::size_t, Places>> pictures(question.pictures.begin(), question.pictures.end());
  std::vector<Localization> answers(pictures.size());
  detail::ParallelFor(pictures.size(), 1, options.threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const auto& [picture, places] = pictures[i];
      const std::optional<PictureFeatures> features = features_for(picture, atlas);
      if (features)
        answers[i] = locator.LocateAt(*features, RowsOf(atlas, places));
      else
        answers[i].reason = "the map's camera takes pictures of another size";
    }
  });
  return answers;
}

void Add(std::vector<AtlasLocalization>& answers, AtlasLocalization answer) {
  const auto known = std::ranges::find(answers, answer.atlas, &AtlasLocalization::atlas);
  if (known == answers.end())
    answers.push_back(std::move(answer));
  else if (IsSurer(answer, *known))
    *known = std::move(answer);
}

}  // namespace

LocatedInStore LocateInStore(Store& store, std::span<const PictureFeatures> looks, const FeaturesFor& features_for,
                             const LocateInStoreOptions& options) {
  std::vector<std::span<const Descriptor>> descriptors;
  for (const PictureFeatures& picture : looks) descriptors.emplace_back(picture.descriptors);
  const StoredPlaces places = store.PlacesLike(descriptors, {.without = {}, .threads = options.threads});
  LocatedInStore located;
  located.pictures.resize(looks.size());
  for (const std::string& atlas : places.unknown)
    located.not_asked.push_back(detail::Concat(
        atlas, ": the store does not know what all its keyframes look like; save it again, or check it for damage"));
  for (const std::string& atlas : places.unreachable)
    located.not_asked.push_back(
        detail::Concat(atlas, ": its server does not answer; 'slamdb fleet status' tells more"));
  const std::vector<Question> questions = QuestionsOf(places);
  for (std::size_t i = 0; i < questions.size(); ++i) {
    const Question& question = questions[i];
    if (options.progress)
      options.progress("asking " + question.atlas, static_cast<double>(i) / static_cast<double>(questions.size()));
    try {
      std::vector<Localization> answers = Ask(store, question, features_for, options);
      std::size_t next = 0;
      for (const auto& [picture, where] : question.pictures)
        Add(located.pictures[picture], {question.atlas, std::move(answers[next++])});
    } catch (const Error& error) {
      if (error.kind() != ErrorKind::kDamaged && error.kind() != ErrorKind::kNotFound) throw;
      located.not_asked.push_back(detail::Concat(question.atlas, ": ", error.what()));
    }
  }
  for (std::vector<AtlasLocalization>& answers : located.pictures) std::ranges::stable_sort(answers, IsSurer);
  return located;
}

}  // namespace slamdb

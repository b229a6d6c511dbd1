// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/dbow2/vocabulary.h"

#include "python/src/module.h"
#include "python/src/verb.h"
#include "slamdb/edit/words/words.h"
#include "slamdb/formats/vocabularies.h"

// The vocabulary that an atlas was made with. slamdb/vocabulary.py documents what is here.
namespace slamdb::python {

namespace py = pybind11;

namespace {

void DefineRecompute(py::module_& module) {
  DefineChange(module, "vocabulary_recompute", [](Arguments& given) {
    RecomputeWordsOptions options;
    given.Take("missing", options.only_missing);
    given.TakeRun(options);
    return [options, path = given.Path("vocabulary")](Atlas& atlas, Notices&) {
      const LoadedVocabulary vocabulary = LoadVocabulary(path, options.threads);
      return ToJson(RecomputeWords(atlas, vocabulary.tree, vocabulary.identity, options));
    };
  });
}

void DefineSet(py::module_& module) {
  DefineChange(module, "vocabulary_set", [](Arguments& given) {
    StampOptions options{.vocabulary = given.Path("vocabulary")};
    given.Take("name", options.name);
    given.Take("checksum", options.checksum);
    given.Take("force", options.force);
    return [options](Atlas& atlas, Notices&) {
      StampVocabulary(atlas, options);
      return std::string("null");
    };
  });
}

void DefineShow(py::module_& module) {
  DefineReport(module, "vocabulary_show", [](Arguments& given) {
    return [paths = given.Get<std::vector<std::string>>("paths"), threads = given.threads()](Notices& notices) {
      std::vector<ShownVocabulary> shown;
      for (const std::string& path : paths) shown.push_back(ShowVocabulary(path, {.threads = threads}, notices));
      return ToJson(shown);
    };
  });
}

void DefineMismatch(py::module_& module) {
  DefineReport(module, "vocabulary_mismatch", [](Arguments& given) {
    return [source = given.SourceAt("source"), path = given.Path("vocabulary")](Notices& notices) {
      return VocabularyMismatch(Hold(source, {}, notices)->vocabulary, ReadVocabularyIdentity(path));
    };
  });
}

}  // namespace

void DefineVocabulary(py::module_& module) {
  DefineRecompute(module);
  DefineSet(module);
  DefineShow(module);
  DefineMismatch(module);
}

}  // namespace slamdb::python

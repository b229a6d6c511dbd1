// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "cli/commands/commands.h"
#include "cli/edit.h"
#include "cli/exports.h"
#include "cli/guard.h"
#include "cli/libraries.h"
#include "cli/options.h"
#include "cli/report/align_text.h"
#include "cli/whole_store.h"
#include "slamdb/align/align_all.h"
#include "slamdb/align/report_json.h"
#include "slamdb/base/atomic_file.h"
#include "slamdb/base/error.h"
#include "slamdb/edit/frame/similarity_text.h"
#include "slamdb/formats/formats.h"
#include "slamdb/many/maps_to_align.h"
#include "slamdb/plot/alignment.h"

namespace slamdb::cli {
namespace {

struct AlignVerbOptions {
  std::vector<std::string> inputs;
  InputFormat from;
  std::string save, plot;
  bool own_vocabulary = false, overwrite = false, json = false;
  double wait = kUsualWait;
};

MapsToAlign ReadMaps(const AlignVerbOptions& options, Console& console, Notices& notices) {
  MapsToAlign given;
  std::optional<Store> store;
  for (const std::string& input : options.inputs) {
    if (std::optional<Store> whole = OpenWholeStore(input, options.from, options.wait)) {
      if (store) RefuseUsage("one store is searched; of " + input + " name the atlases, as " + input + "#NAME");
      store = std::move(whole);
      continue;
    }
    given.Add(std::make_shared<const Atlas>(
                  ReadAtlas(Location(input), MakeReadOptions(console, options.from, options.wait), &notices)),
              input);
  }
  if (store) given.AddLikely(*store, options.inputs, MakeReadOptions(console, {}, options.wait), notices);
  return given;
}

void DrawLink(const AlignedMaps& aligned, const MapsToAlign& given, const AlignVerbOptions& options, AtomicFile& file) {
  const MapLink& link = aligned.links.front();
  const Plot plot =
      DrawAlignment(given.maps[link.first], given.maps[link.second], link.alignment,
                    {.format = PictureFormatOf(options.plot),
                     .title = NameText(given.names[link.second]) + " in " + NameText(given.names[link.first])});
  file.Write(plot.bytes);
  file.Commit();
}

ExitCode RunAlign(const AlignVerbOptions& options, Console& console) {
  if (!options.plot.empty()) GoOnWithLibraries();
  if (!options.plot.empty()) (void)PictureFormatOf(options.plot);
  std::optional<AtomicFile> file;
  std::optional<AtomicFile> picture;
  if (!options.plot.empty()) picture.emplace(options.plot, AtomicFileOptions{.overwrite = options.overwrite});
  if (!options.save.empty()) file.emplace(options.save, AtomicFileOptions{.overwrite = options.overwrite});
  Notices notices;
  const MapsToAlign given = ReadMaps(options, console, notices);
  if ((file || picture) && given.maps.size() != 2)
    RefuseUsage((file ? "--save" : "--plot") +
                (" is for two maps, and there are " + std::to_string(given.maps.size())));
  const AlignedMaps aligned = NamingFile(options.inputs.front(), [&] {
    return given.Align(
        {.own_vocabulary = options.own_vocabulary, .threads = console.threads(), .progress = console.MakeProgress()});
  });
  const bool sure = given.AreSure(aligned);
  const bool drawn = picture && aligned.links.front().alignment.first_from_second.has_value();
  if (file && sure) {
    file->Write(ToText(*aligned.links.front().alignment.first_from_second) + "\n");
    file->Commit();
  }
  if (drawn) DrawLink(aligned, given, options, *picture);
  if (file && !sure) notices.Warn("the maps are not aligned for sure: " + options.save + " is not written");
  if (picture && !drawn) notices.Warn("there is nothing to draw: " + options.plot + " is not written");
  console.Report(notices);
  const std::string text =
      AlignText(aligned, given.names, given.metric) + (given.store ? UnlikeText(*given.store) : "");
  PrintReport(options.json ? given.ToJson(aligned) : text, options.json,
              (file && IsStandardOutput(options.save)) || (picture && IsStandardOutput(options.plot)), console);
  if (file && sure && !options.json) console.PrintWritten(options.save, notices);
  if (drawn && !options.json) console.PrintWritten(options.plot, notices);
  return sure ? ExitCode::kDone : ExitCode::kFailed;
}

Run AddAlign(CLI::App& verb) {
  const auto options = std::make_shared<AlignVerbOptions>();
  verb.add_option("INPUT", options->inputs,
                  "Atlases, of which every map with keyframes is compared with every other; a store without #NAME: "
                  "those of its "
                  "maps in which something looks alike")
      ->type_name("FILE")
      ->required();
  AddFrom(verb, options->from);
  Mark(verb.add_option("--save", options->save,
                       "Write how the second of two maps lies in the first, as merge --transform takes it"),
       Writes::kFile)
      ->type_name("FILE");
  Mark(verb.add_option("--plot", options->plot,
                       "Draw how two maps lie to each other, as SVG or (.png) PNG: plans, errors, and the pair of "
                       "keyframes that agrees on most"),
       Writes::kFile)
      ->type_name("FILE");
  verb.add_flag("-O,--overwrite", options->overwrite, "Replace a file that is there");
  verb.add_flag("--own-vocabulary", options->own_vocabulary,
                "Recognise places by a vocabulary that is trained on the maps, not by the recorded words");
  AddWait(verb, options->wait);
  AddJson(verb, options->json);
  return [options](Console& console) { return RunAlign(*options, console); };
}

constexpr Example kExamples[] = {
    {"slamdb align session_a.osa session_b.osa", "How the second session lies in the first, and how sure that is."},
    {"slamdb align a.osa b.osa --save b_in_a.txt && slamdb merge a.osa b.osa -o ab.osa --join --transform b_in_a.txt",
     "Joins them by it, step by step; merge --align does it at once."},
    {"slamdb align session_b.osa lab.db",
     "Which atlases of a store the new one overlaps with, and how it lies in each."},
    {"slamdb align session_a.osa session_b.osa --json --plot b_in_a.svg",
     "The same for a script, and drawn. Of one atlas the maps inside are compared."},
};

}  // namespace

const Command kAlign = {
    .name = "align",
    .summary = "find how maps that nobody aligned lie to each other",
    .group = Group::kCombine,
    .description =
        R"(Finds where maps overlap and how they lie to each other, from what their files hold: poses, keypoints, descriptors,
bags of words, points and cameras. No pictures are needed. Places are recognised, matched and verified one by one; what many
agree on is refined, and then the pictures of each map are held against the points of the other: what they must show and do
not speaks against it, as in rooms that look alike.

A map is aligned, doubtful (something agrees, but it could be a look-alike), or there is no overlap. Of more than two maps
the surest links bring them into one frame, and the others must agree with that. Scales may differ where a map is monocular.

Of a store without #NAME the maps are compared in which something looks like the inputs, which the store tells without reading
them; the others are named.)",
    .done = "Every map could be brought into one frame; of a store: every input lies in some map of it.",
    .failed = "Some map could not be aligned with any other, or an input not be read.",
    .examples = kExamples,
    .add = AddAlign,
};

}  // namespace slamdb::cli

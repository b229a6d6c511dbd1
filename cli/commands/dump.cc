// SPDX-License-Identifier: BSD-3-Clause
#include <memory>

#include "cli/commands/commands.h"
#include "cli/options.h"
#include "slamdb/formats/formats.h"
#include "slamdb/model/content.h"

namespace slamdb::cli {
namespace {

struct DumpOptions {
  std::string input, format = "ndjson";
  InputFormat from;
  OutputOptions output;
  SelectionOptions selection;
};

ExitCode RunDump(const DumpOptions& options, Console& console) {
  ReadOptions read = MakeReadOptions(console, options.from);
  const HeldSource held = HoldInput(options.input, read);
  read.selection = ParseSelection(options.selection, held, read);
  Notices read_notices;
  const Atlas atlas = ReadAtlas(held, read, &read_notices);
  console.Report(read_notices);
  if (read.selection.has_keyframe_range() && !SubstanceOf(atlas, /*with_bad=*/true).keyframes)
    console.Warn(options.input + ": " + MissText(read.selection, held, read));
  WriteOptions write;
  write.format = options.format;
  write.overwrite = options.output.overwrite;
  write.threads = console.threads();
  write.progress = console.MakeProgress();
  // A table of points is asked for, so that it holds no poses is no loss to tell: notices are left out.
  WriteAtlas(atlas, Location(options.output.path, {}), write);
  return ExitCode::kDone;
}

Run AddDump(CLI::App& verb) {
  const auto options = std::make_shared<DumpOptions>();
  verb.add_option("FILE", options->input, AtlasAt("The atlas"))->type_name("FILE")->required();
  verb.add_option(
          "--format", options->format,
          "ndjson has one line for every entity with all its fields; csv tables have one kind each, points in csv")
      ->type_name("FORMAT")
      ->check(CLI::IsMember({"ndjson", "csv", "csv-keyframes", "csv-observations"}))
      ->capture_default_str();
  AddFrom(verb, options->from);
  AddOutput(verb, options->output);
  AddSelection(verb, options->selection);
  return [options](Console& console) { return RunDump(*options, console); };
}

constexpr Example kExamples[] = {
    {"slamdb dump lab.osa | jq 'select(.type == \"keyframe\") | .timestamp'", "One field of every keyframe."},
    {"slamdb dump lab.osa --format csv -o points.csv", "The points, for a spreadsheet or a data frame."},
    {"slamdb dump lab.db#a --keyframes 10:20", "Some keyframes of an atlas in a store, without reading the rest."},
};

}  // namespace

const Command kDump = {
    .name = "dump",
    .summary = "print a whole atlas as ndjson or csv",
    .group = Group::kLook,
    .description =
        R"(Prints everything that an atlas holds, as one JSON object per line (ndjson), or one kind of entity as a table (csv). Ids are
whole numbers of up to 64 bits. For reading and for other programs; to keep an atlas, convert it.)",
    .examples = kExamples,
    .add = AddDump,
};

}  // namespace slamdb::cli

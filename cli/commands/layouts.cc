// SPDX-License-Identifier: BSD-3-Clause
#include <memory>
#include <optional>

#include "cli/commands/commands.h"
#include "cli/edit.h"
#include "cli/options.h"
#include "cli/report/layout.h"
#include "cli/values.h"
#include "slamdb/base/atomic_file.h"
#include "slamdb/base/detail/concat.h"
#include "slamdb/base/detail/visible.h"
#include "slamdb/formats/layouts/from_source.h"
#include "slamdb/formats/layouts/layout_text.h"
#include "slamdb/formats/layouts/report.h"
#include "slamdb/formats/orbslam3/infer_layout.h"

namespace slamdb::cli {
namespace {

using detail::Concat;
using detail::Visible;

struct ListLayoutsOptions {
  bool json = false;
};

struct FindLayoutOptions {
  std::string input, output;
  std::size_t choice = 1;
  bool overwrite = false, json = false;
};

// ---- list and show

ExitCode RunListLayouts(const ListLayoutsOptions& options, Console& console) {
  if (options.json) {
    console.PrintData(ToJson(KnownLayouts()));
    return ExitCode::kDone;
  }
  Table table({Table::Align::kLeft, Table::Align::kLeft, Table::Align::kLeft});
  table.Add({"ID", "FILES WITH", "OF"});
  for (const Layout& layout : KnownLayouts()) table.Add({layout.id, layout.title, layout.who});
  console.Print(table.ToString());
  return ExitCode::kDone;
}

ExitCode RunShowLayout(const std::string& layout, Console& console) {
  console.PrintData(LayoutText(LoadLayout(layout)));
  return ExitCode::kDone;
}

// ---- What was found

// Opened before the work, so that what would fail at the end fails at once.
std::optional<AtomicFile> OpenOutput(const FindLayoutOptions& options) {
  if (options.output.empty()) return std::nullopt;
  return std::optional<AtomicFile>(std::in_place, options.output, AtomicFileOptions{.overwrite = options.overwrite});
}

std::string Listed(std::string_view title, const std::vector<std::string>& lines) {
  constexpr std::size_t kShown = 12;
  if (lines.empty()) return {};
  std::string text = Concat(title, "\n");
  for (std::size_t i = 0; i < std::min(kShown, lines.size()); ++i) text += "  " + lines[i] + "\n";
  if (lines.size() > kShown) text += "  and " + Grouped(lines.size() - kShown) + " more\n";
  return text;
}

// Writes the layout, and says what it is good for.
std::string Write(const Layout& layout, const FindLayoutOptions& options, std::optional<AtomicFile>& output,
                  bool complete = true) {
  if (!output) return {};
  output->Write(LayoutText(layout));
  output->Commit();
  if (IsStandardOutput(options.output)) return {};
  return "wrote " + Visible(options.output) +
         (complete ? ", for --layout of the other verbs\n" : ", to be completed\n");
}

template <class Report>
void Print(const std::string& text, const Report& report, const FindLayoutOptions& options, Console& console) {
  const bool piped = !options.output.empty() && IsStandardOutput(options.output);
  PrintReport(options.json ? ToJson(report, ReportFiles{options.input, options.output}) : text, options.json, piped,
              console);
}

// ---- from-source

ExitCode RunFromSource(const FindLayoutOptions& options, Console& console) {
  std::optional<AtomicFile> output = OpenOutput(options);
  const DerivedLayout derived = DeriveLayoutOfFolder(options.input);
  std::vector<std::string> questions;
  for (const LayoutQuestion& question : derived.questions) questions.push_back(ToString(question));
  const std::uint64_t unknown = CountUnknownTypes(derived.layout);
  std::string text = Counted(derived.files, "source file") + ", " +
                     Counted(derived.layout.classes.size(), "class", "classes") + " archived\n";
  text += derived.known.empty() ? "a layout that is not known\n" : "the layout " + derived.known + "\n";
  text += Listed("not understood", questions);
  if (unknown > 0)
    text += Counted(unknown, "type is", "types are") + " `?`: put in what the members are, then use the layout\n";
  text += Listed("missing", derived.missing);
  const bool complete = unknown == 0 && derived.missing.empty();
  text += Write(derived.layout, options, output, complete);
  Print(text, derived, options, console);
  return complete ? ExitCode::kDone : ExitCode::kFailed;
}

// ---- infer

// With the number by which each is chosen; that of the one that was chosen is left out.
std::vector<std::string> Numbered(std::vector<std::string> alternatives, std::size_t chosen) {
  for (std::size_t i = 0; i < alternatives.size(); ++i)
    alternatives[i] = Concat(i + 1 < chosen ? i + 1 : i + 2, ": ", alternatives[i]);
  return alternatives;
}

std::string InferredText(const InferredLayout& inferred, const FindLayoutOptions& options) {
  const std::string& id = inferred.layout.id;
  std::string text = inferred.known ? "the layout " + id + ": " + inferred.layout.title + "\n"
                                    : std::string("a layout that is not known\n");
  text += Listed("other than in v1.0", inferred.differences);
  text += Listed("could as well be, with --choose", Numbered(inferred.alternatives, options.choice));
  text += Listed("in doubt", inferred.doubts);
  text +=
      Counted(inferred.keyframes, "keyframe") + " and " + Counted(inferred.points, "point") + " are read in it, and ";
  return text + (inferred.same_bytes ? "the same bytes come of them\n" : "other bytes come of them\n");
}

ExitCode RunInfer(const FindLayoutOptions& options, Console& console) {
  std::optional<AtomicFile> output = OpenOutput(options);
  const InferredLayout inferred = InferLayout(options.input, {.choice = options.choice});
  const std::string text = InferredText(inferred, options) + Write(inferred.layout, options, output);
  Print(text, inferred, options, console);
  constexpr std::string_view kLook = "look at values that you know, with `slamdb show`, before you edit the map";
  if (!inferred.alternatives.empty()) console.Warn(Concat("other layouts fit as well: ", kLook));
  if (!inferred.doubts.empty()) console.Warn(Concat("the layout is in doubt: ", kLook));
  return inferred.same_bytes ? ExitCode::kDone : ExitCode::kFailed;
}

// ---- options

void AddLayoutOutput(CLI::App& verb, FindLayoutOptions& options) {
  Mark(verb.add_option("-o,--output", options.output, "Write the layout to this file"), Writes::kFile)
      ->type_name("FILE");
  verb.add_flag("-O,--overwrite", options.overwrite, "Replace the file if it is there");
  AddJson(verb, options.json);
}

Run BindList(CLI::App& verb) {
  const auto options = std::make_shared<ListLayoutsOptions>();
  AddJson(verb, options->json);
  return [options](Console& console) { return RunListLayouts(*options, console); };
}

Run BindShow(CLI::App& verb) {
  const auto layout = std::make_shared<std::string>();
  verb.add_option("LAYOUT", *layout, "The id of a known layout, or a file with one")->type_name("LAYOUT")->required();
  return [layout](Console& console) { return RunShowLayout(*layout, console); };
}

Run BindFromSource(CLI::App& verb) {
  const auto options = std::make_shared<FindLayoutOptions>();
  verb.add_option("DIR", options->input, "The folder with the sources of the fork")->type_name("FOLDER")->required();
  AddLayoutOutput(verb, *options);
  return [options](Console& console) { return RunFromSource(*options, console); };
}

Run BindInfer(CLI::App& verb) {
  const auto options = std::make_shared<FindLayoutOptions>();
  verb.add_option("FILE", options->input, "An .osa file of the fork")->type_name("FILE")->required();
  verb.add_option("--choose", options->choice, "Where several layouts fit, take this one of them; 1 is the likeliest")
      ->type_name("N")
      ->check(Within(kLayoutChoice));
  AddLayoutOutput(verb, *options);
  return [options](Console& console) { return RunInfer(*options, console); };
}

Run AddLayouts(CLI::App& verb) {
  verb.require_subcommand(0, 1);
  std::vector<std::pair<const CLI::App*, Run>> runs;
  const auto add = [&](const char* name, const char* summary, Run (*bind)(CLI::App&)) {
    CLI::App* inner = verb.add_subcommand(name, summary);
    runs.emplace_back(inner, bind(*inner));
  };
  add("list", "List the layouts that slamdb knows", BindList);
  add("show", "Print a layout as JSON, one member a line", BindShow);
  add("infer", "Find the layout of an .osa file", BindInfer);
  add("from-source", "Derive the layout from the serialize functions of a fork", BindFromSource);
  return [runs](Console& console) {
    for (const auto& [inner, run] : runs)
      if (inner->parsed()) return run(console);
    return RunListLayouts({}, console);
  };
}

constexpr Example kExamples[] = {
    {"slamdb layouts list", "The layouts that are read without asking."},
    {"slamdb layouts infer fork.osa -o fork.json", "The layout of a file that nobody described."},
    {"slamdb layouts from-source ORB_SLAM3_FORK -o fork.json", "The same from the sources of the program."},
    {"slamdb layouts show obvi", "A layout to begin one's own with."},
    {"slamdb info fork.osa --layout fork.json", "How a layout is used."},
};

}  // namespace

const Command kLayouts = {
    .name = "layouts",
    .summary = "find and show the layouts of forks of ORB-SLAM3",
    .group = Group::kLook,
    .description =
        R"(Forks of ORB-SLAM3 put members of their own into the .osa file, or leave some out. A layout says which, as JSON. Those
that slamdb knows are tried on every file; any other is given by --layout.

'infer' finds the layout of a file: one that is known, or the smallest change of one that explains every byte. Members that
are new are called unknown1, unknown2, and keep their bytes. It proves what it says: the file is read in the layout, and
written again. 'from-source' reads the serialize functions of the program instead, without compiling it, and asks where it
does not understand.)",
    .failed = "No layout was found, a type was not understood, or a file could not be read or written.",
    .examples = kExamples,
    .add = AddLayouts,
};

}  // namespace slamdb::cli

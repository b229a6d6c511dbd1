// SPDX-License-Identifier: BSD-3-Clause
#include "cli/options.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <memory>

#include "cli/byte_size.h"
#include "cli/exports.h"
#include "cli/help/usage.h"
#include "cli/values.h"
#include "slamdb/base/atomic_file.h"
#include "slamdb/base/detail/server.h"
#include "slamdb/base/detail/text.h"
#include "slamdb/base/error.h"
#include "slamdb/base/memory.h"
#include "slamdb/formats/formats.h"
#include "slamdb/formats/layouts/layout_text.h"
#include "slamdb/formats/orbslam3/boost_versions.h"
#include "slamdb/formats/orbslam3/options.h"
#include "slamdb/formats/rows/options.h"

namespace slamdb::cli {
namespace {

using detail::ParseNumber;

std::vector<std::string> FormatIds(bool reading) {
  std::vector<std::string> ids;
  for (const Format& format : Formats())
    if (reading ? format.read != nullptr : format.write != nullptr) ids.emplace_back(format.id);
  return ids;
}

}  // namespace

namespace {

const std::map<std::string, ColourChoice> kColourChoices = {
    {"auto", ColourChoice::kAuto}, {"always", ColourChoice::kAlways}, {"never", ColourChoice::kNever}};

// A verb with a --color of its own takes these words in it too, and sees an empty one in their place.
void AddColour(CLI::App& verb, ColourChoice& colour) {
  if (CLI::Option* own = verb.get_option_no_throw("--color")) {
    own->transform([&colour](std::string word) {
      if (word.empty()) RefuseUsage("a word is missing");
      const auto choice = kColourChoices.find(word);
      if (choice == kColourChoices.end()) return word;
      colour = choice->second;
      return std::string();
    });
    return;
  }
  verb.add_option("--color", colour, "Colours; auto: on terminals, unless NO_COLOR is set or TERM is dumb")
      ->type_name("WHEN")
      ->transform(OneOf(kColourChoices))
      ->default_str("auto")
      ->group(kCommonGroup);
}

}  // namespace

namespace {

// Of what is counted or has an id, CLI11 would take -1 for the largest number there is.
std::string CheckWhole(const std::string& text) {
  return ParseNumber<std::uint64_t>(text) ? std::string() : "expected a whole number, 0 or above, found '" + text + "'";
}

void RefuseSigns(CLI::App& verb) {
  const auto is_unsigned = [](const CLI::Option* option) {
    const std::string type = option->get_type_name();
    return type == "N" || type == "ID" || type == "ID,...";
  };
  for (CLI::Option* option : verb.get_options(is_unsigned)) option->check(CheckWhole);
}

}  // namespace

namespace {

// Of the process, whatever the verb.
void AddMemory(CLI::App& verb) {
  const auto limit = std::make_shared<MemoryLimit>();
  AddByteSize(
      verb, "--memory", kMemory,
      [limit](std::uint64_t bytes) {
        limit->bytes = bytes;
        SetMemoryLimit(*limit);
      },
      "Memory to take, such as 2GB; what is more goes to a file on disk. 0 means three quarters of what is free")
      ->group(kCommonGroup);
  verb.add_option_function<std::string>(
          "--spill",
          [limit](const std::string& folder) {
            limit->spill_folder = folder;
            SetMemoryLimit(*limit);
          },
          "Where that file is, which has no name; by default in TMPDIR, or in /var/tmp where that is not on disk")
      ->type_name("FOLDER")
      ->check([](const std::string& folder) { return folder.empty() ? "expected a folder, found ''" : ""; })
      ->group(kCommonGroup);
}

}  // namespace

void AddConsoleOptions(CLI::App& verb, ConsoleOptions& options) {
  verb.add_flag("-q,--quiet", options.quiet, "Print no notes, warnings, losses and progress: the exit status tells")
      ->group(kCommonGroup);
  verb.add_flag("-v,--verbose", options.verbose, "Tell time, memory and bytes read at the end")->group(kCommonGroup);
  verb.add_option("--threads", options.threads, "Threads to work with; 0 means every core")
      ->type_name("N")
      ->check(Within(kThreads))
      ->group(kCommonGroup);
  AddMemory(verb);
  verb.add_flag(
          "--progress,!--no-progress", options.progress,
          "Show a progress bar on standard error; by default when that is a terminal and work takes over a second")
      ->group(kCommonGroup);
  AddColour(verb, options.colour);
  RefuseSigns(verb);
}

CLI::Option* AddInputs(CLI::App& verb, InputOptions& options, const std::string& description) {
  CLI::Option* files = verb.add_option("FILE", options.paths, description)->type_name("FILE")->required();
  AddFrom(verb, options.from);
  return files;
}

const Format* FormatOfInput(const HeldSource& input, const InputFormat& from) {
  return from.format.empty() ? FindFormatOfInput(input) : &FormatById(from.format);
}

void AddLayout(CLI::App& verb, std::string& layout) {
  verb.add_option(
          "--layout", layout,
          "Layout of an .osa file of a fork of ORB-SLAM3: one that is known, as obvi, or a JSON file; by default "
          "the one that fits")
      ->type_name("LAYOUT|FILE")
      ->group(kArchiveGroup);
}

void AddFrom(CLI::App& verb, InputFormat& from) {
  AddLayout(verb, from.layout);
  verb.add_option("--from", from.format, "Format of the input; by default told by its content, then its suffix")
      ->type_name("FORMAT")
      ->transform(CLI::IsMember(FormatIds(true), CLI::ignore_case));
}

void AddOutput(CLI::App& verb, OutputOptions& options) {
  Mark(verb.add_option("-o,--output", options.path, "Write to this file instead of standard output"), Writes::kFile)
      ->type_name("FILE");
  verb.add_flag("-O,--overwrite", options.overwrite, "Replace the output file if it is there");
}

void WriteOutput(const OutputOptions& options, std::string_view text, Console& console, Painter painter) {
  if (options.path == "-") return painter != nullptr ? console.Print(text, painter) : console.PrintData(text);
  AtomicFile file(options.path, {.overwrite = options.overwrite});
  file.Write(text);
  file.Commit();
}

void AddOutputPlace(CLI::App& verb, std::string& output, Writes writes, const std::string& description) {
  CLI::Option* place = Mark(verb.add_option("OUTPUT", output, description), writes)->type_name("FILE");
  Mark(verb.add_option("-o,--output", output, "The same as OUTPUT"), writes)->type_name("FILE")->excludes(place);
}

namespace {

constexpr const char* kPlaces = ": a file, STORE.db#NAME, postgresql://HOST/DB#NAME, or -";

}  // namespace

std::string AtlasAt(const std::string& what) { return what + kPlaces; }

std::string OutputAt() { return std::string("Where to") + kPlaces; }

std::string StoreAt(const std::string& what) {
  return what + ": an SQLite file of slamdb, or a database, postgresql://USER@HOST/DATABASE";
}

void RequireOutput(const std::string& output) {
  if (output.empty()) RefuseUsage("the output is missing; -o/--output names it");
}

// For ->transform(): the name becomes the version, or is refused with what there is.
static std::string ToBoostVersion(std::string& text) {
  const auto version = BoostVersionByName(text);
  if (!version) return WhyNoBoostVersion(text) + MeantInstead(text, NamesOfSystems());
  text = std::to_string(*version);
  return {};
}

void AddTarget(CLI::App& verb, TargetOptions& options) {
  verb.add_option("--to", options.to, "Format of the output; by default told by its suffix")
      ->type_name("FORMAT")
      ->transform(CLI::IsMember(FormatIds(false), CLI::ignore_case));
  verb.add_flag("-O,--overwrite", options.overwrite, "Replace the output if it is there");
  verb.add_flag("--no-sync", options.no_sync, "Do not wait for the disk: faster, but a power cut may lose the output");
  verb.add_option("--to-layout", options.layout,
                  "Write .osa files in that layout, of a fork of ORB-SLAM3 or v1.0; by default as read")
      ->type_name("LAYOUT|FILE")
      ->group(kArchiveGroup);
  verb.add_option(
          "--boost-version", options.boost_version,
          "The Boost that is to load the .osa file: a release (1.71), a system (ubuntu20.04, debian12, noetic), or a "
          "version of its archive library (17); by default as it was read")
      ->type_name("BOOST")
      ->transform(CLI::Validator(ToBoostVersion, ""))
      ->group(kArchiveGroup);
}

void RefuseBadTarget(const Location& output, const Format& format, const TargetOptions& options) {
  if (options.boost_version && !format.id.starts_with("orbslam3"))
    RefuseUsage("--boost-version is for archives of ORB-SLAM3 only; the output is " + std::string(format.title));
  if (!options.layout.empty() && !format.id.starts_with("orbslam3"))
    RefuseUsage("--to-layout is for archives of ORB-SLAM3 only; the output is " + std::string(format.title));
  if (format.is_export && output.name.empty()) RefuseAtlas(output.path);
}

void AddStore(CLI::App& verb, StoreVerbOptions& options) {
  verb.add_option("STORE", options.path, StoreAt("The store"))->type_name("FILE")->required();
  AddWait(verb, options.wait);
}

void AddWait(CLI::App& verb, double& wait) {
  verb.add_option("--wait", wait, "How long to wait for another program that writes to the store; inf is for ever")
      ->type_name("SECONDS")
      ->check(Within(kNonNegative))
      ->capture_default_str();
}

void AddJson(CLI::App& verb, bool& json) { verb.add_flag("--json", json, "Print JSON, for programs"); }

void RefuseUsage(const std::string& problem) { throw CLI::ValidationError(problem); }

bool IsStandardOutput(const std::string& path) {
  if (path == "-") return true;
  if (detail::IsServer(path)) return false;
  struct stat named {};
  struct stat standard {};
  return ::stat(path.c_str(), &named) == 0 && ::fstat(STDOUT_FILENO, &standard) == 0 &&
         named.st_dev == standard.st_dev && named.st_ino == standard.st_ino && !S_ISCHR(named.st_mode);
}

namespace {

// `-`, `/dev/stdout` or `/dev/tty`, which IsStandardOutput tells apart.
bool IsTerminal(const std::string& path) {
  if (path == "-") return ::isatty(STDOUT_FILENO) != 0;
  if (detail::IsServer(path)) return false;
  struct stat status {};
  if (::stat(path.c_str(), &status) != 0 || !S_ISCHR(status.st_mode)) return false;
  const int opened = ::open(path.c_str(), O_WRONLY | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
  const bool is_terminal = opened >= 0 && ::isatty(opened) != 0;
  if (opened >= 0) ::close(opened);
  return is_terminal;
}

}  // namespace

void RefuseBinaryOnTerminal(const Location& output, const Format& format, bool ascii) {
  const bool binary = format.kind == FileKind::kBinary || (format.kind == FileKind::kBinaryOrText && !ascii);
  if (!binary || !IsTerminal(output.path)) return;
  throw Error(ErrorKind::kUsage, std::string(format.title) +
                                     " is binary and would garble the terminal; name a file, or redirect the output");
}

ReadOptions MakeReadOptions(Console& console, const InputFormat& from, double wait) {
  ReadOptions options;
  options.format = from.format;
  options.of<Orbslam3ReadOptions>().layout = LayoutNamed(from.layout);
  options.of<StoreReadOptions>().lock_timeout = wait;
  options.threads = console.threads();
  options.progress = console.MakeProgress();
  return options;
}

WriteOptions MakeWriteOptions(Console& console, const TargetOptions& target, const std::string& provenance,
                              double wait) {
  WriteOptions options;
  options.format = target.to;
  options.of<StoreWriteOptions>() = {.provenance = provenance, .lock_timeout = wait};
  options.of<Orbslam3WriteOptions>().boost_version = target.boost_version;
  options.overwrite = target.overwrite;
  options.sync = !target.no_sync;
  options.threads = console.threads();
  options.progress = console.MakeProgress();
  if (!target.layout.empty()) options.of<Orbslam3WriteOptions>().layout = LayoutNamed(target.layout);
  return options;
}

}  // namespace slamdb::cli

// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/many/detail/check_journal.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <utility>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/detail/hash.h"
#include "slamdb/base/detail/json.h"
#include "slamdb/base/detail/run_files.h"
#include "slamdb/base/detail/server.h"
#include "slamdb/checks/detail/json.h"
#include "slamdb/formats/orbslam3/options.h"
#include "slamdb/formats/store/store.h"
#include "slamdb/model/digest.h"
#include "slamdb/version.h"

namespace slamdb::detail {
namespace {

constexpr std::string_view kReport = "slamdb-check-journal-";

int Open(const std::string& path) {
  EnterOutput(path);
  const int file = ::open(path.c_str(), O_RDWR | O_CREAT | O_APPEND | O_CLOEXEC, 0666);
  if (file < 0) throw SystemError(path, "cannot open the journal");
  return file;
}

std::string OfHash(std::uint64_t hash) { return Concat("hash ", Hex(hash)); }

std::string OfFile(const std::string& path) {
  struct stat status {};
  if (path == "-" || IsServer(path) || ::stat(path.c_str(), &status) != 0 || !S_ISREG(status.st_mode)) return {};
  return Concat(status.st_size, " bytes of ", status.st_mtim.tv_sec, " s and ", status.st_mtim.tv_nsec, " ns");
}

// What the results depend on besides the atlases.
Json HeadOf(const CheckAtlasesOptions& options) {
  const CheckOptions& check = options.check;
  Json head = ReportHead("check-journal");
  head["version"] = Version();
  head["rules"] = {{"ignore", check.ignore},
                   {"note", check.note},
                   {"warn", check.warn},
                   {"error", check.error},
                   {"strict", check.strict}};
  head["gates"] = Json::object();
  for (const GateLimit& gate : check.gates) head["gates"][gate.gate] = gate.limit;
  head["max_findings"] = check.max_findings;
  head["vocabulary"] = options.vocabulary == nullptr ? Json() : Json(options.vocabulary->identity.checksum);
  head["format"] = options.read.format;
  head["layout"] = options.read.of<Orbslam3ReadOptions>().layout;
  return head;
}

}  // namespace

CheckJournal::CheckJournal(const std::string& path, const CheckAtlasesOptions& options)
    : path_(path), file_(Open(path)) {
  Lock();
  Read(Dumped(HeadOf(options)));
}

void CheckJournal::Lock() const {
  struct stat status {};
  if (::fstat(file_.value, &status) != 0 || !S_ISREG(status.st_mode))
    throw Error(ErrorKind::kUsage, path_, "", "is no regular file, as a journal is");
  if (::flock(file_.value, LOCK_EX | LOCK_NB) == 0) return;
  if (errno == EWOULDBLOCK) throw Error(ErrorKind::kLocked, path_, "", "another program writes to this journal");
}

void CheckJournal::Read(const std::string& head) {
  std::string text, block(std::size_t{1} << 16, '\0');
  std::uint64_t begin = 0, at = 0;  // of the line, and of what is to be read
  for (std::size_t number = 1;;) {
    const ssize_t bytes = ::pread(file_.value, block.data(), block.size(), static_cast<off_t>(at));
    if (bytes < 0 && errno == EINTR) continue;
    if (bytes < 0) throw SystemError(path_, "cannot read the journal");
    if (bytes == 0) break;
    at += static_cast<std::uint64_t>(bytes);
    text.append(block, 0, static_cast<std::size_t>(bytes));
    std::size_t first = 0;
    for (std::size_t end = 0; (end = text.find('\n', first)) != std::string::npos; first = end + 1, ++number) {
      const std::string_view line = std::string_view(text).substr(first, end - first);
      if (number > 1)
        Enter(line, begin + first, number);
      else if (!line.starts_with(Concat("{\"report\":\"", kReport)))
        throw Error(ErrorKind::kAlreadyExists, path_, "", "is there, and no journal of checks; name another file");
      else if (line != head)
        throw Error(ErrorKind::kUsage, path_, "",
                    "is the journal of a check with other options, or by another version of slamdb; remove it, or "
                    "name another one");
    }
    text.erase(0, first);
    begin += first;
  }
  if (begin == 0 && !text.empty() && !Concat(head, "\n").starts_with(text))
    throw Error(ErrorKind::kAlreadyExists, path_, "", "is there, and no journal of checks; name another file");
  if (!text.empty() && ::ftruncate(file_.value, static_cast<off_t>(begin)) != 0)
    throw SystemError(path_, "cannot take away what was cut off");
  if (begin == 0) Append(head);
}

void CheckJournal::Enter(std::string_view text, std::uint64_t begin, std::size_t number) {
  try {
    const Json json = Json::parse(text);
    lines_[json.at("input")] = {begin, begin + text.size(), json.at("content")};
  } catch (const Json::exception&) {
    throw Error(ErrorKind::kDamaged, path_, Concat("line ", number),
                "is no result of a check; remove the journal to begin anew");
  }
}

std::optional<CheckReport> CheckJournal::Find(const std::string& input, const std::string& content) const {
  const auto line = lines_.find(input);
  if (line == lines_.end() || content.empty() || line->second.content != content) return std::nullopt;
  std::string text(line->second.end - line->second.begin, '\0');
  const ssize_t bytes = ::pread(file_.value, text.data(), text.size(), static_cast<off_t>(line->second.begin));
  if (bytes != static_cast<ssize_t>(text.size())) return std::nullopt;
  try {
    return std::move(CheckedFileOf(Json::parse(text)).report);
  } catch (const Json::exception&) {
  } catch (const Error&) {
  }
  return std::nullopt;  // somebody has edited it: the atlas is checked
}

void CheckJournal::Add(const CheckedFile& file, const std::string& content) {
  if (content.empty() || !file.failure.empty()) return;
  Json json = JsonOf(file);
  json["content"] = content;
  Append(Dumped(json));
}

void CheckJournal::Append(const std::string& text) const {
  const std::string line = text + "\n";
  for (std::size_t done = 0; done < line.size();) {
    const ssize_t bytes = ::write(file_.value, line.data() + done, line.size() - done);
    if (bytes < 0 && errno == EINTR) continue;
    if (bytes < 0) throw SystemError(path_, "cannot write to the journal");
    done += static_cast<std::size_t>(bytes);
  }
}

std::string Contents::Of(const AtlasInput& input) {
  if (!input.failure.empty() || input.atlas) return {};
  if (input.hash != 0) return OfHash(input.hash);
  const auto& [path, name] = input.location;
  if (!name.empty()) {
    auto store = stores_.find(path);
    if (store == stores_.end()) {
      store = stores_.try_emplace(path).first;
      try {
        for (const StoredAtlas& atlas : Store::Open(path, lock_timeout_).List()) store->second[atlas.name] = atlas.hash;
      } catch (const Error&) {  // which reading tells
      }
    }
    const auto hash = store->second.find(name);
    return hash == store->second.end() ? std::string() : OfHash(hash->second);
  }
  return OfFile(path);
}

bool IsContent(const std::string& content, const AtlasInput& input, const Atlas& atlas, int threads) {
  if (content.empty()) return true;
  return content == (input.location.name.empty() ? OfFile(input.location.path) : OfHash(HashOf(atlas, threads)));
}

}  // namespace slamdb::detail

// SPDX-License-Identifier: BSD-3-Clause
#include <istream>
#include <ostream>

#include "slamdb/base/error.h"
#include "slamdb/formats/detail/choose.h"
#include "slamdb/formats/detail/dry_run.h"
#include "slamdb/formats/detail/losses.h"
#include "slamdb/formats/formats.h"

namespace slamdb {
namespace {

constexpr const char *kMemory = "memory", *kStream = "stream";  // what errors call them

Atlas Read(const Source& source, const ReadOptions& options, Notices* notices) {
  Notices unheard;
  return detail::ReadInMemory(source, [&] {
    const HeldSource held = detail::Hold(source, options);
    const Format& format = detail::FormatToRead(held.source(), options);
    return format.read(held.source(), options, notices == nullptr ? unheard : *notices);
  });
}

// An export claims to hold no atlas: what it lacks is no loss, also where the reader left it out.
void TakeLossesForWarnings(Notices& notices) {
  Notices told;
  told.Tell(notices.written(), notices.counts());
  for (const Notice& notice : notices.items()) {
    if (notice.kind == Notice::Kind::kNote)
      told.Note(notice.text);
    else
      told.Warn(notice.text);
  }
  notices = std::move(told);
}

void Write(const Atlas& atlas, const Target& target, const WriteOptions& options, Notices* notices) {
  const Format& format = detail::FormatToWrite(target, options);
  const std::vector<std::string> losses = detail::LossesOf(atlas, format, options);
  if (options.strict && !losses.empty())
    throw Error(ErrorKind::kNotPossible, target.path, "", losses.front() + "; WriteOptions::strict refuses that");
  Notices unheard;
  Notices& heard = notices == nullptr ? unheard : *notices;
  if (format.is_export)
    TakeLossesForWarnings(heard);
  else
    for (const std::string& loss : losses) heard.Lose(loss);
  const Target to = detail::TargetOf(target, options);
  if (to.sink && !target.sink && (format.named || options.custom_format != nullptr)) return;
  detail::InMemory(target.path, "the machine has too little memory left to write it",
                   [&] { format.write(atlas, to, options, heard); });
}

// A stream that tells of failures by its state while it is used here, and afterwards as its owner has it. Its own
// exceptions are no Error, and come at a healthy end too.
class QuietStream {
 public:
  explicit QuietStream(std::ios& stream) : stream_(stream), exceptions_(stream.exceptions()) {
    stream_.exceptions(std::ios::goodbit);
  }
  ~QuietStream() {
    try {
      stream_.exceptions(exceptions_);  // throws what is due by now; whoever owns the stream sees its state
    } catch (const std::ios_base::failure&) {
    }
  }
  QuietStream(const QuietStream&) = delete;
  QuietStream& operator=(const QuietStream&) = delete;

 private:
  std::ios& stream_;
  const std::ios::iostate exceptions_;
};

std::string WholeStream(std::istream& stream) {
  const QuietStream quiet(stream);
  constexpr std::size_t kBlock = std::size_t{1} << 20;
  std::string bytes;
  for (std::size_t size = 0; stream; size += static_cast<std::size_t>(stream.gcount())) {
    bytes.resize(size + kBlock);
    stream.read(bytes.data() + size, static_cast<std::streamsize>(kBlock));
    bytes.resize(size + static_cast<std::size_t>(stream.gcount()));
  }
  if (stream.bad() || !stream.eof()) throw Error(ErrorKind::kNotPossible, kStream, "", "cannot be read");
  return bytes;
}

}  // namespace

Atlas ReadAtlas(const Location& location, const ReadOptions& options, Notices* notices) {
  return Read({location.path, location.name}, options, notices);
}

HeldSource HoldInput(const Location& location, const ReadOptions& options) {
  return detail::Hold({location.path, location.name}, options);
}

Atlas ReadAtlas(const HeldSource& held, const ReadOptions& options, Notices* notices) {
  return Read(held.source(), options, notices);
}

Atlas ReadAtlas(std::istream& stream, const ReadOptions& options, Notices* notices) {
  const std::string bytes = detail::InMemory(kStream, "does not fit into memory", [&] { return WholeStream(stream); });
  return Read({std::as_bytes(std::span(bytes)), kStream}, options, notices);
}

Atlas DecodeAtlas(Bytes bytes, const ReadOptions& options, Notices* notices) {
  return Read({bytes, kMemory}, options, notices);
}

Atlas DecodeAtlas(std::string_view bytes, const ReadOptions& options, Notices* notices) {
  return DecodeAtlas(std::as_bytes(std::span(bytes)), options, notices);
}

void WriteAtlas(const Atlas& atlas, const Location& location, const WriteOptions& options, Notices* notices) {
  Write(atlas, {location.path, location.name}, options, notices);
}

void WriteAtlas(const Atlas& atlas, std::ostream& stream, const WriteOptions& options, Notices* notices) {
  const QuietStream quiet(stream);
  const auto require = [](bool good) {
    if (!good) throw Error(ErrorKind::kNotPossible, kStream, "", "cannot be written");
  };
  const auto put = [&](Bytes bytes) {
    require(
        stream.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size())).good());
  };
  Write(atlas, Target(put, kStream), options, notices);
  require(stream.flush().good());  // what its buffer holds may still not fit on a disk
}

std::string EncodeAtlas(const Atlas& atlas, const WriteOptions& options, Notices* notices) {
  std::string encoded;
  const auto append = [&encoded](Bytes bytes) {
    encoded.append(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  };
  Write(atlas, Target(append, kMemory), options, notices);
  return encoded;
}

}  // namespace slamdb

// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/mrpt/detail/gzip.h"

#include <zlib.h>

#include <algorithm>
#include <new>

#include "slamdb/base/error.h"

namespace slamdb::mrpt {
namespace {

constexpr std::size_t kBlock = std::size_t{1} << 18;
constexpr int kGzip = 15 + 16;  // the largest window, with gzip's header
constexpr std::size_t kMostGrowth = 200, kAlwaysAllowed = std::size_t{1} << 28;

// zlib counts in 32 bits.
unsigned Piece(std::string_view bytes) { return static_cast<unsigned>(std::min<std::size_t>(bytes.size(), 1U << 30)); }

class Inflater {
 public:
  explicit Inflater(std::string_view gzip) : gzip_(gzip) {
    if (inflateInit2(&stream_, kGzip) != Z_OK) throw std::bad_alloc();
  }
  ~Inflater() { inflateEnd(&stream_); }
  Inflater(const Inflater&) = delete;
  Inflater& operator=(const Inflater&) = delete;

  // Appends up to kBlock bytes. False at the end of the file and where it is cut or damaged: see `whole`.
  bool Step(std::string& out) {
    const std::size_t size = out.size(), given = gzip_.size();
    out.resize(size + kBlock);
    stream_.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(gzip_.data()));  // zlib does not write there
    const unsigned piece = stream_.avail_in = Piece(gzip_);
    stream_.next_out = reinterpret_cast<Bytef*>(out.data() + size);
    stream_.avail_out = static_cast<unsigned>(kBlock);
    const int code = inflate(&stream_, Z_NO_FLUSH);
    gzip_.remove_prefix(piece - stream_.avail_in);
    out.resize(size + kBlock - stream_.avail_out);
    if (code == Z_STREAM_END) {
      whole_ = gzip_.empty();
      return !whole_ && inflateReset(&stream_) == Z_OK;  // several gzip files one behind the other are one
    }
    return (code == Z_OK || code == Z_BUF_ERROR) && (out.size() > size || gzip_.size() < given);
  }
  bool whole() const { return whole_; }

 private:
  z_stream stream_{};
  std::string_view gzip_;
  bool whole_ = false;
};

}  // namespace

bool IsGzip(std::string_view bytes) { return bytes.starts_with("\x1f\x8b"); }

std::size_t MostBytes(std::string_view gzip) { return std::max(kAlwaysAllowed, gzip.size() * kMostGrowth); }

std::string Decompress(const std::string& path, std::string_view gzip) {
  const std::size_t most = MostBytes(gzip);
  Inflater inflater(gzip);
  std::string bytes;
  while (inflater.Step(bytes))
    if (bytes.size() > most)
      throw Error(ErrorKind::kOutOfResources, path, "",
                  "the compressed file swells to more than " + std::to_string(most) + " bytes, over " +
                      std::to_string(kMostGrowth) + " times its size; if that is right, unpack it first (gunzip)");
  if (!inflater.whole()) throw Error(ErrorKind::kDamaged, path, "", "the compressed file is truncated or damaged");
  return bytes;
}

std::string DecompressHead(std::string_view gzip, std::size_t size) {
  Inflater inflater(gzip);
  std::string bytes;
  while (bytes.size() < size && inflater.Step(bytes)) {
  }
  bytes.resize(std::min(bytes.size(), size));
  return bytes;
}

struct Compressor::State {
  z_stream stream{};
  std::string block = std::string(kBlock, '\0');
};

Compressor::Compressor(std::function<void(std::string_view)> write)
    : state_(std::make_unique<State>()), write_(std::move(write)) {
  if (deflateInit2(&state_->stream, Z_DEFAULT_COMPRESSION, Z_DEFLATED, kGzip, 8, Z_DEFAULT_STRATEGY) != Z_OK)
    throw std::bad_alloc();
}

Compressor::~Compressor() { deflateEnd(&state_->stream); }

void Compressor::Deflate(std::string_view bytes, int flush) {
  z_stream& stream = state_->stream;
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));  // zlib does not write there
  stream.avail_in = Piece(bytes);
  do {
    stream.next_out = reinterpret_cast<Bytef*>(state_->block.data());
    stream.avail_out = static_cast<unsigned>(kBlock);
    deflate(&stream, flush);
    write_({state_->block.data(), kBlock - stream.avail_out});
  } while (stream.avail_out == 0);
}

void Compressor::Add(std::string_view bytes) {
  for (; !bytes.empty(); bytes.remove_prefix(Piece(bytes))) Deflate(bytes.substr(0, Piece(bytes)), Z_NO_FLUSH);
}

void Compressor::Finish() { Deflate({}, Z_FINISH); }

}  // namespace slamdb::mrpt

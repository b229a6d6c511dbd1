// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <string_view>

namespace slamdb::mrpt {

bool IsGzip(std::string_view bytes);

// The bytes in a gzip file. Throws Error (`path` names it) when it is damaged or truncated, or swells to more than
// 256 MB and 200 times its size, as only files made to fill a machine's memory do.
std::string Decompress(const std::string& path, std::string_view gzip);

// How many bytes Decompress takes from such a file at most.
std::size_t MostBytes(std::string_view gzip);

// As many of the first bytes as `size` and what of the file is given allow; empty when it is damaged.
std::string DecompressHead(std::string_view gzip, std::size_t size);

// Compresses what is added, and hands it on in blocks. The same bytes for the same input, in whatever pieces.
class Compressor {
 public:
  explicit Compressor(std::function<void(std::string_view)> write);
  ~Compressor();
  Compressor(const Compressor&) = delete;
  Compressor& operator=(const Compressor&) = delete;

  void Add(std::string_view bytes);
  void Finish();

 private:
  void Deflate(std::string_view bytes, int flush);

  struct State;
  std::unique_ptr<State> state_;
  std::function<void(std::string_view)> write_;
};

}  // namespace slamdb::mrpt

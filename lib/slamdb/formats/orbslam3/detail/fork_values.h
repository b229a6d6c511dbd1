// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <type_traits>

#include "slamdb/formats/orbslam3/detail/decoder.h"
#include "slamdb/formats/orbslam3/detail/encoder.h"
#include "slamdb/formats/orbslam3/detail/fork_program.h"

// Values of any type between an archive and Carried::members. schema/layouts.md describes the packed bytes: what stands
// in the archive, without class info and item versions, with 8 bytes for every long and count. Types are nested as deep
// as the layout says, never as the file does.
namespace slamdb::orbslam3 {

// How many bytes a number has in an archive.
inline std::size_t WireWidthOf(LayoutType::Number number, const ArchiveEncoding& encoding) {
  using N = LayoutType::Number;
  if (number == N::kU64 || number == N::kLong) return encoding.long_bytes;
  if (number == N::kSize) return encoding.size_bytes;
  return WidthOf(number);
}

// Reads values. Pointers(node, out) reads one that is a pointer.
template <class Input, class Pointers>
class ValueReader {
 public:
  ValueReader(Decoder<Input>& archive, ByteWriter& out, const Pointers& pointers)
      : archive_(archive), input_(archive.input), out_(out), pointers_(pointers) {
    const ArchiveEncoding& encoding = input_.encoding();
    has_runs_ = !Input::kText && encoding.long_bytes == 8 && encoding.size_bytes == 8;
  }

  void Read(const TypeNode& node) {
    using Kind = TypeNode::Kind;
    switch (node.kind) {
      case Kind::kNumbers:
        return ReadNumbers(node.number, node.count);
      case Kind::kVector:
        return ReadVector(node);
      case Kind::kString:
        return ReadString();
      case Kind::kArray:
        for (std::uint32_t i = 0; i < node.count; ++i) Read(node.children[0]);
        return;
      case Kind::kList:
        return ReadList(node);
      case Kind::kMap:
        return ReadMap(node);
      case Kind::kClass:
        return ReadClass(node);
      case Kind::kMatrix:
        return ReadMatrix();
      case Kind::kMatrix2:
        return ReadMatrix2(node);
      case Kind::kKeypoints:
        return ReadKeypoints();
      case Kind::kPointer:
        return pointers_(node, out_);
    }
  }

 private:
  void ReadNumbers(LayoutType::Number number, std::size_t count) {
    using N = LayoutType::Number;
    switch (number) {
      case N::kU8:
      case N::kBool:
        return Take<std::uint8_t>(count);
      case N::kI8:
        return Take<std::int8_t>(count);
      case N::kI16:
        return Take<std::int16_t>(count);
      case N::kU16:
        return Take<std::uint16_t>(count);
      case N::kI32:
        return Take<std::int32_t>(count);
      case N::kU32:
        return Take<std::uint32_t>(count);
      case N::kULongLong:
        return Take<std::uint64_t>(count);
      case N::kI64:
        return Take<std::int64_t>(count);
      case N::kF32:
        return Take<float>(count);
      case N::kF64:
        return Take<double>(count);
      case N::kU64:
        for (; count > 0; --count) out_.Put(input_.TakeUnsignedLong());
        return;
      case N::kLong:
        for (; count > 0; --count) out_.Put(input_.TakeLong());
        return;
      case N::kSize:
        for (; count > 0; --count) {
          std::uint64_t size = 0;
          input_.TakeSizes(&size, 1);
          out_.Put(size);
        }
        return;
    }
  }
  template <class T>
  void Take(std::size_t count) {
    if constexpr (Input::kText) {
      for (; count > 0; --count) out_.Put(input_.template Take<T>());
    } else {
      TakeBytes(count * sizeof(T));
    }
  }
  void TakeBytes(std::size_t bytes) {
    auto* const to = reinterpret_cast<std::uint8_t*>(out_.Extend(bytes));
    input_.TakeArray(to, bytes);
  }
  void ReadVector(const TypeNode& node) {
    const std::size_t width = WireWidthOf(node.number, input_.encoding());
    const std::uint64_t count =
        node.number == LayoutType::Number::kBool ? BoolCount(node) : archive_.VectorCount(node.wire_class, width);
    out_.Put(count);
    ReadNumbers(node.number, count);
  }
  // Boost writes vector<bool> in a way of its own: no item version, in text neither.
  std::uint64_t BoolCount(const TypeNode& node) {
    archive_.classes.Register(node.wire_class);
    return input_.CheckCount(input_.TakeSize(), 1, 1);
  }
  void ReadString() {
    const std::string text = input_.TakeString();
    out_.Put(static_cast<std::uint64_t>(text.size()));
    out_.PutBytes(std::as_bytes(std::span(text)));
  }
  void ReadList(const TypeNode& node) {
    if (!node.has_info) archive_.classes.FirstUse(node.wire_class);  // so that none is looked for
    const std::uint64_t count = archive_.ClassCount(node.wire_class, 1, 1);
    out_.Put(count);
    for (std::uint64_t i = 0; i < count; ++i) Read(node.children[0]);
  }
  void ReadMap(const TypeNode& node) {
    const std::uint64_t count = archive_.ClassCount(node.wire_class, 2, 2);
    out_.Put(count);
    if (count > 0) archive_.ClassInfo(node.pair_class);
    for (std::uint64_t i = 0; i < count; ++i)
      for (const TypeNode& child : node.children) Read(child);
  }
  void ReadClass(const TypeNode& node) {
    if (node.wire_class != WireClass::kCount) archive_.ClassInfo(node.wire_class);
    std::size_t first = 0;
    if (has_runs_ && node.run_nodes > 1) {
      TakeBytes(node.run_bytes);
      first = node.run_nodes;
    }
    for (std::size_t i = first; i < node.children.size(); ++i) Read(node.children[i]);
  }
  void ReadMatrix() {
    Matrix matrix;
    const std::uint64_t bytes = archive_.MatrixBytes(matrix);
    for (const std::int32_t number : {matrix.columns, matrix.rows, matrix.type}) out_.Put(number);
    out_.Put(matrix.continuous);
    Take<std::uint8_t>(bytes);
  }
  void ReadMatrix2(const TypeNode& node) {
    archive_.ClassInfo(node.wire_class);
    const auto columns = input_.template Take<std::int32_t>(), rows = input_.template Take<std::int32_t>();
    std::array<std::uint64_t, 2> element{};  // its size, its type
    input_.TakeSizes(element.data(), 2);
    constexpr std::uint64_t kMostBytes = 4096;
    if (columns < 0 || rows < 0 || element[0] > kMostBytes)
      input_.Fail("a matrix of " + std::to_string(rows) + " x " + std::to_string(columns) +
                  ": the file is damaged, or of another layout");
    const std::uint64_t cells = static_cast<std::uint64_t>(columns) * static_cast<std::uint64_t>(rows);
    const auto size = std::max<std::size_t>(element[0], 1);
    input_.CheckCount(cells, size, size);
    for (const std::int32_t number : {columns, rows}) out_.Put(number);
    for (const std::uint64_t number : element) out_.Put(number);
    Take<std::uint8_t>(cells * element[0]);
  }
  void ReadKeypoints() {
    const std::uint64_t count = archive_.KeypointCount();
    out_.Put(static_cast<std::int32_t>(count));
    if constexpr (Input::kText) {
      for (std::uint64_t i = 0; i < count; ++i) {
        Take<float>(5);
        Take<std::int32_t>(2);
      }
    } else {
      TakeBytes(count * sizeof(Keypoint));
    }
  }

  Decoder<Input>& archive_;
  Input& input_;
  ByteWriter& out_;
  const Pointers& pointers_;
  bool has_runs_;
};

// Writes them. Pointers(node, in) writes one that is a pointer. Throws Error (kDamaged) where the packed bytes are not
// of the type. Over NoOutput it passes over them.
template <class Output, class Pointers>
class ValueWriter {
 public:
  ValueWriter(Encoder<Output>& archive, ByteReader& in, const Pointers& pointers)
      : archive_(archive), output_(archive.output), in_(in), pointers_(pointers) {}

  void Write(const TypeNode& node) {
    using Kind = TypeNode::Kind;
    switch (node.kind) {
      case Kind::kNumbers:
        return WriteNumbers(node.number, node.count);
      case Kind::kVector: {
        const std::uint64_t count = TakeCount(WidthOf(node.number));
        if (node.number == LayoutType::Number::kBool)
          PutBoolCount(node, count);
        else
          archive_.VectorCount(node.wire_class, count);
        return WriteNumbers(node.number, count);
      }
      case Kind::kString: {
        const std::uint64_t size = TakeCount(1);
        return output_.PutString({reinterpret_cast<const char*>(in_.Take(size)), size});
      }
      case Kind::kArray:
        for (std::uint32_t i = 0; i < node.count; ++i) Write(node.children[0]);
        return;
      case Kind::kList: {
        const std::uint64_t count = TakeCount(1);
        if (!node.has_info) archive_.classes.FirstUse(node.wire_class);
        archive_.ClassCount(node.wire_class, count);
        for (std::uint64_t i = 0; i < count; ++i) Write(node.children[0]);
        return;
      }
      case Kind::kMap: {
        const std::uint64_t count = TakeCount(2);
        archive_.ClassCount(node.wire_class, count);
        if (count > 0) archive_.ClassInfo(node.pair_class);
        for (std::uint64_t i = 0; i < count; ++i)
          for (const TypeNode& child : node.children) Write(child);
        return;
      }
      case Kind::kClass:
        if (node.wire_class != WireClass::kCount) archive_.ClassInfo(node.wire_class);
        for (const TypeNode& child : node.children) Write(child);
        return;
      case Kind::kMatrix:
        return WriteMatrix();
      case Kind::kMatrix2:
        return WriteMatrix2(node);
      case Kind::kKeypoints:
        return WriteKeypoints();
      case Kind::kPointer:
        return pointers_(node, in_);
    }
  }

 private:
  // A count of things that have at least `bytes` bytes each.
  std::uint64_t TakeCount(std::size_t bytes) {
    const auto count = in_.Get<std::uint64_t>();
    if (count > in_.left() / bytes)
      throw Error(ErrorKind::kDamaged, "a count of " + std::to_string(count) + " does not fit into carried members");
    return count;
  }
  void PutBoolCount(const TypeNode& node, std::uint64_t count) {
    archive_.classes.Register(node.wire_class);
    output_.PutSize(count);
  }
  void WriteNumbers(LayoutType::Number number, std::size_t count) {
    using N = LayoutType::Number;
    switch (number) {
      case N::kU8:
      case N::kBool:
        return Put<std::uint8_t>(count);
      case N::kI8:
        return Put<std::int8_t>(count);
      case N::kI16:
        return Put<std::int16_t>(count);
      case N::kU16:
        return Put<std::uint16_t>(count);
      case N::kI32:
        return Put<std::int32_t>(count);
      case N::kU32:
        return Put<std::uint32_t>(count);
      case N::kULongLong:
        return Put<std::uint64_t>(count);
      case N::kI64:
        return Put<std::int64_t>(count);
      case N::kF32:
        return Put<float>(count);
      case N::kF64:
        return Put<double>(count);
      case N::kU64:
        for (; count > 0; --count) output_.PutUnsignedLong(in_.Get<std::uint64_t>());
        return;
      case N::kLong:
        for (; count > 0; --count) output_.PutLong(in_.Get<std::int64_t>());
        return;
      case N::kSize:
        for (; count > 0; --count) {
          const auto size = in_.Get<std::uint64_t>();
          output_.PutSizes(&size, 1);
        }
        return;
    }
  }
  template <class T>
  void Put(std::size_t count) {
    if constexpr (Output::kText) {
      for (; count > 0; --count) output_.Put(in_.Get<T>());
    } else {
      const std::byte* const bytes = in_.TakeArray(count, sizeof(T));
      output_.PutArray(reinterpret_cast<const std::uint8_t*>(bytes), count * sizeof(T));
    }
  }
  void WriteMatrix() {
    constexpr std::array<std::uint64_t, 8> kDepthBytes{1, 1, 2, 2, 4, 4, 8, 2};  // OpenCV's CV_8U .. CV_16F
    const auto columns = in_.Get<std::int32_t>(), rows = in_.Get<std::int32_t>(), type = in_.Get<std::int32_t>();
    if (columns < 0 || rows < 0 || type < 0 || type >= 4096)
      throw Error(ErrorKind::kDamaged, "carried members hold no matrix where one is expected");
    for (const std::int32_t number : {columns, rows, type}) output_.Put(number);
    Put<std::uint8_t>(1);
    PutCells(columns, rows,
             kDepthBytes[static_cast<std::size_t>(type & 7)] * (static_cast<std::uint64_t>(type >> 3) + 1));
  }
  void WriteMatrix2(const TypeNode& node) {
    archive_.ClassInfo(node.wire_class);
    const auto columns = in_.Get<std::int32_t>(), rows = in_.Get<std::int32_t>();
    const auto element = in_.Get<std::array<std::uint64_t, 2>>();
    if (columns < 0 || rows < 0)
      throw Error(ErrorKind::kDamaged, "carried members hold no matrix where one is expected");
    for (const std::int32_t number : {columns, rows}) output_.Put(number);
    output_.PutSizes(element.data(), element.size());
    PutCells(columns, rows, element[0]);
  }
  void PutCells(std::int32_t columns, std::int32_t rows, std::uint64_t bytes) {
    const std::uint64_t cells = static_cast<std::uint64_t>(columns) * static_cast<std::uint64_t>(rows);
    if (bytes != 0 && cells > in_.left() / bytes)
      throw Error(ErrorKind::kDamaged, "carried members hold no matrix where one is expected");
    Put<std::uint8_t>(cells * bytes);
  }
  void WriteKeypoints() {
    const auto count = in_.Get<std::int32_t>();
    if (count < 0 || static_cast<std::size_t>(count) > in_.left() / sizeof(Keypoint))
      throw Error(ErrorKind::kDamaged, "carried members hold no keypoints where some are expected");
    output_.Put(count);
    if constexpr (Output::kText) {
      for (std::int32_t i = 0; i < count; ++i) {
        Put<float>(5);
        Put<std::int32_t>(2);
      }
    } else {
      Put<std::uint8_t>(static_cast<std::size_t>(count) * sizeof(Keypoint));
    }
  }

  Encoder<Output>& archive_;
  Output& output_;
  ByteReader& in_;
  const Pointers& pointers_;
};

// What a pointer in Carried::members is.
enum class PackedPointer : std::uint8_t {
  kNull,
  kEntity,  // u8: 0 map, 1 keyframe, 2 point, 3 camera; u64: its id
  kObject,  // u32: its number among objects that are no entity; u8: 1 where its members follow, as they do first
};

// Nothing of the type: zeros throughout, which stand for empty lists and null pointers too.
inline void PutNothing(const TypeNode& node, ByteWriter& out) {
  const std::uint64_t bytes = BytesOfNothing(node);
  if (bytes > 0) std::memset(out.Extend(bytes), 0, bytes);
}

// Passes over packed values. Throws Error as ValueWriter does.
inline void SkipPacked(const TypeNode& node, ByteReader& in) {
  const ArchiveEncoding encoding;
  Encoder<NoOutput> nowhere{NoOutput(), ClassTable(encoding)};
  const auto skip_pointer = [](const TypeNode& pointer, ByteReader& from) {
    const auto kind = from.Get<std::uint8_t>();
    if (kind == static_cast<std::uint8_t>(PackedPointer::kEntity)) from.Take(1 + sizeof(std::uint64_t));
    if (kind != static_cast<std::uint8_t>(PackedPointer::kObject)) return;
    from.Take(sizeof(std::uint32_t));
    if (from.Get<std::uint8_t>() != 0 && !pointer.children.empty()) SkipPacked(pointer.children[0], from);
  };
  ValueWriter writer(nowhere, in, skip_pointer);
  writer.Write(node);
}

}  // namespace slamdb::orbslam3

// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <iosfwd>
#include <span>
#include <string>
#include <string_view>

#include "slamdb/export.h"
#include "slamdb/formats/format.h"

// The way in and out: `Atlas atlas = ReadAtlas("map.osa"); WriteAtlas(atlas, "maps.db#lab");`.
// `notices`, when given, receives what a successful run has to tell.
//
// Everything here throws Error.
// Thread-safe.
namespace slamdb {

// ---- reading

// Reads with the format of the options, or else the one that the input has by its content, then by its suffix.
// Streams (standard input, a FIFO) are read into memory, up to kMostStreamBytes.
//
// Throws Error:
//   kNotFound        nothing is there
//   kDamaged         bytes are wrong, with the place
//   kUnsupported     other versions, other programs' files, saying what they are (`not an atlas: this looks like a
//                    COLMAP database`), and formats that slamdb only writes
//   kOutOfResources  memory does not suffice
//   kLocked          a store that another program holds
//   kUsage           the options name no format that there is, or nothing tells the format; the location is a folder,
//                    has a `#name` outside a store, or has none in a store of several atlases
[[nodiscard]] SLAMDB_EXPORT Atlas ReadAtlas(const Location& location, const ReadOptions& options = {},
                                            Notices* notices = nullptr);
// Reads the stream to its end, into memory.
//
// Throws Error as above, and kNotPossible when the stream fails.
[[nodiscard]] SLAMDB_EXPORT Atlas ReadAtlas(std::istream& stream, const ReadOptions& options = {},
                                            Notices* notices = nullptr);
// The same of a source that was looked at before.
[[nodiscard]] SLAMDB_EXPORT Atlas ReadAtlas(const HeldSource& held, const ReadOptions& options = {},
                                            Notices* notices = nullptr);
// An input held for that: a stream is read, and refused by its beginning when it is of no kind that is read.
//
// Throws Error as above.
[[nodiscard]] SLAMDB_EXPORT HeldSource HoldInput(const Location& location, const ReadOptions& options = {});
// The same of bytes in memory, which are not copied.
//
// Throws Error as above, and kNotPossible for a store, which is a file.
[[nodiscard]] SLAMDB_EXPORT Atlas DecodeAtlas(Bytes bytes, const ReadOptions& options = {}, Notices* notices = nullptr);
[[nodiscard]] SLAMDB_EXPORT Atlas DecodeAtlas(std::string_view bytes, const ReadOptions& options = {},
                                              Notices* notices = nullptr);

// ---- writing

// Writes with the format of the options, or else the one of the suffix.
// A file appears whole or not at all; a store is changed in one transaction.
// Names in `notices`, as losses, what the atlas has and the target cannot hold.
//
// Throws Error:
//   kAlreadyExists  the target is there, without options.overwrite
//   kNotPossible    the first loss, with options.strict
//   kLocked         a store that another program writes
//   kUsage          nothing tells the format, or it is one that is only read
//   kPermission, kOutOfResources and kNotFound (a folder) as the system has it
SLAMDB_EXPORT void WriteAtlas(const Atlas& atlas, const Location& location, const WriteOptions& options = {},
                              Notices* notices = nullptr);
// Writes to a stream, or to bytes in memory.
// They have no suffix: the options must name the format.
//
// Throws Error as above, and kNotPossible when the stream fails, or the format is a store.
SLAMDB_EXPORT void WriteAtlas(const Atlas& atlas, std::ostream& stream, const WriteOptions& options,
                              Notices* notices = nullptr);
[[nodiscard]] SLAMDB_EXPORT std::string EncodeAtlas(const Atlas& atlas, const WriteOptions& options,
                                                    Notices* notices = nullptr);

// ---- which formats there are

// Every format, in the order in which their sniffers are asked.
SLAMDB_EXPORT std::span<const Format> Formats();

// The format of that id.
//
// Throws Error (kUsage) naming the known ids.
SLAMDB_EXPORT const Format& FormatById(std::string_view id);

// The format of a file that is there: by content first, then by suffix; `id` overrides. A stream is read for it.
//
// Throws Error as ReadAtlas does.
SLAMDB_EXPORT const Format& FormatOfInput(const Location& location, std::string_view id = {});

// The same, or null for what is no atlas that slamdb reads, and for a stream, which is not read for it unless it is
// held.
//
// Throws Error (kNotFound) when there is no such file.
[[nodiscard]] SLAMDB_EXPORT const Format* FindFormatOfInput(const Location& location);
[[nodiscard]] SLAMDB_EXPORT const Format* FindFormatOfInput(const HeldSource& held);

// Whether the file holds several atlases, each under a name: by its suffix, or by its content. False where none is
// there or it cannot be read.
[[nodiscard]] SLAMDB_EXPORT bool HoldsNamedAtlases(const std::string& path);

// The format to write: `id`, or by suffix.
//
// Throws Error (kUsage) naming the suffixes.
SLAMDB_EXPORT const Format& FormatOfOutput(const Location& location, std::string_view id = {});

}  // namespace slamdb

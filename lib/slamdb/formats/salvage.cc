// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/salvage.h"

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/detail/recognize.h"
#include "slamdb/base/detail/server.h"
#include "slamdb/base/error.h"
#include "slamdb/formats/detail/choose.h"
#include "slamdb/formats/formats.h"
#include "slamdb/formats/orbslam3/orbslam3.h"

namespace slamdb {
namespace {

// Whether nothing but its name says what the file is: a disk that was not written in time holds zeros.
bool IsArchiveThatBeginsWithZeros(const Source& source) {
  if (!source.path.ends_with(".osa")) return false;
  const auto recognized = detail::Recognize(Probe::Of(source));
  return recognized && recognized->id == "zeros";
}

const Format& FormatToSalvage(const Source& source, const ReadOptions& options) {
  const bool may_be = options.format.empty() || options.format == kOrbslam3Format.id;
  if (options.custom_format == nullptr && may_be && IsArchiveThatBeginsWithZeros(source)) return kOrbslam3Format;
  return detail::FormatToRead(source, options);
}

std::string RecoverableIds() {
  std::string ids;
  for (const Format& format : Formats())
    if (format.salvage != nullptr) ids.append(ids.empty() ? "" : ", ").append(format.id);
  return ids;
}

Salvage SalvageHeld(const Source& source, const ReadOptions& options) {
  const Format& format = FormatToSalvage(source, options);
  if (format.salvage == nullptr)
    throw Error(
        ErrorKind::kUnsupported, source.path, "",
        detail::Concat("is a ", format.title, ", of which nothing is recovered; recoverable are ", RecoverableIds()));
  return detail::ReadInMemory(source, [&] { return format.salvage(source, options); });
}

Salvage SalvageSource(const Source& source, const ReadOptions& options) {
  return SalvageHeld(detail::Hold(source, options).source(), options);
}

}  // namespace

Salvage SalvageAtlas(const Location& location, const ReadOptions& options) {
  detail::RefuseOnServer(location.path, "what is damaged there is restored from a backup, as pg_restore does");
  return SalvageSource({location.path, location.name}, options);
}

Salvage SalvageBytes(Bytes bytes, const ReadOptions& options) { return SalvageSource({bytes, "memory"}, options); }

}  // namespace slamdb

// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/base/error.h"

#include <cerrno>
#include <system_error>

#include "slamdb/base/detail/errno_kind.h"
#include "slamdb/base/detail/server.h"

namespace slamdb {
namespace {

std::string Sentence(const std::string& path, const std::string& place, const std::string& problem) {
  std::string text;
  for (const std::string* part : {&path, &place, &problem}) {
    if (part->empty()) continue;
    if (!text.empty()) text += ": ";
    text += *part;
  }
  return text;
}

}  // namespace

ErrorKind detail::KindOfErrno(int code) {
  switch (code) {
    case ENOENT:
    case ENOTDIR:
    case ENXIO:
    case ENODEV:
      return ErrorKind::kNotFound;
    case EEXIST:
    case ENOTEMPTY:
      return ErrorKind::kAlreadyExists;
    case EACCES:
    case EPERM:
    case EROFS:
      return ErrorKind::kPermission;
    case EAGAIN:
    case EBUSY:
    case ETXTBSY:
    case EDEADLK:
      return ErrorKind::kLocked;
    case ENOMEM:
    case ENOSPC:
    case EDQUOT:
    case EFBIG:
    case EMFILE:
    case ENFILE:
      return ErrorKind::kOutOfResources;
    case EISDIR:
    case EINVAL:
    case ENAMETOOLONG:
    case ELOOP:
      return ErrorKind::kUsage;
    case EIO:
      return ErrorKind::kDamaged;
    default:
      return ErrorKind::kNotPossible;
  }
}

std::string_view ToString(ErrorKind kind) {
  switch (kind) {
    case ErrorKind::kNotFound:
      return "not found";
    case ErrorKind::kAlreadyExists:
      return "already exists";
    case ErrorKind::kPermission:
      return "permission";
    case ErrorKind::kDamaged:
      return "damaged";
    case ErrorKind::kUnsupported:
      return "unsupported";
    case ErrorKind::kLocked:
      return "locked";
    case ErrorKind::kOutOfResources:
      return "out of resources";
    case ErrorKind::kUsage:
      return "usage";
    case ErrorKind::kNotPossible:
      return "not possible";
    case ErrorKind::kInternal:
      return "internal";
  }
  return "internal";
}

Error::Error(ErrorKind kind, std::string path, std::string place, std::string problem)
    : std::runtime_error(detail::WithoutPasswords(Sentence(detail::WithoutKeywordPasswords(path), place, problem))),
      kind_(kind),
      path_(detail::WithoutPasswords(detail::WithoutKeywordPasswords(std::move(path)))),
      place_(detail::WithoutPasswords(std::move(place))),
      problem_(detail::WithoutPasswords(std::move(problem))) {}

Error SystemError(const std::string& path, const std::string& problem) {
  const int code = errno;
  return Error(detail::KindOfErrno(code), path, "", problem + ": " + std::generic_category().message(code));
}

}  // namespace slamdb

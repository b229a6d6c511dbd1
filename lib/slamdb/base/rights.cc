// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/base/detail/rights.h"

#include <unistd.h>

namespace slamdb::detail {

bool TakeRights(const struct stat& of, int descriptor) {
  constexpr mode_t kModeBits = 07777, kGroup = S_IRWXG, kOfGroup = S_IRWXG | S_ISGID, kOfOwner = S_ISUID;
  struct stat made {};
  if (::fstat(descriptor, &made) != 0) return false;
  mode_t mode = of.st_mode & kModeBits;
  const bool same_group = made.st_gid == of.st_gid || ::fchown(descriptor, static_cast<uid_t>(-1), of.st_gid) == 0;
  if (!same_group) mode = (mode & ~kOfGroup) | (mode & (mode << 3) & kGroup);
  if (made.st_uid != of.st_uid && ::fchown(descriptor, of.st_uid, static_cast<gid_t>(-1)) != 0) mode &= ~kOfOwner;
  return ::fchmod(descriptor, mode) == 0;
}

}  // namespace slamdb::detail

#pragma once

#include <cstddef>
#include <string>

#include "schema/model/ids.h"
#include "schema/model/rejection.h"

namespace uplink::storage {

/// Quarantined numbers that one OpenStream returns, the lowest; further ones are read by pages
/// (Reader::Rejects), which holds up no commit.
inline constexpr std::size_t kOpenRejectsMax = 256;
/// Quarantined numbers of such a page.
inline constexpr std::size_t kRejectPageMax = 512;

/// A number that lies in quarantine, or is kept for its robot alone, and why.
struct StoredReject {
  model::Seq seq = 0;
  model::Rejection rejection;
};

/// Which rejected numbers of a session: those in (above, through], the first rows_max.
struct RejectsQuery {
  std::string ruri;
  model::SessionId session;
  model::Seq above = 0;
  model::Seq through = 0;
  std::size_t rows_max = kRejectPageMax;
};

}  // namespace uplink::storage

#include "server/journal/batch_shares.h"

namespace uplink::journal {

bool BatchShares::Admit(const Origin& origin) {
  Taken& taken = robots_[origin.client.get()];
  const bool over =
      taken.records >= share_.records_max || taken.bytes + origin.bytes > share_.bytes_max;
  taken.full = taken.full || (taken.records > 0 && over);
  if (taken.full) return false;
  ++taken.records;
  taken.bytes += origin.bytes;
  return true;
}

}  // namespace uplink::journal

#include "storage/postgres/write/stored_presence.h"

#include "storage/numbers.h"

namespace uplink::storage::postgres {
namespace {

constexpr std::string_view kReadPresence =
    "SELECT ruri, presence, changed_at FROM uplinkd.presence_latest WHERE ruri = ANY($1::text[])";

}  // namespace

StoreCall ReadPresenceCall(std::span<const std::string_view> ruris) {
  Array array{Type::kText};
  for (const std::string_view ruri : ruris) array.Text(ruri);
  return StoreCallOf(kReadPresence, {&array});
}

void TakePresence(const Result& rows,
                  const std::function<void(std::string_view ruri, StoredPresence)>& take) {
  for (int row = 0; row < rows.rows(); ++row) {
    take(rows.Bytes(row, 0), {PresenceOf(rows.Int(row, 1)), rows.Time(row, 2)});
  }
}

}  // namespace uplink::storage::postgres

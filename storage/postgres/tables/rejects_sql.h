#pragma once

#include <string_view>

namespace uplink::storage::postgres {

/// Joins the Rejects `q` (seq, reason, field, detail) of sessions, those in quarantine and the kept
/// ones, in no order. Follows `u` (ruri, session, above) and `s` (through, first_entry): numbers
/// are in (above, through], and first_entry is the session's first entry. Parameter 4: how many
/// rows to read of each of the two tables at most.
inline constexpr std::string_view kJoinRejects =
    " CROSS JOIN LATERAL ((SELECT p.seq, p.reason, p.field, p.detail FROM uplinkd.quarantine AS p"
    " WHERE p.ruri = u.ruri AND p.session = u.session AND p.seq > u.above"
    " AND p.seq <= s.through AND p.entry >= s.first_entry ORDER BY p.seq LIMIT $4::bigint)"
    " UNION ALL (SELECT n.seq, k.reason, k.field, k.detail FROM"
    " (SELECT p.first, p.last, p.reason, p.field, p.detail FROM uplinkd.kept_rejects AS p"
    " WHERE p.ruri = u.ruri AND p.session = u.session AND p.last > u.above"
    " AND p.entry >= s.first_entry ORDER BY p.last LIMIT $4::bigint) AS k"
    " CROSS JOIN LATERAL generate_series(greatest(k.first, u.above + 1),"
    " least(k.last, s.through)) AS n (seq) ORDER BY k.last, n.seq LIMIT $4::bigint)) AS q";

}  // namespace uplink::storage::postgres

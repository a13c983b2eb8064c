#pragma once

#include "storage/present.h"
#include "storage/sql_text.h"

namespace uplink::storage::postgres {

/// The value of `by_ms` that takes an entry whatever its expiry is.
inline constexpr std::string_view kAlwaysMs = "9223372036854775807";

/// The statements by which entries of one kind are found, counted and deleted. How the tables
/// differ is a row of a table in present_sql.cc. Arrays of entries are RURI and id, and the source
/// too if the kind has one.
struct PresentSql {
  bool has_source = false;
  /// Entries by their keys: RURI, id, source, time of expiry.
  SqlText read;
  /// $1: RURIs. Each with its number of entries.
  SqlText count;
  /// Entries by their keys. Of kinds that expire the last array says by when one must have expired
  /// to go; kAlwaysMs: whenever.
  SqlText remove;

  // Of kinds that expire alone.

  /// $1: RURIs, $2: upserts of each, $3: by when, $4: the bound. Entries as `read` has them that
  /// have expired by then, of the robots that may meet the bound. Their entries are counted only if
  /// some have.
  SqlText expired;
  /// $1: by when they expired, $2: how many rows at most.
  SqlText sweep;
};

[[nodiscard]] const PresentSql& PresentSqlOf(PresentKind kind);

}  // namespace uplink::storage::postgres

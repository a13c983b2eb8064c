#include "storage/postgres/tables/present_sql.h"

#include <array>

namespace uplink::storage::postgres {
namespace {

/// How a table of what is present differs from the others.
struct TableShape {
  std::string_view name;
  std::string_view id_column;
  /// Empty if the id alone is the key of a robot's row.
  std::string_view source_column;
  /// When the row `t` expires; empty: never.
  std::string_view expiry;
};

constexpr TableShape kFaults = {"faults_active", "fault_id", "source", ""};
constexpr TableShape kShapes = {"shapes", "id", "", "t.expires_ms"};
constexpr TableShape kObjects = {"objects", "id", "", "t.expires_ms"};

constexpr SqlText EntrySql(const TableShape& shape) {
  SqlText sql = {"SELECT t.ruri, t.", shape.id_column, ", "};
  sql.Add(shape.source_column.empty() ? "''::text" : "t.");
  sql.Add({shape.source_column, ", "});
  sql.Add(shape.expiry.empty() ? "0::bigint" : shape.expiry);
  return sql;
}

/// `t` is the row of the entry `u`.
constexpr SqlText MatchSql(const TableShape& shape) {
  SqlText sql = {"t.ruri = u.ruri AND t.", shape.id_column, " = u.id"};
  if (!shape.source_column.empty()) sql.Add({" AND t.", shape.source_column, " = u.source"});
  return sql;
}

constexpr PresentSql SqlOf(const TableShape& shape) {
  PresentSql sql;
  sql.has_source = !shape.source_column.empty();
  const SqlText entry = EntrySql(shape);
  const SqlText match = MatchSql(shape);
  const std::string_view keys =
      sql.has_source ? "unnest($1::text[], $2::text[], $3::text[]) AS u (ruri, id, source)"
                     : "unnest($1::text[], $2::text[]) AS u (ruri, id)";
  sql.read = {entry.view(), " FROM ",    keys,        " JOIN uplinkd.",
              shape.name,   " AS t ON ", match.view()};
  sql.count = {"SELECT u.ruri, (SELECT count(*) FROM uplinkd.", shape.name,
               " AS t WHERE t.ruri = u.ruri) FROM unnest($1::text[]) AS u (ruri)"};
  if (shape.expiry.empty()) {
    sql.remove = {
        "DELETE FROM uplinkd.", shape.name, " AS t USING ", keys, " WHERE ", match.view()};
    return sql;
  }
  sql.remove = {"DELETE FROM uplinkd.",
                shape.name,
                " AS t USING unnest($1::text[], $2::text[], $3::bigint[]) AS u (ruri, id, by_ms)",
                " WHERE ",
                match.view(),
                " AND (u.by_ms = ",
                kAlwaysMs,
                " OR (t.expires_ms <> 0 AND t.expires_ms <= u.by_ms))"};
  // CASE alone says which is looked at first.
  sql.expired = {entry.view(),
                 " FROM unnest($1::text[], $2::int[], $3::bigint[]) AS u (ruri, upserts, by_ms)",
                 " JOIN uplinkd.",
                 shape.name,
                 " AS t ON t.ruri = u.ruri AND t.expires_ms <> 0 AND t.expires_ms <= u.by_ms",
                 " WHERE CASE WHEN (SELECT min(e.expires_ms) FROM uplinkd.",
                 shape.name,
                 " AS e WHERE e.ruri = u.ruri AND e.expires_ms <> 0) <= u.by_ms",
                 " THEN u.upserts + (SELECT count(*) FROM uplinkd.",
                 shape.name,
                 " AS c WHERE c.ruri = u.ruri) > $4::bigint ELSE false END"};
  sql.sweep = {"DELETE FROM uplinkd.",
               shape.name,
               " AS t USING (SELECT ruri, id FROM uplinkd.",
               shape.name,
               " WHERE expires_ms <> 0 AND expires_ms <= $1::bigint ORDER BY expires_ms",
               " LIMIT $2::bigint) AS u WHERE ",
               match.view(),
               " AND t.expires_ms <> 0 AND t.expires_ms <= $1::bigint"};
  return sql;
}

/// In the order of PresentKind.
constexpr std::array<PresentSql, kPresentKinds> kSql = {SqlOf(kFaults), SqlOf(kShapes),
                                                        SqlOf(kObjects)};

}  // namespace

const PresentSql& PresentSqlOf(PresentKind kind) { return kSql[static_cast<std::size_t>(kind)]; }

}  // namespace uplink::storage::postgres

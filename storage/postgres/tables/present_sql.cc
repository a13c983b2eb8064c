#include "storage/postgres/tables/present_sql.h"

#include <array>

#include "storage/tables/present.h"

namespace uplink::storage::postgres {
namespace {

constexpr SqlText EntrySql(const PresentTable& shape) {
  SqlText sql = {"SELECT t.ruri, t.", shape.id_column, ", "};
  sql.Add(shape.source_column.empty() ? "''::text" : "t.");
  sql.Add({shape.source_column, ", "});
  sql.Add(shape.expiry_column.empty() ? "0::bigint" : "t.");
  sql.Add(shape.expiry_column);
  return sql;
}

/// `t` is the row of the entry `u`.
constexpr SqlText MatchSql(const PresentTable& shape) {
  SqlText sql = {"t.ruri = u.ruri AND t.", shape.id_column, " = u.id"};
  if (!shape.source_column.empty()) sql.Add({" AND t.", shape.source_column, " = u.source"});
  return sql;
}

constexpr PresentSql SqlOf(const PresentTable& shape) {
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
  if (shape.expiry_column.empty()) {
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
constexpr std::array<PresentSql, kPresentKinds> kSql = {
    SqlOf(kPresentTables[0]), SqlOf(kPresentTables[1]), SqlOf(kPresentTables[2])};

}  // namespace

const PresentSql& PresentSqlOf(PresentKind kind) { return kSql[static_cast<std::size_t>(kind)]; }

}  // namespace uplink::storage::postgres

#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <string_view>
#include <utility>

#include <absl/status/status.h>

namespace uplink::storage::sqlite {

class Database;

/// Ends each message about damage.
[[nodiscard]] std::string IfDamaged();

/// What a process found wrong with the content of a store's files, by any of its connections. The
/// first finding stands until the process ends: what SQLite reads next may look sound, and acks for
/// it would not last.
///
/// It leaves an empty file `<path>.damaged`, so that the next start reads the whole store before it
/// acks.
///
/// Thread: thread-safe.
class Damage final {
 public:
  explicit Damage(std::string path) : path_(std::move(path)) {}
  Damage(const Damage&) = delete;
  Damage& operator=(const Damage&) = delete;

  void Note(std::string what);

  /// Errors: kUnavailable once something was found, naming the file and what to do.
  [[nodiscard]] absl::Status status() const;

  /// `<path>.damaged`, which this process or an earlier one left.
  [[nodiscard]] std::string damaged_file() const { return path_ + ".damaged"; }

 private:
  const std::string path_;
  mutable std::mutex mutex_;
  std::string what_;
};

/// Connections of one process to one file report to the same; null: to none.
using DamagePtr = std::shared_ptr<Damage>;

/// SQLite deletes the WAL of an empty file as it opens it, with all that was acked since the last
/// checkpoint.
///
/// Errors: kFailedPrecondition where the file is empty or missing, and a WAL or a damaged_file()
///         lies beside it; nothing is changed then.
[[nodiscard]] absl::Status RefuseEmptied(const std::string& path);

/// The look at a whole store because of a damaged_file(). A value.
struct DamageCheck {
  enum class Step : std::uint8_t { kBegins, kSound, kFailed };
  Step step = Step::kBegins;
  /// Of the store's file: what there is to read.
  std::uint64_t bytes = 0;
};
/// Called with each step, as it is taken.
using OnDamageCheck = std::function<void(const DamageCheck&)>;

/// Reads the whole store, some seconds per GB, if there is a damaged_file(), and removes that if
/// the store is sound. Of a new connection, which reports its damage from then on. `told` may be
/// empty.
///
/// Errors: kFailedPrecondition if it is not sound; SQLite's own where it cannot be read.
[[nodiscard]] absl::Status RefuseDamage(Database& database, const OnDamageCheck& told);

}  // namespace uplink::storage::sqlite

#include "storage/sqlite/damage.h"

#include <filesystem>
#include <optional>
#include <system_error>
#include <utility>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include "schema/base/doc_page.h"
#include "storage/sqlite/database.h"

namespace uplink::storage::sqlite {

std::string IfDamaged() {
  return ". See " + DocPage("docs/operate/sqlite.md", "The file was overwritten or damaged");
}

void Damage::Note(std::string what) {
  {
    const std::lock_guard lock(mutex_);
    if (!what_.empty()) return;
    what_ = std::move(what);
  }
  // Without it (a full disk, a folder that only root may write) the next start checks nothing.
  const int file = ::open(damaged_file().c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0600);
  if (file >= 0) ::close(file);
}

absl::Status Damage::status() const {
  const std::lock_guard lock(mutex_);
  if (what_.empty()) return absl::OkStatus();
  std::string text = "store " + path_ + ": " + what_;
  text += ": nothing is acked until the server is started anew with a sound file";
  return absl::UnavailableError(text.append(IfDamaged()));
}

absl::Status RefuseEmptied(const std::string& path) {
  const auto bytes_of = [](const std::string& file) {
    struct stat found {};
    return ::stat(file.c_str(), &found) == 0 ? std::optional(found.st_size) : std::nullopt;
  };
  if (bytes_of(path).value_or(0) > 0) return absl::OkStatus();
  const std::string wal = path + "-wal";
  const std::string damaged = Damage(path).damaged_file();
  const bool has_wal = bytes_of(wal).value_or(0) > 0;
  if (!has_wal && !bytes_of(damaged)) return absl::OkStatus();
  std::string text =
      "store " + path + " is empty, or was missing, and " + (has_wal ? wal : damaged);
  text += " beside it says that it was not; to begin anew, move that file away";
  return absl::FailedPreconditionError(text.append(IfDamaged()));
}

absl::Status RefuseDamage(Database& database, const OnDamageCheck& told) {
  auto damage = std::make_shared<Damage>(database.path());
  if (::access(damage->damaged_file().c_str(), F_OK) != 0) return absl::OkStatus();
  std::error_code unknown;
  const std::uintmax_t bytes = std::filesystem::file_size(database.path(), unknown);
  const auto tell = [&](DamageCheck::Step step) {
    if (told) told({step, unknown ? 0 : std::uint64_t{bytes}});
  };
  database.ReportDamageTo(damage);
  tell(DamageCheck::Step::kBegins);
  const absl::StatusOr<std::string> found = database.ReadText("PRAGMA integrity_check(1)");
  const bool sound = found.ok() && *found == "ok";
  tell(sound ? DamageCheck::Step::kSound : DamageCheck::Step::kFailed);
  if (sound) {
    ::unlink(damage->damaged_file().c_str());
    return absl::OkStatus();
  }
  // Noted already, if it is damage.
  if (!found.ok()) return found.status();
  // So that its end moves no WAL into the file.
  damage->Note(*found);
  std::string text = "store " + database.path() + " is damaged: " + *found;
  return absl::FailedPreconditionError(text.append(IfDamaged()));
}

}  // namespace uplink::storage::sqlite

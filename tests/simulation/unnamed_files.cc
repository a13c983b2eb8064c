// Stands in for storage/sqlite/named_files.cc: a store that never looks at the names of its files.
#include "storage/sqlite/named_files.h"

namespace uplink::storage::sqlite {

absl::StatusOr<std::unique_ptr<NamedFiles>> NamedFiles::Note(Database& /*database*/) {
  return std::unique_ptr<NamedFiles>(new NamedFiles());
}

absl::Status NamedFiles::Check() const { return absl::OkStatus(); }

}  // namespace uplink::storage::sqlite

#pragma once

#include <string>

#include "tools/uplinkctl/ask/api.h"
#include "tools/uplinkctl/verbs/common.h"
#include "tools/uplinkctl/verbs/lists.h"

namespace uplink::ctl {

/// The rows in the format of the flags; JSON is one document with the members of the answer.
[[nodiscard]] std::string ListText(const List& list, const CommonFlags& flags, Rows rows,
                                   const RowTerms& terms);

/// Says on the screen if there are no rows, or further ones.
void NoteRows(const Rows& rows, const Screen& screen);

}  // namespace uplink::ctl

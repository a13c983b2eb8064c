#pragma once

#include <functional>
#include <string>

#include <absl/status/status.h>
#include <absl/status/statusor.h>
#include <boost/json.hpp>

#include "server/config/flags.h"
#include "tools/uplinkctl/ask/api.h"
#include "tools/uplinkctl/ask/server_choice.h"
#include "tools/uplinkctl/verbs/screen.h"

namespace uplink::ctl {

/// What every verb takes that asks a server. A value.
struct CommonFlags {
  ServerFlags server;
  std::string output = kTableWord;
  bool follow = false;

  [[nodiscard]] Format format() const { return FormatOf(output); }
};

/// What --config means where a server is asked.
inline constexpr const char* kConfigOfServer =
    "Which server: by its configuration file, which says where it listens";
/// The same where its store answers too.
inline constexpr const char* kConfigOfStore =
    "Which server: by its configuration file. If none answers, its store does";
/// Adds --token-file, --ca-file, --certificate-file and --key-file.
void AddAccessFlags(config::Flags& verb, AccessFiles& files);
/// Adds --server, --context, --config and those of AddAccessFlags.
void AddServerFlags(config::Flags& verb, ServerFlags& flags,
                    const char* about_config = kConfigOfServer);
/// Adds -o, and with `follows` --follow.
void AddOutputFlags(config::Flags& verb, CommonFlags& flags, bool follows);

/// What a verb does with a server and a screen.
using Work = std::function<absl::Status(Api& api, const Screen& screen)>;

/// Finds the server that the flags choose, lets `work` ask it, and prints its error. The exit code.
[[nodiscard]] int WithServer(const ServerFlags& flags, const Work& work);

/// The screen of this process.
[[nodiscard]] Screen ProcessScreen(const Clock& clock);

/// Shows something once, or with `follow` again after each wait: over itself on a terminal,
/// otherwise below a blank line. `text` asks anew each time. An error ends it only at the first
/// time; later it is a note.
[[nodiscard]] absl::Status ShowAgain(const Screen& screen, bool follow,
                                     const std::function<absl::StatusOr<std::string>()>& text);

/// One object in a format: fields with values, CSV, or JSON.
[[nodiscard]] std::string ObjectText(const boost::json::object& object, Format format,
                                     const Screen& screen);

/// JSON of a document: pretty, or with `follow` a line.
[[nodiscard]] std::string DocumentText(const boost::json::value& value, bool follow);

/// The form of a text that restricts an answer: an empty variable of a shell must not ask for
/// everything.
[[nodiscard]] config::FlagForm NotEmpty();

}  // namespace uplink::ctl

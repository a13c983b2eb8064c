#pragma once

#include <span>
#include <string>

namespace CLI {
class App;
class ParseError;
}  // namespace CLI

namespace uplink::config {

/// The command or flag among the arguments that the program does not have, as a sentence with the
/// nearest name that it has; empty if it has all of them. The library would first complain of what
/// is missing. `arguments` stand behind the program's name.
///
/// Thread: pure; any thread, as below.
[[nodiscard]] std::string UnknownName(const CLI::App& program,
                                      std::span<const char* const> arguments);

/// Why the library refused the arguments, as one sentence with a remedy. `program` has read them.
[[nodiscard]] std::string WrongUseText(const CLI::App& program, const CLI::ParseError& error);

}  // namespace uplink::config

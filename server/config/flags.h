#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace uplink::config {

/// A flag of a program: `--seed`, or a name without dashes for what is given by its position.
struct Flag {
  std::string name;
  std::string about = {};
  enum class Need : std::uint8_t { kOptional, kRequired };
  Need need = Need::kOptional;
};

/// The least and the most that a number may be.
struct FlagRange {
  double min = 0;
  double max = 0;
};

/// A way in which a text is written.
struct FlagForm {
  /// For the help: HOST:PORT.
  std::string name;
  /// What is wrong with a text; empty: nothing.
  std::function<std::string(const std::string& text)> problem;
};

/// The flags and commands of a program. Only flags.cc, flag_errors.cc and help_tree.cc include the
/// library that reads them, which costs as much to compile as a small program's own code. A value
/// that is added is its flag's default, which the help shows, and outlives Parse.
///
/// Thread: confined to one thread.
class Flags final {
 public:
  /// `program` is the name that the help gives; empty: as it was called. Without a `version` there
  /// is no --version.
  explicit Flags(const std::string& about, const std::string& program = {},
                 const std::string& version = {});
  ~Flags();
  Flags(const Flags&) = delete;
  Flags& operator=(const Flags&) = delete;

  /// A text; several of them, as a vector; or a number: an int, or unsigned of 16, 32 or 64 bits.
  template <typename Value>
  void Add(const Flag& flag, Value& value);
  /// An int, a double, or unsigned of 64 bits. A default out of range stands for none.
  template <typename Number>
  void Add(const Flag& flag, Number& value, const FlagRange& range);
  void Add(const Flag& flag, std::string& value, const FlagForm& form);
  /// One of `choices`.
  void AddChoice(const Flag& flag, std::string& value, const std::vector<std::string>& choices);
  /// The same, several times.
  void AddChoices(const Flag& flag, std::vector<std::string>& values,
                  const std::vector<std::string>& choices);
  /// True if it is given.
  void AddSwitch(const Flag& flag, bool& value);

  /// Of these flags, which were added before, at most one may be given.
  void AtMostOne(const std::vector<std::string>& names);
  /// Of these flags, which were added before, exactly one must be given; `group` is their heading
  /// in the help.
  void ExactlyOne(const std::string& group, const std::vector<std::string>& names);

  /// A word that chooses what the program does, with flags of its own. Where there are commands,
  /// one must be given; Parse calls the `run` of the innermost one.
  Flags& AddCommand(const std::string& name, const std::string& about,
                    std::function<int()> run = {});

  /// A line that the help shows below the flags: a call as it is typed.
  void Example(const std::string& line);

  using Complain = std::function<void(const std::string& text)>;
  /// Sets the values, and runs the command that is chosen. The exit code where the program is to
  /// end: the command's; 0 where help or version was asked for and printed; 2 where the use was
  /// wrong, and `complain` got the reason (without one: printed on standard error). The argument
  /// --help-tree alone, which the help leaves out, prints the help as JSON for tools/manual.
  [[nodiscard]] std::optional<int> Parse(int argc, const char* const* argv,
                                         const Complain& complain = {});
  /// Whether Parse found that flag.
  [[nodiscard]] bool Given(const std::string& name) const;

 private:
  struct Parser;
  const std::unique_ptr<Parser> parser_;
};

}  // namespace uplink::config

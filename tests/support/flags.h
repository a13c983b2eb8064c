#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace uplink::testing {

/// A flag of a program: `--seed`, or a name without dashes for what is given by its position.
struct Flag {
  std::string name;
  std::string about = {};
  enum class Need : std::uint8_t { kOptional, kRequired };
  Need need = Need::kOptional;
};

/// The least and the most that a number may be.
struct FlagRange {
  int min = 0;
  int max = 0;
};

/// The flags of a program that serves the tests: benchmarks, simulations, robots. Only flags.cc
/// includes the library that reads them, which costs as much to compile as such a program's own
/// code. A value that is added is its flag's default, and outlives Parse.
///
/// Thread: confined to one thread.
class Flags final {
 public:
  /// `program` is the name that the help gives; empty: as it was called.
  explicit Flags(const std::string& about, const std::string& program = {});
  ~Flags();
  Flags(const Flags&) = delete;
  Flags& operator=(const Flags&) = delete;

  void Add(const Flag& flag, std::string& value);
  /// May be given several times.
  void Add(const Flag& flag, std::vector<std::string>& values);
  /// One of `choices`.
  void AddChoice(const Flag& flag, std::string& value, const std::vector<std::string>& choices);
  /// The same, several times.
  void AddChoices(const Flag& flag, std::vector<std::string>& values,
                  const std::vector<std::string>& choices);
  /// True if it is given.
  void AddSwitch(const Flag& flag, bool& value);

  void Add(const Flag& flag, int& value);
  void Add(const Flag& flag, std::uint16_t& value);
  void Add(const Flag& flag, std::uint32_t& value);
  void Add(const Flag& flag, std::uint64_t& value);
  void Add(const Flag& flag, int& value, const FlagRange& range);
  void Add(const Flag& flag, std::uint64_t& value, const FlagRange& range);

  /// Sets the values. The exit code where the program is to end: help was asked for and printed, or
  /// the use was wrong and the reason printed.
  [[nodiscard]] std::optional<int> Parse(int argc, const char* const* argv);

 private:
  struct Parser;
  const std::unique_ptr<Parser> parser_;
};

}  // namespace uplink::testing

#include "tests/support/flags.h"

#include <CLI/CLI.hpp>

namespace uplink::testing {

struct Flags::Parser {
  Parser(const std::string& about, const std::string& program) : app(about, program) {}

  template <typename Value>
  CLI::Option* Add(const Flag& flag, Value& value) {
    return app.add_option(flag.name, value, flag.about)
        ->required(flag.need == Flag::Need::kRequired);
  }
  template <typename Number>
  void Add(const Flag& flag, Number& value, const FlagRange& range) {
    Add(flag, value)->check(CLI::Range(range.min, range.max));
  }

  CLI::App app;
};

Flags::Flags(const std::string& about, const std::string& program)
    : parser_(std::make_unique<Parser>(about, program)) {}

Flags::~Flags() = default;

void Flags::Add(const Flag& flag, std::string& value) { parser_->Add(flag, value); }

void Flags::Add(const Flag& flag, std::vector<std::string>& values) { parser_->Add(flag, values); }

void Flags::AddChoice(const Flag& flag, std::string& value,
                      const std::vector<std::string>& choices) {
  parser_->Add(flag, value)->check(CLI::IsMember(choices));
}

void Flags::AddChoices(const Flag& flag, std::vector<std::string>& values,
                       const std::vector<std::string>& choices) {
  parser_->Add(flag, values)->check(CLI::IsMember(choices));
}

void Flags::AddSwitch(const Flag& flag, bool& value) {
  parser_->app.add_flag(flag.name, value, flag.about);
}

void Flags::Add(const Flag& flag, int& value) { parser_->Add(flag, value); }

void Flags::Add(const Flag& flag, std::uint16_t& value) { parser_->Add(flag, value); }

void Flags::Add(const Flag& flag, std::uint32_t& value) { parser_->Add(flag, value); }

void Flags::Add(const Flag& flag, std::uint64_t& value) { parser_->Add(flag, value); }

void Flags::Add(const Flag& flag, int& value, const FlagRange& range) {
  parser_->Add(flag, value, range);
}

void Flags::Add(const Flag& flag, std::uint64_t& value, const FlagRange& range) {
  parser_->Add(flag, value, range);
}

std::optional<int> Flags::Parse(int argc, const char* const* argv) {
  try {
    parser_->app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return parser_->app.exit(error);
  }
  return std::nullopt;
}

}  // namespace uplink::testing

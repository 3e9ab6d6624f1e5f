#pragma once

#include <CLI/CLI.hpp>

namespace mbk::app {

/// What --help and --help-all say, as wide as the terminal. --help fits a screen: where a command has more to say, it
/// shows the options that stand in no section with a line each, names the sections, and gives the first examples.
class HelpFormatter : public CLI::Formatter {
 public:
  HelpFormatter();
  std::string make_help(const CLI::App* app, std::string name, CLI::AppFormatMode mode) const override;
  std::string make_option_desc(const CLI::Option* option) const override;
  std::string make_subcommand(const CLI::App* command) const override;

 private:
  std::size_t columns_;
};

}  // namespace mbk::app

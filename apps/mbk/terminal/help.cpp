#include "apps/mbk/terminal/help.h"

#include <unistd.h>

#include <CLI/CLI.hpp>
#include <memory>
#include <sstream>
#include <string>
#include <utility>

#include "apps/mbk/terminal/terminal.h"
#include "mbk/present/report/text.h"

namespace mbk::app {
namespace {

/// The parser's own help, with lines as wide as the terminal.
class HelpFormatter : public CLI::Formatter {
 public:
  HelpFormatter() { column_width(columns_ < kNarrow ? 24 : 30); }

  std::string make_help(const CLI::App* app, std::string name, CLI::AppFormatMode /*all*/) const override {
    return fitted(Formatter::make_help(app, std::move(name), CLI::AppFormatMode::Normal), columns_);
  }

  std::string make_option_desc(const CLI::Option* option) const override { return wrapped(option->get_description()); }

  std::string make_subcommand(const CLI::App* command) const override {
    std::stringstream out;
    CLI::detail::format_help(out, command->get_display_name(true), wrapped(command->get_description()), column_width_);
    return out.str();
  }

 private:
  static constexpr std::size_t kNarrow = 80;

  [[nodiscard]] std::string wrapped(const std::string& text) const {
    return report::wrapped(text, columns_ - column_width_);
  }

  std::size_t columns_ = terminal_at(STDOUT_FILENO).columns;
};

}  // namespace

void add_help(Command app) {
  app.cli().formatter(std::make_shared<HelpFormatter>());
  app.cli().set_help_all_flag("--help-all", "print every option, in sections, with all there is to say");
}

}  // namespace mbk::app

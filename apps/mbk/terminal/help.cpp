#include "apps/mbk/terminal/help.h"

#include <CLI/CLI.hpp>
#include <memory>
#include <sstream>
#include <string>
#include <utility>

#include "apps/mbk/terminal/command_tree.h"
#include "apps/mbk/terminal/terminal.h"
#include "mbk/base/system/terminal.h"
#include "mbk/present/report/text.h"

namespace mbk::app {
namespace {

/// The parser's own help, with lines as wide as the terminal.
class HelpFormatter : public CLI::Formatter {
 public:
  HelpFormatter() { column_width(columns_ < kNarrow ? 24 : 30); }

  std::string make_help(const CLI::App* app, std::string name, CLI::AppFormatMode /*all*/) const override {
    const std::string help = Formatter::make_help(app, std::move(name), CLI::AppFormatMode::Normal);
    return fitted(CLI::detail::find_and_replace(help, "\n\n\n", "\n\n"), columns_);
  }

  std::string make_option_name(const CLI::Option* option, bool positional) const override {
    std::string name = Formatter::make_option_name(option, positional);
    return name.substr(0, name.find('{'));  // a flag that sets false is called "--no-measure{false}"
  }

  /// The value alone. Which arguments are required is visible in the usage line; what an option needs and excludes is
  /// in its description.
  std::string make_option_opts(const CLI::Option* option) const override {
    if (option->get_type_size() == 0 || option->get_positional()) return "";
    const std::string& text = option->get_option_text();
    const bool several = option->get_expected_max() == CLI::detail::expected_max_vector_size;
    return " " + (text.empty() ? option->get_type_name() : text) + (several ? " ..." : "");
  }

  std::string make_option_desc(const CLI::Option* option) const override {
    return wrapped(option->get_description() + conditions_of(*option));
  }

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

  std::size_t columns_ = terminal_at(system::kOutput).columns;
};

}  // namespace

void add_help(Command app) {
  app.cli().formatter(std::make_shared<HelpFormatter>());
  app.cli().set_help_all_flag(kHelpAll)->group("");
}

}  // namespace mbk::app

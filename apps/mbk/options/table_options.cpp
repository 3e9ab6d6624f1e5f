#include "apps/mbk/options/table_options.h"

#include <utility>

namespace mbk::app {
namespace {

Option add(Command command, const OptionFacts& facts, std::function<void(const std::vector<std::string>&)> take) {
  if (facts.value.empty()) {
    return command.add_flag_callback(
        facts.name, [take = std::move(take)] { take({}); }, facts.help);
  }
  if (facts.takes_several) {
    return command.add_option_function(facts.name, take, facts.help).delimiter(',').allow_extra_args(false);
  }
  if (facts.repeats) return command.add_option_function(facts.name, take, facts.help).allow_extra_args(false);
  const auto take_one = [take = std::move(take)](const std::string& value) { take({value}); };
  return command.add_option_function(facts.name, take_one, facts.help);
}

}  // namespace

Option add_table_option(Command command, const OptionFacts& facts,
                        std::function<void(const std::vector<std::string>&)> take) {
  const Option option = add(command, facts, std::move(take));
  if (!facts.value.empty()) option.type_name(facts.value);
  if (facts.check.wrong || !facts.check.words.empty()) option.check(facts.check);
  if (!facts.group.empty()) option.group(facts.group);
  if (!facts.needs.empty()) option.needs(command.get_option(facts.needs));
  if (!facts.excludes.empty()) option.excludes(command.get_option(facts.excludes));
  return option;
}

}  // namespace mbk::app

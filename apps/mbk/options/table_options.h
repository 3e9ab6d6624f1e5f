#pragma once

#include <functional>
#include <string>
#include <vector>

#include "apps/mbk/terminal/command.h"
#include "mbk/base/core/option_table.h"

namespace mbk::app {

/// Adds an option as a row of a table describes it.   @param take  gets its values; none of a flag
Option add_table_option(Command command, const OptionFacts& facts,
                        std::function<void(const std::vector<std::string>&)> take);

/// Adds every option of a table that the command does not have yet; the values go into `options`.
template <class Options, class Into>
void add_options(Command command, const OptionTable<Options>& table, Into& options) {
  for (const auto& row : table.rows()) {
    if (command.find_option(row.facts.name)) continue;
    add_table_option(command, row.facts, [&into = static_cast<Options&>(options), set = row.set](const auto& values) {
      set(into, values);
    });
  }
}

/// Adds the options that most people need, in this order and before the sections of --help; add_options adds the rest.
template <class Options, class Into>
void add_main_options(Command command, const OptionTable<Options>& table, Into& options,
                      std::initializer_list<const char*> names) {
  for (const char* const name : names) {
    const auto& row = *table.find(name);
    OptionFacts facts = row.facts;
    facts.group.clear();
    add_table_option(command, facts, [&into = static_cast<Options&>(options), set = row.set](const auto& values) {
      set(into, values);
    });
  }
}

/// Adds a single option.
template <class Value>
void add_option(Command command, const OptionFacts& facts, Value& into) {
  add_table_option(command, facts, [&into](const auto& values) { option_values::set(into, values, 1.0); });
}

/// Those options of a table that were given to `command`.
template <class Options>
OptionTexts given_options(Command command, const OptionTable<Options>& table) {
  OptionTexts given;
  for (const auto& row : table.rows()) {
    const auto option = command.find_option(row.facts.name);
    if (option && option->is_given()) given[row.facts.name] = option->values();
  }
  return given;
}

}  // namespace mbk::app

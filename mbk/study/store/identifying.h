#pragma once

#include <map>
#include <string>
#include <vector>

namespace mbk::store {

/// The entries of a recording's metadata whose names say that they tell who the person is: names of people, dates of
/// birth, numbers of patients, addresses; and a rater that is not a code (rater_code()). What other values say is not
/// looked at: it cannot be decided.
[[nodiscard]] std::vector<std::string> identifying_entries(const std::map<std::string, std::string>& metadata);

}  // namespace mbk::store

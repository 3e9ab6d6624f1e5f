#include "mbk/measure/preprocess/recorded_handle_mass.h"

#include <charconv>
#include <string>

#include "mbk/base/core/nan.h"

namespace mbk::preprocess {

std::optional<double> recorded_handle_mass(const Recording& recording) {
  const auto found = recording.metadata.find("handle_mass_kg");
  if (found == recording.metadata.end() || found->second.empty()) return std::nullopt;
  const std::string& text = found->second;
  double mass = 0.0;
  const auto [stop, error] = std::from_chars(text.data(), text.data() + text.size(), mass);
  const bool number = error == std::errc() && stop == text.data() + text.size();
  return number ? mass : kNaN;
}

}  // namespace mbk::preprocess

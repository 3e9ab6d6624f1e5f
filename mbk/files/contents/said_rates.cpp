#include "mbk/files/contents/said_rates.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <map>
#include <utility>

namespace mbk::recording {
namespace {

constexpr double kLowest = 1e-9, kHighest = 1e9;  ///< of a rate or a period
constexpr double kSame = 1e-6;                    ///< relative tolerance of rates stated twice

/// The small letters and digits of a name: "samplingrate" of "Sampling_Rate".
std::string letters_of(std::string_view name) {
  std::string letters;
  for (const char c : name) {
    if (c >= 'A' && c <= 'Z') {
      letters += static_cast<char>(c + ('a' - 'A'));
    } else if ((c >= 'a' && c <= 'z') || (c >= '0' && c <= '9')) {
      letters += c;
    }
  }
  return letters;
}

/// "trial" of "trial.fs" and "trial/fs"; "" of "fs".
std::string_view scope_of(std::string_view name) {
  const auto end = name.find_last_of("./");
  return end == name.npos ? std::string_view() : name.substr(0, end);
}

}  // namespace

std::optional<double> rate_called(std::string_view name, double number, std::string_view unit) {
  constexpr auto kRates = std::to_array<std::string_view>({"fs", "rate", "srate", "sfreq", "samplerate", "samplingrate",
                                                           "samplefrequency", "samplingfrequency", "samplefreq",
                                                           "samplingfreq", "samplespersecond", "acquisitionrate"});
  constexpr auto kPeriods = std::to_array<std::string_view>(
      {"dt", "sampletime", "sampleperiod", "samplingperiod", "sampleinterval", "samplinginterval"});
  std::string letters = letters_of(name), in = letters_of(unit);
  for (const std::string_view ending : {"khz", "hz"}) {
    if (!letters.ends_with(ending)) continue;
    if (in.empty()) in = ending;
    letters.resize(letters.size() - ending.size());
    break;
  }
  if (!(number > kLowest) || !(number < kHighest)) return std::nullopt;
  if (std::ranges::find(kRates, letters) != kRates.end()) {
    if (in.empty() || in == "hz" || in == "hertz" || in == "1s" || in == "s1" || in == "samplespersecond") {
      return number;
    }
    return in == "khz" || in == "kilohertz" ? std::optional(1000.0 * number) : std::nullopt;
  }
  if (std::ranges::find(kPeriods, letters) == kPeriods.end()) return std::nullopt;
  constexpr double kLongest = 0.02, kShortest = 1e-5;  // of milliseconds, these would be 50 kHz and more
  const bool seconds = in == "s" || in == "sec" || in == "second" || in == "seconds";
  if (seconds || (in.empty() && number >= kShortest && number <= kLongest)) return 1.0 / number;
  return in == "ms" || in == "milliseconds" ? std::optional(1000.0 / number) : std::nullopt;
}

void give_rates(Contents& contents, std::vector<SaidRate> said) {
  if (contents.table) return;
  for (const Array& array : contents.arrays) {
    if (array.values.size() != 1 || array.signal) continue;
    const std::string_view scope = scope_of(array.name);
    const auto rate = rate_called(std::string_view(array.name).substr(scope.empty() ? 0 : scope.size() + 1),
                                  array.values(0, 0), array.unit);
    if (rate) said.push_back({std::string(scope), fmt::format("'{}'", array.name), *rate});
  }
  struct OfScope {
    SaidRate rate;
    std::optional<SaidRate> other;  ///< that differs
    bool noted = false;
  };
  std::map<std::string, OfScope, std::less<>> scopes;
  for (SaidRate& one : said) {
    const auto [place, is_new] = scopes.try_emplace(one.scope, OfScope{one, {}});
    OfScope& known = place->second;
    if (!is_new && std::abs(one.hz - known.rate.hz) > kSame * known.rate.hz) known.other = std::move(one);
  }
  for (Array& array : contents.arrays) {
    if (scopes.empty() || array.rate_hz > 0.0 || array.values.size() < 2 || array.clock >= 0) continue;
    std::string_view scope = array.name;
    auto nearest = scopes.end();
    while (nearest == scopes.end() && !scope.empty()) {
      scope = scope_of(scope);
      nearest = scopes.find(scope);
    }
    if (nearest == scopes.end()) continue;
    auto& [rate, other, noted] = nearest->second;
    if (!other) array.rate_hz = rate.hz;
    if (std::exchange(noted, true)) continue;
    contents.notes.push_back(other ? fmt::format("{} states a rate of {} Hz and {} a rate of {} Hz; neither was used",
                                                 rate.source, rate.hz, other->source, other->hz)
                                   : fmt::format("the sample rate{} is {} Hz, from {}",
                                                 rate.scope.empty() ? "" : fmt::format(" of '{}'", rate.scope), rate.hz,
                                                 rate.source));
  }
}

}  // namespace mbk::recording

#include "mbk/files/c3d/c3d_parameters.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <limits>

#include "mbk/base/core/printable.h"

namespace mbk::recording {
namespace {

constexpr std::size_t kSectionHeader = 4;
constexpr std::size_t kMaxDimensions = 7;

double vax_real(std::uint32_t words) {
  const std::uint32_t bits = words << 16u | words >> 16u;  // the word with sign and exponent comes first
  const bool negative = bits >> 31u != 0;
  const int exponent = static_cast<int>(bits >> 23u & 0xFFu);
  if (exponent == 0) return negative ? std::numeric_limits<double>::quiet_NaN() : 0.0;
  const double magnitude = std::ldexp(static_cast<double>((bits & 0x7FFFFFu) | 0x800000u), exponent - 128 - 24);
  return negative ? -magnitude : magnitude;
}

std::string capitals(std::string text) {
  for (char& c : text) c = c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c;
  return text;
}

std::string trimmed(const std::string& text) {
  const auto first = text.find_first_not_of(' ');
  if (first == text.npos) return {};
  return text.substr(first, text.find_last_not_of(' ') - first + 1);
}

bool is_type(int type) {
  return type == -1 || type == 1 || type == 2 || type == 4;
}

std::size_t count_of(const C3dParameter& parameter) {
  return parameter.data.view.size() / static_cast<std::size_t>(std::abs(static_cast<int>(parameter.type)));
}

double value_at(const C3dParameter& parameter, std::size_t i, bool unsigned_words) {
  switch (parameter.type) {
    case C3dParameter::Type::real:
      return parameter.data.real(4 * i);
    case C3dParameter::Type::word:
      return unsigned_words ? parameter.data.word(2 * i) : parameter.data.signed_word(2 * i);
    default:
      return parameter.data.view.at<std::uint8_t>(i);
  }
}

/// Type, dimensions and data of a parameter at `offset`.
Result<C3dParameter> parameter_at(const C3dBytes& file, std::size_t offset, std::string_view name) {
  const std::string where = fmt::format("parameter {}", name);
  const auto short_of = [&] {
    return bad_data("it extends beyond the parameter section", std::string(kC3dRemedy), where);
  };
  if (!file.view.holds(offset, 2)) return short_of();
  const int type = file.view.at<std::int8_t>(offset);
  const std::size_t count = file.view.at<std::uint8_t>(offset + 1);
  if (!is_type(type)) return bad_data(fmt::format("unknown type {}", type), std::string(kC3dRemedy), where);
  if (count > kMaxDimensions) {
    return bad_data(fmt::format("it has {} dimensions; the maximum is {}", count, kMaxDimensions),
                    std::string(kC3dRemedy), where);
  }
  if (!file.view.holds(offset + 2, count)) return short_of();
  C3dParameter parameter{C3dParameter::Type{static_cast<std::int8_t>(type)}, {}, file};
  std::uint64_t size = static_cast<std::uint64_t>(std::abs(type));
  for (std::size_t k = 0; k < count; ++k) {
    parameter.dimensions.push_back(file.view.at<std::uint8_t>(offset + 2 + k));
    size *= parameter.dimensions.back();
  }
  if (!file.view.holds(offset + 2 + count, size)) return short_of();
  parameter.data = file.part(offset + 2 + count, static_cast<std::size_t>(size));
  return parameter;
}

}  // namespace

C3dBytes::C3dBytes(std::span<const std::byte> bytes, C3dProcessor made_by)
    : view{bytes, (made_by == C3dProcessor::sgi) == (std::endian::native == std::endian::little)}, processor(made_by) {}

double C3dBytes::real(std::size_t offset) const {
  const auto bits = view.at<std::uint32_t>(offset);
  return processor == C3dProcessor::dec ? vax_real(bits) : static_cast<double>(std::bit_cast<float>(bits));
}

C3dBytes C3dBytes::part(std::size_t offset, std::size_t count) const {
  return {view.bytes.subspan(offset, count), processor};
}

Result<C3dParameters> C3dParameters::read(const C3dBytes& file, std::size_t begin, std::size_t end) {
  std::map<int, std::string> group_names;
  std::map<std::pair<int, std::string>, C3dParameter> found;
  C3dParameters parameters;
  parameters.begin_ = begin;
  parameters.end_ = begin + kSectionHeader;
  for (std::size_t at = parameters.end_; at < end;) {
    const auto damaged = [&](std::string_view what) {
      return bad_data(fmt::format("{} at byte {} of the parameter section", what, at - begin - kSectionHeader),
                      std::string(kC3dRemedy));
    };
    parameters.terminated_ = true;
    if (!file.view.holds(at, 1)) return damaged("the file ends");
    const auto name_size = static_cast<std::size_t>(std::abs(int{file.view.at<std::int8_t>(at)}));  // < 0: locked
    if (name_size == 0) break;
    if (!file.view.holds(at, 2 + name_size + 2)) return damaged("the file ends");
    const int id = file.view.at<std::int8_t>(at + 1);
    std::string name = capitals(printable(file.view.part(at + 2, name_size).padded_text()));
    const std::size_t link = at + 2 + name_size;  // the distance to the next record, from here
    const std::size_t distance = file.word(link);
    std::size_t content_end = link + 2;
    if (id < 0) {
      group_names.try_emplace(-id, std::move(name));
    } else {
      auto parameter = MBK_TRY(parameter_at(file, link + 2, name));
      content_end += 2 + parameter.dimensions.size() + parameter.data.view.size();
      found.try_emplace({id, std::move(name)}, std::move(parameter));
    }
    parameters.end_ = std::min(content_end, end);
    if (distance == 0) break;
    if (link + distance < content_end) return damaged("a record has an invalid link to the next");
    at = link + distance;
    parameters.terminated_ = false;
  }
  for (auto& [key, parameter] : found) {  // a group's record may follow its parameters
    const auto group = group_names.find(key.first);
    if (group != group_names.end()) parameters.groups_[group->second].try_emplace(key.second, std::move(parameter));
  }
  return parameters;
}

const C3dParameter* C3dParameters::find(std::string_view group, std::string_view name) const {
  const auto parameters = groups_.find(group);
  if (parameters == groups_.end()) return nullptr;
  const auto parameter = parameters->second.find(name);
  return parameter == parameters->second.end() ? nullptr : &parameter->second;
}

template <class Use>
void C3dParameters::for_each_part(std::string_view group, std::string_view name, const Use& use) const {
  const C3dParameter* part = find(group, name);
  for (int k = 2; part != nullptr; ++k) {
    use(*part);
    part = find(group, fmt::format("{}{}", name, k));
  }
}

std::optional<double> C3dParameters::number(std::string_view group, std::string_view name) const {
  const C3dParameter* parameter = find(group, name);
  if (parameter == nullptr || parameter->type == C3dParameter::Type::text || count_of(*parameter) == 0) return {};
  return value_at(*parameter, 0, true);
}

std::vector<double> C3dParameters::numbers(std::string_view group, std::string_view name, bool unsigned_words) const {
  std::vector<double> values;
  for_each_part(group, name, [&](const C3dParameter& part) {
    if (part.type == C3dParameter::Type::text) return;
    for (std::size_t i = 0; i < count_of(part); ++i) values.push_back(value_at(part, i, unsigned_words));
  });
  return values;
}

std::vector<double> C3dParameters::numbers_in_digits(std::string_view group, std::string_view name) const {
  std::vector<double> values;
  for (const std::string& text : texts(group, name)) {
    const char* const end = text.data() + text.size();
    const auto read = std::from_chars(text.data(), end, values.emplace_back());
    if (read.ec != std::errc() || read.ptr != end) return {};
  }
  return values;
}

std::vector<std::string> C3dParameters::texts(std::string_view group, std::string_view name) const {
  std::vector<std::string> texts;
  for_each_part(group, name, [&](const C3dParameter& part) {
    if (part.type != C3dParameter::Type::text) return;
    const std::size_t each = part.dimensions.empty() ? 1 : part.dimensions.front();
    for (std::size_t at = 0; each > 0 && at < part.data.view.size(); at += each) {
      texts.push_back(trimmed(printable(part.data.view.part(at, each).padded_text())));
    }
  });
  return texts;
}

std::vector<std::string_view> C3dParameters::groups() const {
  std::vector<std::string_view> names;
  for (const auto& [name, parameters] : groups_) names.push_back(name);
  return names;
}

std::vector<std::string_view> C3dParameters::names(std::string_view group) const {
  std::vector<std::string_view> names;
  const auto parameters = groups_.find(group);
  if (parameters == groups_.end()) return names;
  for (const auto& [name, parameter] : parameters->second) names.push_back(name);
  return names;
}

}  // namespace mbk::recording

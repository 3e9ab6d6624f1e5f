#pragma once

#include <Eigen/Core>
#include <array>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <tuple>
#include <type_traits>
#include <utility>
#include <vector>

/// Values as CBOR, for results that another process computes: every digit of a number stays. Numbers, enumerations,
/// strings, std::vector, array, pair, tuple, map, optional, matrices of Eigen, and structs of these without
/// constructors, whose members the compiler finds.
namespace mbk::batch {

namespace value_detail {

template <class Type, template <class...> class Template>
inline constexpr bool kIs = false;
template <template <class...> class Template, class... Arguments>
inline constexpr bool kIs<Template<Arguments...>, Template> = true;

/// Defined nowhere, so that a program in which a stand-in for a member came to be called cannot be linked.
[[noreturn]] void stand_in_is_called();

/// Stands for a member of any type but std::optional, which could also be made of what it holds.
struct AnyMember {
  template <class Type>
  requires(!kIs<Type, std::optional>) operator Type() const {  // NOLINT(google-explicit-constructor)
    stand_in_is_called();
  }
};
struct OptionalMember {
  template <class Type>
  requires(kIs<Type, std::optional>) operator Type() const {  // NOLINT(google-explicit-constructor)
    stand_in_is_called();
  }
};

template <class Struct, class... Members>
concept MadeOf = requires {
  Struct{std::declval<Members>()...};
};

/// How many members a struct has: one after the other is tried.
template <class Struct, class... Members>
consteval std::size_t member_count() {
  if constexpr (MadeOf<Struct, Members..., AnyMember>) {
    return member_count<Struct, Members..., AnyMember>();
  } else if constexpr (MadeOf<Struct, Members..., OptionalMember>) {
    return member_count<Struct, Members..., OptionalMember>();
  } else {
    return sizeof...(Members);
  }
}

/// The members of a struct, by reference. A wrong count does not compile.
template <class Struct>
auto members(Struct& s) {
  constexpr std::size_t kCount = member_count<std::remove_const_t<Struct>>();
  // clang-format off
#define MBK_MEMBERS(count, ...) \
  if constexpr (kCount == (count)) { auto& [__VA_ARGS__] = s; return std::tie(__VA_ARGS__); } else
  MBK_MEMBERS(1, a)
  MBK_MEMBERS(2, a, b)
  MBK_MEMBERS(3, a, b, c)
  MBK_MEMBERS(4, a, b, c, d)
  MBK_MEMBERS(5, a, b, c, d, e)
  MBK_MEMBERS(6, a, b, c, d, e, f)
  MBK_MEMBERS(7, a, b, c, d, e, f, g)
  MBK_MEMBERS(8, a, b, c, d, e, f, g, h)
  MBK_MEMBERS(9, a, b, c, d, e, f, g, h, i)
  MBK_MEMBERS(10, a, b, c, d, e, f, g, h, i, j)
  MBK_MEMBERS(11, a, b, c, d, e, f, g, h, i, j, k)
  MBK_MEMBERS(12, a, b, c, d, e, f, g, h, i, j, k, l)
  MBK_MEMBERS(13, a, b, c, d, e, f, g, h, i, j, k, l, m)
  MBK_MEMBERS(14, a, b, c, d, e, f, g, h, i, j, k, l, m, n)
  MBK_MEMBERS(15, a, b, c, d, e, f, g, h, i, j, k, l, m, n, o)
  MBK_MEMBERS(16, a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p)
  MBK_MEMBERS(17, a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p, q)
  MBK_MEMBERS(18, a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p, q, r)
  MBK_MEMBERS(19, a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p, q, r, t)
  MBK_MEMBERS(20, a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p, q, r, t, u)
  MBK_MEMBERS(21, a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p, q, r, t, u, v)
  MBK_MEMBERS(22, a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p, q, r, t, u, v, w)
  MBK_MEMBERS(23, a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p, q, r, t, u, v, w, x)
  MBK_MEMBERS(24, a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p, q, r, t, u, v, w, x, y)
  MBK_MEMBERS(25, a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p, q, r, t, u, v, w, x, y, z)
  MBK_MEMBERS(26, a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p, q, r, t, u, v, w, x, y, z, A)
  MBK_MEMBERS(27, a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p, q, r, t, u, v, w, x, y, z, A, B)
  MBK_MEMBERS(28, a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p, q, r, t, u, v, w, x, y, z, A, B, C)
  MBK_MEMBERS(29, a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p, q, r, t, u, v, w, x, y, z, A, B, C, D)
  MBK_MEMBERS(30, a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p, q, r, t, u, v, w, x, y, z, A, B, C, D, E)
  MBK_MEMBERS(31, a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p, q, r, t, u, v, w, x, y, z, A, B, C, D, E, F)
#undef MBK_MEMBERS
  static_assert(kCount == 0, "a struct of that many members is not listed here");
  // clang-format on
}

template <class Type>
inline constexpr bool kIsArray = false;
template <class Type, std::size_t kSize>
inline constexpr bool kIsArray<std::array<Type, kSize>> = true;

template <class Type>
concept Sequence = kIs<Type, std::vector> || kIs<Type, std::map> || kIsArray<Type>;

template <class Type>
concept EigenMatrix = requires(Type matrix) {
  matrix.derived().rows();
  matrix.data();
};

/// A number with a type of its own, such as Hertz.
template <class Type>
concept Quantity = !std::is_aggregate_v<Type> && sizeof(Type) == sizeof(double) && requires(Type quantity) {
  { quantity.value } -> std::same_as<double&>;
};

using Json = nlohmann::json;

/// References to what a struct, a pair or a tuple holds.
template <class Type>
auto parts(Type& value) {
  using Plain = std::remove_const_t<Type>;
  if constexpr (kIs<Plain, std::pair> || kIs<Plain, std::tuple>) {
    return std::apply([](auto&... one) { return std::tie(one...); }, value);
  } else {
    static_assert(std::is_aggregate_v<Plain>, "only structs without constructors");
    return members(value);
  }
}

template <class Type>
Json written(const Type& value) {
  if constexpr (std::is_enum_v<Type>) {
    return static_cast<std::underlying_type_t<Type>>(value);
  } else if constexpr (std::is_arithmetic_v<Type> || std::is_same_v<Type, std::string>) {
    return value;
  } else if constexpr (Quantity<Type>) {
    return value.value;
  } else {
    Json list = Json::array();
    if constexpr (Sequence<Type>) {
      for (const auto& one : value) list.push_back(written<typename Type::value_type>(one));
    } else if constexpr (kIs<Type, std::optional>) {
      if (value) list.push_back(written(*value));
    } else if constexpr (EigenMatrix<Type>) {
      list = {value.rows(), value.cols()};
      for (Eigen::Index k = 0; k < value.size(); ++k) list.push_back(value.data()[k]);
    } else {
      std::apply([&](const auto&... one) { (list.push_back(written(one)), ...); }, parts(value));
    }
    return list;
  }
}

/// Throws what nlohmann::json throws where something else was written.
template <class Type>
void read(const Json& json, Type& value) {
  if constexpr (std::is_enum_v<Type>) {
    value = static_cast<Type>(json.get<std::underlying_type_t<Type>>());
  } else if constexpr (std::is_arithmetic_v<Type> || std::is_same_v<Type, std::string>) {
    json.get_to(value);
  } else if constexpr (Quantity<Type>) {
    json.get_to(value.value);
  } else if constexpr (kIs<Type, std::vector>) {
    value.clear();
    for (const Json& one : json) {
      typename Type::value_type entry{};
      read(one, entry);
      value.push_back(std::move(entry));
    }
  } else if constexpr (kIs<Type, std::map>) {
    value.clear();
    for (const Json& one : json) {
      std::pair<typename Type::key_type, typename Type::mapped_type> entry;
      read(one, entry);
      value.insert(std::move(entry));
    }
  } else if constexpr (kIsArray<Type>) {
    for (std::size_t k = 0; k < value.size(); ++k) read(json.at(k), value[k]);
  } else if constexpr (kIs<Type, std::optional>) {
    value.reset();
    if (!json.empty()) read(json.at(0), value.emplace());
  } else if constexpr (EigenMatrix<Type>) {
    const auto rows = json.at(0).get<std::uint32_t>(), columns = json.at(1).get<std::uint32_t>();
    if (std::uint64_t{rows} * columns != json.size() - 2) {
      throw Json::other_error::create(0, "a matrix has another size", &json);
    }
    value.resize(static_cast<Eigen::Index>(rows), static_cast<Eigen::Index>(columns));
    for (Eigen::Index k = 0; k < value.size(); ++k) json.at(static_cast<std::size_t>(k) + 2).get_to(value.data()[k]);
  } else {
    std::size_t k = 0;
    std::apply([&](auto&... one) { (read(json.at(k++), one), ...); }, parts(value));
  }
}

}  // namespace value_detail

template <class Type>
std::string to_bytes(const Type& value) {
  std::string bytes;
  nlohmann::json::to_cbor(value_detail::written(value), bytes);
  return bytes;
}

/// @returns  whether the bytes hold such a value, and nothing else
template <class Type>
bool from_bytes(std::string_view bytes, Type& value) {
  try {
    value_detail::read(nlohmann::json::from_cbor(bytes), value);
    return true;
  } catch (const nlohmann::json::exception&) {
    return false;
  }
}

}  // namespace mbk::batch

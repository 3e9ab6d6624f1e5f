#pragma once

#include <Eigen/Core>
#include <array>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <tuple>
#include <type_traits>
#include <utility>
#include <vector>

/// Values as bytes, for results that another process computes: every bit of a number stays. Numbers, enumerations,
/// strings, std::vector, array, pair, tuple, map, optional, matrices of Eigen, and structs of these without
/// constructors, whose members are found by the compiler.
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
  if constexpr (kCount == 1) {
    auto& [a] = s;
    return std::tie(a); }
  else if constexpr (kCount == 2) {
    auto& [a, b] = s;
    return std::tie(a, b); }
  else if constexpr (kCount == 3) {
    auto& [a, b, c] = s;
    return std::tie(a, b, c); }
  else if constexpr (kCount == 4) {
    auto& [a, b, c, d] = s;
    return std::tie(a, b, c, d); }
  else if constexpr (kCount == 5) {
    auto& [a, b, c, d, e] = s;
    return std::tie(a, b, c, d, e); }
  else if constexpr (kCount == 6) {
    auto& [a, b, c, d, e, f] = s;
    return std::tie(a, b, c, d, e, f); }
  else if constexpr (kCount == 7) {
    auto& [a, b, c, d, e, f, g] = s;
    return std::tie(a, b, c, d, e, f, g); }
  else if constexpr (kCount == 8) {
    auto& [a, b, c, d, e, f, g, h] = s;
    return std::tie(a, b, c, d, e, f, g, h); }
  else if constexpr (kCount == 9) {
    auto& [a, b, c, d, e, f, g, h, i] = s;
    return std::tie(a, b, c, d, e, f, g, h, i); }
  else if constexpr (kCount == 10) {
    auto& [a, b, c, d, e, f, g, h, i, j] = s;
    return std::tie(a, b, c, d, e, f, g, h, i, j); }
  else if constexpr (kCount == 11) {
    auto& [a, b, c, d, e, f, g, h, i, j, k] = s;
    return std::tie(a, b, c, d, e, f, g, h, i, j, k); }
  else if constexpr (kCount == 12) {
    auto& [a, b, c, d, e, f, g, h, i, j, k, l] = s;
    return std::tie(a, b, c, d, e, f, g, h, i, j, k, l); }
  else if constexpr (kCount == 13) {
    auto& [a, b, c, d, e, f, g, h, i, j, k, l, m] = s;
    return std::tie(a, b, c, d, e, f, g, h, i, j, k, l, m); }
  else if constexpr (kCount == 14) {
    auto& [a, b, c, d, e, f, g, h, i, j, k, l, m, n] = s;
    return std::tie(a, b, c, d, e, f, g, h, i, j, k, l, m, n); }
  else if constexpr (kCount == 15) {
    auto& [a, b, c, d, e, f, g, h, i, j, k, l, m, n, o] = s;
    return std::tie(a, b, c, d, e, f, g, h, i, j, k, l, m, n, o); }
  else if constexpr (kCount == 16) {
    auto& [a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p] = s;
    return std::tie(a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p); }
  else if constexpr (kCount == 17) {
    auto& [a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p, q] = s;
    return std::tie(a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p, q); }
  else if constexpr (kCount == 18) {
    auto& [a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p, q, r] = s;
    return std::tie(a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p, q, r); }
  else if constexpr (kCount == 19) {
    auto& [a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p, q, r, t] = s;
    return std::tie(a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p, q, r, t); }
  else if constexpr (kCount == 20) {
    auto& [a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p, q, r, t, u] = s;
    return std::tie(a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p, q, r, t, u); }
  else if constexpr (kCount == 21) {
    auto& [a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p, q, r, t, u, v] = s;
    return std::tie(a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p, q, r, t, u, v); }
  else if constexpr (kCount == 22) {
    auto& [a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p, q, r, t, u, v, w] = s;
    return std::tie(a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p, q, r, t, u, v, w); }
  else if constexpr (kCount == 23) {
    auto& [a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p, q, r, t, u, v, w, x] = s;
    return std::tie(a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p, q, r, t, u, v, w, x); }
  else if constexpr (kCount == 24) {
    auto& [a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p, q, r, t, u, v, w, x, y] = s;
    return std::tie(a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p, q, r, t, u, v, w, x, y); }
  else if constexpr (kCount == 25) {
    auto& [a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p, q, r, t, u, v, w, x, y, z] = s;
    return std::tie(a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p, q, r, t, u, v, w, x, y, z); }
  else if constexpr (kCount == 26) {
    auto& [a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p, q, r, t, u, v, w, x, y, z, A] = s;
    return std::tie(a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p, q, r, t, u, v, w, x, y, z, A); }
  else if constexpr (kCount == 27) {
    auto& [a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p, q, r, t, u, v, w, x, y, z, A, B] = s;
    return std::tie(a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p, q, r, t, u, v, w, x, y, z, A, B); }
  else if constexpr (kCount == 28) {
    auto& [a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p, q, r, t, u, v, w, x, y, z, A, B, C] = s;
    return std::tie(a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p, q, r, t, u, v, w, x, y, z, A, B, C); }
  else if constexpr (kCount == 29) {
    auto& [a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p, q, r, t, u, v, w, x, y, z, A, B, C, D] = s;
    return std::tie(a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p, q, r, t, u, v, w, x, y, z, A, B, C, D); }
  else if constexpr (kCount == 30) {
    auto& [a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p, q, r, t, u, v, w, x, y, z, A, B, C, D, E] = s;
    return std::tie(a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p, q, r, t, u, v, w, x, y, z, A, B, C, D, E); }
  else if constexpr (kCount == 31) {
    auto& [a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p, q, r, t, u, v, w, x, y, z, A, B, C, D, E, F] = s;
    return std::tie(a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p, q, r, t, u, v, w, x, y, z, A, B, C, D, E, F); }
  else static_assert(kCount == 0, "a struct of that many members is not listed here");
  // clang-format on
}

template <class Type>
inline constexpr bool kIsArray = false;
template <class Type, std::size_t kSize>
inline constexpr bool kIsArray<std::array<Type, kSize>> = true;

/// A number with a type of its own, such as Hertz.
template <class Type>
concept Quantity = !std::is_aggregate_v<Type> && sizeof(Type) == sizeof(double) && requires(Type quantity) {
  { quantity.value } -> std::same_as<double&>;
};

}  // namespace value_detail

/// Writes values one after the other.
class ValueWriter {
 public:
  template <class Type>
  void put(const Type& value) {
    using namespace value_detail;
    if constexpr (std::is_arithmetic_v<Type> || std::is_enum_v<Type>) {
      bytes_.append(reinterpret_cast<const char*>(&value), sizeof value);
    } else if constexpr (std::is_same_v<Type, std::string>) {
      put_size(value.size());
      bytes_ += value;
    } else if constexpr (kIs<Type, std::vector> || kIs<Type, std::map>) {
      put_size(value.size());
      for (const auto& one : value) put<typename Type::value_type>(one);
    } else if constexpr (kIsArray<Type>) {
      for (const auto& one : value) put(one);
    } else if constexpr (kIs<Type, std::optional>) {
      put(value.has_value());
      if (value) put(*value);
    } else if constexpr (kIs<Type, std::pair> || kIs<Type, std::tuple>) {
      std::apply([this](const auto&... one) { (this->put(one), ...); }, value);
    } else if constexpr (requires {
                           value.derived().rows();
                           value.data();
                         }) {
      put_size(static_cast<std::size_t>(value.rows()));
      put_size(static_cast<std::size_t>(value.cols()));
      for (Eigen::Index k = 0; k < value.size(); ++k) put(value.data()[k]);
    } else if constexpr (Quantity<Type>) {
      put(value.value);
    } else {
      static_assert(std::is_aggregate_v<Type>, "only structs without constructors");
      std::apply([this](const auto&... one) { (this->put(one), ...); }, members(value));
    }
  }

  [[nodiscard]] std::string take() { return std::move(bytes_); }

 private:
  void put_size(std::size_t size) { put(static_cast<std::uint64_t>(size)); }
  std::string bytes_;
};

/// Reads them back. What is not there stays as it was, and `fine` says so.
class ValueReader {
 public:
  explicit ValueReader(std::string_view bytes) : bytes_(bytes) {}

  template <class Type>
  void get(Type& value) {
    using namespace value_detail;
    if constexpr (std::is_arithmetic_v<Type> || std::is_enum_v<Type>) {
      if (!has(sizeof value)) return;
      std::memcpy(&value, bytes_.data(), sizeof value);
      bytes_.remove_prefix(sizeof value);
    } else if constexpr (std::is_same_v<Type, std::string>) {
      const std::size_t size = get_size();
      if (!has(size)) return;
      value = bytes_.substr(0, size);
      bytes_.remove_prefix(size);
    } else if constexpr (kIs<Type, std::vector>) {
      const std::size_t size = get_size();
      value.clear();
      for (std::size_t k = 0; k < size && fine_; ++k) {
        typename Type::value_type one{};
        get(one);
        value.push_back(std::move(one));
      }
    } else if constexpr (kIs<Type, std::map>) {
      const std::size_t size = get_size();
      value.clear();
      for (std::size_t k = 0; k < size && fine_; ++k) {
        std::pair<typename Type::key_type, typename Type::mapped_type> one;
        get(one);
        value.insert(std::move(one));
      }
    } else if constexpr (kIsArray<Type>) {
      for (auto& one : value) get(one);
    } else if constexpr (kIs<Type, std::optional>) {
      bool there = false;
      get(there);
      value.reset();
      if (there) get(value.emplace());
    } else if constexpr (kIs<Type, std::pair> || kIs<Type, std::tuple>) {
      std::apply([this](auto&... one) { (this->get(one), ...); }, value);
    } else if constexpr (requires {
                           value.derived().rows();
                           value.data();
                         }) {
      const std::size_t rows = get_size(), columns = get_size();
      if (columns != 0 && (rows > bytes_.size() || columns > bytes_.size() || !has(rows * columns))) return;
      value.resize(static_cast<Eigen::Index>(rows), static_cast<Eigen::Index>(columns));
      for (Eigen::Index k = 0; k < value.size(); ++k) get(value.data()[k]);
    } else if constexpr (Quantity<Type>) {
      get(value.value);
    } else {
      static_assert(std::is_aggregate_v<Type>, "only structs without constructors");
      std::apply([this](auto&... one) { (this->get(one), ...); }, members(value));
    }
  }

  /// Whether everything was there, and nothing else.
  [[nodiscard]] bool complete() const { return fine_ && bytes_.empty(); }

 private:
  bool has(std::size_t bytes) {
    fine_ = fine_ && bytes <= bytes_.size();
    return fine_;
  }
  std::size_t get_size() {
    std::uint64_t size = 0;
    get(size);
    fine_ = fine_ && size <= (std::uint64_t{1} << 40U);
    return fine_ ? static_cast<std::size_t>(size) : 0;
  }
  std::string_view bytes_;
  bool fine_ = true;
};

}  // namespace mbk::batch

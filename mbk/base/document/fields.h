#pragma once

#include <array>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "mbk/base/core/linear_algebra.h"
#include "mbk/base/core/words.h"
#include "mbk/base/document/json_values.h"

/// One description of each value that mbk writes as JSON. The writer, the JSON Schema, the types of the pages and the
/// reference come from it, so that a new field is one line:
///
///     void describe(Fields<Reach>& fields) {
///       fields.type("Reach", "One movement from rest to rest.");
///       fields.add("begin_s", &Reach::begin_s, "from the recording's first sample [s]");
///       fields.add("peaks", &Reach::peaks, "of the speed");
///       fields.add_or_null("path_ratio", &Reach::path_ratio, "path/distance; null where the hand returns");
///     }
///
/// It stands in the namespace of the value or in this one. For the sources of this project; not installed.
namespace mbk::document {

template <class T>
class Fields;

/// A value whose fields are described: `void describe(Fields<T>&)` is declared before it is written.
template <class T>
concept Described = requires(Fields<T>& fields) {
  describe(fields);
};

/// The description of T.
template <Described T>
const Fields<T>& fields_of() {
  static const Fields<T> all = [] {
    Fields<T> made;
    describe(made);
    return made;
  }();
  return all;
}

/// The types that a document refers to, each written once.
class Definitions {
 public:
  /// The schema of a T; a described type with a name becomes a definition and a reference to it.
  template <class T>
  [[nodiscard]] Json of();

  [[nodiscard]] const Json& all() const { return all_; }

 private:
  template <class Make>
  Json named(const std::string& name, Make make) {
    if (!all_.contains(name)) {
      all_[name] = nullptr;  // it may refer to itself
      Json made = make();
      all_[name] = std::move(made);
    }
    return {{"$ref", "#/definitions/" + name}};
  }
  Json all_ = Json::object();
};

namespace detail {

template <class T>
struct IsVector : std::false_type {};
template <class T>
struct IsVector<std::vector<T>> : std::true_type {};
template <class T, std::size_t n>
struct IsVector<std::array<T, n>> : std::true_type {};
template <class T>
struct IsVector<std::span<T>> : std::true_type {};
template <class T>
struct IsMap : std::false_type {};
template <class V, class C>
struct IsMap<std::map<std::string, V, C>> : std::true_type {};
template <class T>
struct IsOptional : std::false_type {};
template <class T>
struct IsOptional<std::optional<T>> : std::true_type {};

/// The name of an enumeration without its namespaces, as GCC and Clang write it.
template <class T>
constexpr std::string_view short_name() {
  std::string_view name = __PRETTY_FUNCTION__;
  name.remove_prefix(name.find("T = ") + 4);
  name = name.substr(0, name.find_first_of(";]"));
  return name.substr(name.rfind(':') + 1);
}

}  // namespace detail

/// A value as JSON: NaN and infinity become null, an enumeration its word, a described type an object.
template <class T>
[[nodiscard]] Json written(const T& value) {
  if constexpr (Described<T>) {
    return fields_of<T>().write(value);
  } else if constexpr (HasWords<T>) {
    return word_of(value);
  } else if constexpr (std::is_floating_point_v<T>) {
    return number(value);
  } else if constexpr (std::is_same_v<T, std::pair<double, double>>) {
    return interval(value);
  } else if constexpr (std::is_same_v<T, Vector>) {
    return list(value);
  } else if constexpr (std::is_base_of_v<Eigen::DenseBase<T>, T>) {
    if constexpr (T::ColsAtCompileTime == 1) {
      return list(value);
    } else {
      return rows(value);
    }
  } else if constexpr (detail::IsVector<T>::value) {
    Json array = Json::array();
    for (const auto& one : value) array.push_back(written<std::remove_cvref_t<decltype(one)>>(one));
    return array;
  } else if constexpr (detail::IsMap<T>::value) {
    Json object = Json::object();
    for (const auto& [key, one] : value) object[key] = written(one);
    return object;
  } else if constexpr (detail::IsOptional<T>::value) {
    return value ? written(*value) : Json(nullptr);
  } else {
    return value;
  }
}

template <class T>
Json Definitions::of() {
  if constexpr (Described<T>) {
    const Fields<T>& described = fields_of<T>();
    if (described.name().empty()) return described.schema(*this);
    return named(described.name(), [&] { return described.schema(*this); });
  } else if constexpr (HasWords<T>) {
    return named(std::string(detail::short_name<T>()), []() -> Json { return {{"enum", kWordList<T>}}; });
  } else if constexpr (std::is_same_v<T, bool>) {
    return {{"type", "boolean"}};
  } else if constexpr (std::is_integral_v<T>) {
    return {{"type", "integer"}};
  } else if constexpr (std::is_floating_point_v<T>) {
    return named("Value", [] { return value_schema(); });
  } else if constexpr (std::is_same_v<T, std::pair<double, double>>) {
    return named("Interval", [&]() -> Json {
      return {{"type", "array"},
              {"items", of<double>()},
              {"minItems", 2},
              {"maxItems", 2},
              {"description", "Low and high end."}};
    });
  } else if constexpr (std::is_same_v<T, Vector> || std::is_same_v<T, std::vector<double>>) {
    return named("Vector", [&]() -> Json { return {{"type", "array"}, {"items", of<double>()}}; });
  } else if constexpr (std::is_base_of_v<Eigen::DenseBase<T>, T>) {
    if constexpr (T::ColsAtCompileTime == 1) {
      return of<Vector>();
    } else {
      return named("Matrix", [&]() -> Json {
        return {{"type", "array"}, {"items", of<Vector>()}, {"description", "Row by row."}};
      });
    }
  } else if constexpr (detail::IsVector<T>::value) {
    return {{"type", "array"}, {"items", of<std::remove_cv_t<typename T::value_type>>()}};
  } else if constexpr (detail::IsMap<T>::value) {
    return {{"type", "object"}, {"additionalProperties", of<typename T::mapped_type>()}};
  } else if constexpr (detail::IsOptional<T>::value) {
    return nullable(of<typename T::value_type>());
  } else {
    static_assert(std::is_convertible_v<T, std::string_view>, "describe this type, or write it with add_as");
    return {{"type", "string"}};
  }
}

/// What is written of a T, in order.
template <class T>
class Fields {
 public:
  struct Field {
    std::string name, meaning;
    bool always = true;  ///< whether every document has it
    std::function<void(const T& from, Json& to)> write;
    std::function<Json(Definitions&)> schema;
  };

  /// @param name     in schemas and TypeScript: "Reach"; without it the type stands where it is used
  /// @param meaning  one sentence
  void type(std::string name, std::string meaning = "") {
    name_ = std::move(name);
    meaning_ = std::move(meaning);
  }

  /// A field; where `get` gives an optional value, it is absent without one.
  /// @param get      a member, or what gives the value of a `const T&`
  /// @param meaning  with its unit: "start of the interval [s]"
  template <class Get>
  void add(std::string name, Get get, std::string meaning = "") {
    using Value = std::remove_cvref_t<std::invoke_result_t<const Get&, const T&>>;
    if constexpr (detail::IsOptional<Value>::value) {
      append(std::move(name), std::move(meaning), &Definitions::of<typename Value::value_type>,
             [get](const T& from, const std::string& key, Json& to) {
               if (const auto& value = std::invoke(get, from)) to[key] = written(*value);
             });
      fields_.back().always = false;
    } else {
      add_or_null(std::move(name), std::move(get), std::move(meaning));
    }
  }

  /// A field that every document has: null without a value.
  template <class Get>
  void add_or_null(std::string name, Get get, std::string meaning = "") {
    using Value = std::remove_cvref_t<std::invoke_result_t<const Get&, const T&>>;
    append(std::move(name), std::move(meaning), &Definitions::of<Value>,
           [get](const T& from, const std::string& key, Json& to) { to[key] = written(std::invoke(get, from)); });
  }

  /// A field that is there only where `is_there` says so.
  template <class If, class Get>
  void add_if(If is_there, std::string name, Get get, std::string meaning = "") {
    add(std::move(name), std::move(get), std::move(meaning));
    Field& field = fields_.back();
    field.always = false;
    field.write = [is_there, write = std::move(field.write)](const T& from, Json& to) {
      if (std::invoke(is_there, from)) write(from, to);
    };
  }

  /// A field whose form no C++ type says.
  /// @param schema  its form as JSON Schema
  /// @param get     gives a Json
  template <class Get>
  void add_as(std::string name, Json schema, Get get, std::string meaning = "") {
    append(
        std::move(name), std::move(meaning), [schema = std::move(schema)](Definitions&) { return schema; },
        [get](const T& from, const std::string& key, Json& to) { to[key] = std::invoke(get, from); });
  }

  /// The same text in every document.
  void constant(std::string name, std::string text, std::string meaning = "") {
    add_as(
        std::move(name), {{"enum", {text}}}, [text](const T&) { return Json(text); }, std::move(meaning));
  }

  /// What each document begins with: the name and version of its schema ("mbk.movement/1"), and what wrote it.
  void header(const std::string& schema) {
    constant("schema", schema);
    add(
        "software", [](const T&) { return software(); }, "what wrote it, as in \"mbk 0.1.0\"");
  }

  /// All fields of another described value, in this object.
  template <class Get>
  void with(Get get) {
    using Other = std::remove_cvref_t<std::invoke_result_t<const Get&, const T&>>;
    for (const auto& field : fields_of<Other>().all()) {
      fields_.push_back({field.name, field.meaning, field.always,
                         [get, write = field.write](const T& from, Json& to) { write(std::invoke(get, from), to); },
                         field.schema});
    }
  }

  [[nodiscard]] const std::string& name() const { return name_; }
  [[nodiscard]] const std::vector<Field>& all() const { return fields_; }

  [[nodiscard]] Json write(const T& value) const {
    Json object = Json::object();
    for (const Field& field : fields_) field.write(value, object);
    return object;
  }

  /// A closed object.
  [[nodiscard]] Json schema(Definitions& types) const {
    Json properties = Json::object(), required = Json::array();
    for (const Field& field : fields_) {
      Json one = field.schema(types);
      if (!field.meaning.empty()) one["description"] = field.meaning;
      properties[field.name] = std::move(one);
      if (field.always) required.push_back(field.name);
    }
    return object_schema(meaning_, std::move(properties), std::move(required));
  }

 private:
  template <class Write>
  void append(std::string name, std::string meaning, std::function<Json(Definitions&)> schema, Write write) {
    fields_.push_back({name, std::move(meaning), true,
                       [write, name](const T& from, Json& to) { write(from, name, to); }, std::move(schema)});
  }

  std::string name_, meaning_;
  std::vector<Field> fields_;
};

/// The JSON Schema of a document.
template <Described T>
[[nodiscard]] Json schema_of() {
  Definitions types;
  return document_schema(fields_of<T>().name(), fields_of<T>().schema(types), types.all());
}

/// A document as text.
template <Described T>
[[nodiscard]] std::string document(const T& value) {
  return dumped(written(value));
}

/// Each schema by the name of its file, "movement".
using Schemas = std::map<std::string, Json, std::less<>>;

}  // namespace mbk::document

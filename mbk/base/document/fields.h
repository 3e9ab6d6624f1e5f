#pragma once

#include <algorithm>
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
#include <variant>
#include <vector>

#include "mbk/base/core/linear_algebra.h"
#include "mbk/base/core/units.h"
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
/// It belongs in the namespace of the value or in this one. For the sources of this project; not installed.
namespace mbk::document {

template <class T>
class Fields;

/// A number that is never undefined.
struct Number {
  double value = 0;
};

/// A value whose fields are described: `void describe(Fields<T>&)` is declared before it is written.
template <class T>
concept Described = requires(Fields<T>& fields) {
  describe(fields);
};

/// The description of T.
template <Described T>
const Fields<T>& fields_of() {
  static const Fields<T> kAll = [] {
    Fields<T> made;
    describe(made);
    return made;
  }();
  return kAll;
}

/// The types that a document refers to, each written once.
class Definitions {
 public:
  /// The schema of a T; a described type with a name becomes a definition and a reference to it.
  template <class T>
  [[nodiscard]] Json of();

  /// The schema of a description; with a name it becomes a definition and a reference to it.
  template <class T>
  [[nodiscard]] Json described(const Fields<T>& fields) {
    if (fields.name().empty()) return fields.schema(*this);
    return named(fields.name(), [&] { return fields.schema(*this); });
  }

  /// A matrix that is written column by column.
  [[nodiscard]] Json columns() {
    return named("Columns", [&]() -> Json {
      return {{"type", "array"}, {"items", of<Vector>()}, {"description", "Signals: one list for each axis."}};
    });
  }

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
inline constexpr std::size_t kLength = 0;  ///< fixed length of a list; 0: any
template <class T, std::size_t n>
inline constexpr std::size_t kLength<std::array<T, n>> = n;
template <class T>
struct IsMap : std::false_type {};
template <class V, class C>
struct IsMap<std::map<std::string, V, C>> : std::true_type {};
template <class T>
struct IsOptional : std::false_type {};
template <class T>
struct IsOptional<std::optional<T>> : std::true_type {};

/// A pointer is written as the value that it points to.
template <class T>
inline constexpr bool kIsPointer = std::is_pointer_v<T> && !std::is_convertible_v<T, std::string_view>;
template <class T>
struct IsVariant : std::false_type {};
template <class... Ts>
struct IsVariant<std::variant<Ts...>> : std::true_type {};

/// The name of an enumeration without its namespaces, which begin with a small letter, as GCC and Clang write it:
/// "Verdict", "ArmPostureOf" for mbk::ArmPosture::Of.
template <class T>
std::string short_name() {
  std::string_view name = __PRETTY_FUNCTION__;
  name.remove_prefix(name.find("T = ") + 4);
  name = name.substr(0, name.find_first_of(";]"));
  std::string all;
  while (!name.empty()) {
    const std::string_view part = name.substr(0, name.find("::"));
    if (part.front() >= 'A' && part.front() <= 'Z') all += part;
    name.remove_prefix(std::min(name.size(), part.size() + 2));
  }
  return all;
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
  } else if constexpr (std::is_same_v<T, Number> || std::is_same_v<T, Hertz>) {
    return value.value;
  } else if constexpr (std::is_same_v<T, std::pair<Hertz, Hertz>>) {
    return Json::array({value.first.value, value.second.value});
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
  } else if constexpr (detail::IsOptional<T>::value || detail::kIsPointer<T>) {
    return value ? written(*value) : Json(nullptr);
  } else if constexpr (detail::IsVariant<T>::value) {
    return std::visit([](const auto& one) { return written(one); }, value);
  } else {
    return value;
  }
}

template <class T>
Json Definitions::of() {
  if constexpr (Described<T>) {
    return described(fields_of<T>());
  } else if constexpr (HasWords<T>) {
    return named(detail::short_name<T>(), []() -> Json { return {{"enum", kWordList<T>}}; });
  } else if constexpr (std::is_same_v<T, bool>) {
    return {{"type", "boolean"}};
  } else if constexpr (std::is_integral_v<T>) {
    return {{"type", "integer"}};
  } else if constexpr (std::is_floating_point_v<T>) {
    return named("Value", [] { return value_schema(); });
  } else if constexpr (std::is_same_v<T, Number> || std::is_same_v<T, Hertz>) {
    return {{"type", "number"}};
  } else if constexpr (std::is_same_v<T, std::pair<Hertz, Hertz>>) {
    return named("Band", [&]() -> Json {
      return {{"type", "array"},
              {"items", of<Hertz>()},
              {"minItems", 2},
              {"maxItems", 2},
              {"description", "low and high [Hz]"}};
    });
  } else if constexpr (std::is_same_v<T, std::pair<double, double>>) {
    return named("Interval", [&]() -> Json {
      return {{"type", "array"},
              {"items", of<double>()},
              {"minItems", 2},
              {"maxItems", 2},
              {"description", "Lower and upper bound."}};
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
    Json list = {{"type", "array"}, {"items", of<std::remove_cv_t<typename T::value_type>>()}};
    if (constexpr std::size_t kLength = detail::kLength<T>; kLength > 0) {
      list["minItems"] = list["maxItems"] = kLength;
    }
    return list;
  } else if constexpr (detail::IsMap<T>::value) {
    return {{"type", "object"}, {"additionalProperties", of<typename T::mapped_type>()}};
  } else if constexpr (detail::IsOptional<T>::value) {
    return nullable(of<typename T::value_type>());
  } else if constexpr (detail::kIsPointer<T>) {
    return of<std::remove_cv_t<std::remove_pointer_t<T>>>();
  } else if constexpr (detail::IsVariant<T>::value) {
    return [this]<class... Ts>(const std::variant<Ts...>*) -> Json {
      return {{"anyOf", Json::array({of<Ts>()...})}};
    }(static_cast<const T*>(nullptr));
  } else {
    static_assert(std::is_convertible_v<T, std::string_view>, "describe this type, or write it with add_as");
    return {{"type", "string"}};
  }
}

/// A member of a member: through(&Measurement::identification, &Identification::method). The first may be a pointer.
template <class First, class Second>
[[nodiscard]] auto through(First first, Second second) {
  return [first, second](const auto& from) -> decltype(auto) { return std::invoke(second, std::invoke(first, from)); };
}

/// The fields of a T, in order.
template <class T>
class Fields {
 public:
  struct Field {
    std::string name, meaning;
    bool always = true;  ///< whether every document has it; false if documents of an earlier version lack it
    std::function<void(const T& from, Json& to)> write;
    std::function<Json(Definitions&)> schema;

    /// The field is present only if `is_there` returns true for a `const T&`.
    template <class If>
    void only_if(If is_there) {
      always = false;
      write = [is_there, write_it = std::move(write)](const T& from, Json& to) {
        if (std::invoke(is_there, from)) write_it(from, to);
      };
    }
  };

  /// @param name     in schemas and TypeScript: "Reach"; without it the type is defined where it is used
  /// @param meaning  one sentence
  void type(std::string name, std::string meaning = "") {
    name_ = std::move(name);
    meaning_ = std::move(meaning);
  }

  /// A field. If `get` returns an optional value or a pointer, the field is absent without a value.
  /// @param get      a member, or a function that returns the value of a `const T&`
  /// @param meaning  with its unit: "start of the interval [s]"
  template <class Get>
  Field& add(std::string name, Get get, std::string meaning = "") {
    using Given = std::remove_cvref_t<std::invoke_result_t<const Get&, const T&>>;
    if constexpr (detail::IsOptional<Given>::value || detail::kIsPointer<Given>) {
      using Value = std::remove_cvref_t<decltype(*std::declval<Given>())>;
      Field& field = append(std::move(name), std::move(meaning), &Definitions::of<Value>,
                            [get](const T& from, const std::string& key, Json& to) {
                              if (const auto& value = std::invoke(get, from)) to[key] = written(*value);
                            });
      field.always = false;
      return field;
    } else {
      return add_or_null(std::move(name), std::move(get), std::move(meaning));
    }
  }

  /// A field that every document has: null without a value.
  template <class Get>
  Field& add_or_null(std::string name, Get get, std::string meaning = "") {
    using Value = std::remove_cvref_t<std::invoke_result_t<const Get&, const T&>>;
    return append(
        std::move(name), std::move(meaning), &Definitions::of<Value>,
        [get](const T& from, const std::string& key, Json& to) { to[key] = written(std::invoke(get, from)); });
  }

  /// A field that is present only if `is_there` returns true.
  template <class If, class Get>
  Field& add_if(If is_there, std::string name, Get get, std::string meaning = "") {
    Field& field = add(std::move(name), std::move(get), std::move(meaning));
    field.only_if(std::move(is_there));
    return field;
  }

  /// A text or list that is absent if it is empty.
  template <class Get>
  Field& add_unless_empty(std::string name, Get get, std::string meaning = "") {
    return add_if([get](const T& from) { return !std::invoke(get, from).empty(); }, std::move(name), get,
                  std::move(meaning));
  }

  /// A number that is never undefined; absent if `get` returns an optional one without a value.
  template <class Get>
  Field& add_number(std::string name, Get get, std::string meaning = "") {
    using Value = std::remove_cvref_t<std::invoke_result_t<const Get&, const T&>>;
    if constexpr (detail::IsOptional<Value>::value) {
      return add(
          std::move(name),
          [get](const T& from) {
            const Value value = std::invoke(get, from);
            return value ? std::optional(Number{*value}) : std::nullopt;
          },
          std::move(meaning));
    } else {
      return add(
          std::move(name), [get](const T& from) { return Number{std::invoke(get, from)}; }, std::move(meaning));
    }
  }

  /// One of two words.
  /// @param get  returns a bool
  template <class Get>
  Field& add_choice(std::string name, Get get, std::string if_true, std::string if_false, std::string meaning = "") {
    Json words = {{"enum", {if_true, if_false}}};
    return add_as(
        std::move(name), std::move(words),
        [=](const T& from) { return Json(std::invoke(get, from) ? if_true : if_false); }, std::move(meaning));
  }

  /// Numbers rounded to a number of digits, for display only; those of a matrix column by column.
  /// @param get  returns a double, a Vector or a Matrix
  template <class Get>
  Field& add_rounded(std::string name, Get get, int digits = kDigits, std::string meaning = "") {
    using Value = std::remove_cvref_t<std::invoke_result_t<const Get&, const T&>>;
    if constexpr (std::is_same_v<Value, Matrix>) {
      return append(std::move(name), std::move(meaning), &Definitions::columns,
                    [get, digits](const T& from, const std::string& key, Json& to) {
                      to[key] = rounded_columns(std::invoke(get, from), digits);
                    });
    } else {
      return append(std::move(name), std::move(meaning), &Definitions::of<Value>,
                    [get, digits](const T& from, const std::string& key, Json& to) {
                      to[key] = rounded(std::invoke(get, from), digits);
                    });
    }
  }

  /// A matrix column by column.
  template <class Get>
  Field& add_columns(std::string name, Get get, std::string meaning = "") {
    return append(
        std::move(name), std::move(meaning), &Definitions::columns,
        [get](const T& from, const std::string& key, Json& to) { to[key] = columns(std::invoke(get, from)); });
  }

  /// A field that is an object of further fields of the same value.
  /// @param describe_part  takes a Fields<T>& and describes that object, its type too
  template <class Describe>
  Field& group(std::string name, Describe describe_part, std::string meaning = "") {
    Fields<T> part;
    describe_part(part);
    return append(
        std::move(name), std::move(meaning), [part](Definitions& types) { return types.described(part); },
        [part](const T& from, const std::string& key, Json& to) { to[key] = part.write(from); });
  }

  /// A field with the schema of a Form, whose JSON `get` returns.
  /// @param get  returns a Json
  template <class Form, class Get>
  Field& add_form(std::string name, Get get, std::string meaning = "") {
    return append(std::move(name), std::move(meaning), &Definitions::of<Form>,
                  [get](const T& from, const std::string& key, Json& to) { to[key] = std::invoke(get, from); });
  }

  /// A field whose schema follows from no C++ type.
  /// @param schema  its JSON Schema
  /// @param get     returns a Json
  template <class Get>
  Field& add_as(std::string name, Json schema, Get get, std::string meaning = "") {
    return append(
        std::move(name), std::move(meaning), [schema = std::move(schema)](Definitions&) { return schema; },
        [get](const T& from, const std::string& key, Json& to) { to[key] = std::invoke(get, from); });
  }

  /// The same text in every document.
  void constant(std::string name, std::string text, std::string meaning = "") {
    add_as(
        std::move(name), {{"enum", {text}}}, [text](const T&) { return Json(text); }, std::move(meaning));
  }

  /// The beginning of each document: name and version of its schema ("mbk.movement/1"), and the program that wrote it.
  void header(const std::string& schema) {
    constant("schema", schema);
    add(
        "software", [](const T&) { return software(); }, "program that wrote the document: \"mbk 1.0.0\"");
  }

  /// All fields of another described value, in this object.
  /// @param omitted  the name of a field to omit
  template <class Get>
  void with(Get get, std::string_view omitted = "") {
    using Other = std::remove_cvref_t<std::invoke_result_t<const Get&, const T&>>;
    for (const auto& field : fields_of<Other>().all()) {
      if (field.name == omitted) continue;
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
  Field& append(std::string name, std::string meaning, std::function<Json(Definitions&)> schema, Write write) {
    fields_.push_back({name, std::move(meaning), true,
                       [write, name](const T& from, Json& to) { write(from, name, to); }, std::move(schema)});
    return fields_.back();
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

/// The JSON Schema of a document that is one of several.
template <Described... Each>
[[nodiscard]] Json schema_of_one(const std::string& title, const std::string& meaning) {
  Definitions types;
  Json each = Json::array({types.of<Each>()...});
  return document_schema(title, {{"description", meaning}, {"oneOf", std::move(each)}}, types.all());
}

/// A document as text.
template <Described T>
[[nodiscard]] std::string document(const T& value) {
  return dumped(written(value));
}

/// Several documents in one, which has its own schema.
template <class T>
struct List {
  std::span<const T> results;
};

/// @param name    "Infos"    @param schema  "mbk.infos/1"
template <class T>
void describe_list(Fields<List<T>>& fields, std::string name, const std::string& schema, std::string meaning) {
  fields.type(std::move(name), std::move(meaning));
  fields.header(schema);
  fields.add("results", &List<T>::results);
}

/// A single document as it is, or several as a list.
template <Described T>
[[nodiscard]] std::string one_or_list(std::span<const T> all) {
  return all.size() == 1 ? document(all.front()) : document(List<T>{all});
}

/// Each schema by the name of its file, "movement".
using Schemas = std::map<std::string, Json, std::less<>>;

}  // namespace mbk::document

// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "casters.hpp"
#include "partpose/io/json.hpp"

#include <deque>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

/// Python classes of the structs that describe themselves (io/json.hpp): constructor, properties, documentation and
/// repr come from `describe` and the defaults of the struct, values go through its JSON. Almost nothing here is a
/// template: a class is a list of fields, each with an offset and three functions of its type.
namespace partpose::python {

/// What a Python value is in JSON. Throws Error, naming the key, for what JSON has no place for.
Json json_of(nb::handle value, const std::string& key = "");

/// Objects are dict, arrays list or tuple.
nb::object python_of(const Json& json, bool arrays_as_tuples = false);

struct Field {
  std::string name, doc;
  std::size_t offset = 0;
  std::string type;           ///< of what reading gives, as in a stub
  std::string accepted_type;  ///< of what writing takes
  std::string default_value;  ///< as Python writes it; empty: there is none
  nb::object (*get)(void* field, nb::handle owner) = nullptr;
  /// Reads the value, then calls check(owner); the field is as it was when either throws.
  void (*set)(void* field, const Json& json, const char* key, void (*check)(const void*), const void* owner) = nullptr;
};

struct DescribedClass {
  std::string name;
  std::deque<Field> fields;  ///< addresses stay
  bool record = false;       ///< all keys required
  nb::handle type;
  Json (*write)(const void* value) = nullptr;
  void (*check)(const void* value) = nullptr;
};

/// The class's documentation with a line for each field.
std::string documentation(const DescribedClass& described, const std::string& doc);
/// Properties, repr, to_dict, comparison, copying and pickling. `described` lives as long as the process.
void bind_described_members(nb::object cls, DescribedClass& described);
/// The text of a signature for the constructor; it stays.
const char* constructor_signature(const DescribedClass& described);
/// One mapping, or keywords, or both, where keywords win.
Json constructor_arguments(const DescribedClass& described, nb::args args, nb::kwargs kwargs);
/// `module.Name` of a class that is bound already.
std::string full_name(nb::handle type, const char* cpp_name);

template <typename T>
struct ListElement {
  using type = void;
};
template <typename T>
struct ListElement<std::vector<T>> {
  using type = T;
};
template <typename T, std::size_t N>
struct ListElement<std::array<T, N>> {
  using type = T;
};

template <typename T>
std::string type_name(bool accepted) {
  if constexpr (std::same_as<T, bool>) {
    return "bool";
  } else if constexpr (std::integral<T>) {
    return "int";
  } else if constexpr (std::floating_point<T>) {
    return "float";
  } else if constexpr (std::same_as<T, std::string>) {
    return "str";
  } else if constexpr (std::same_as<T, Eigen::Isometry3d>) {
    return accepted ? "numpy.typing.ArrayLike"
                    : "typing.Annotated[numpy.typing.NDArray[numpy.float64], dict(shape=(4, 4))]";
  } else if constexpr (json_detail::Described<T>) {
    return full_name(nb::type<T>(), typeid(T).name()) + (accepted ? " | collections.abc.Mapping[str, typing.Any]" : "");
  } else if constexpr (json_detail::IsOptional<T>::value) {
    return type_name<typename T::value_type>(accepted) + " | None";
  } else {
    const std::string element = type_name<typename ListElement<T>::type>(accepted);
    return accepted ? "collections.abc.Sequence[" + element + "]" : "tuple[" + element + ", ...]";
  }
}

template <typename T>
nb::object get_field(void* field, nb::handle owner) {
  T& value = *static_cast<T*>(field);
  if constexpr (std::same_as<T, Eigen::Isometry3d>) {
    return nb::cast(value);
  } else if constexpr (json_detail::Described<T>) {
    return nb::cast(&value, nb::rv_policy::reference_internal, owner);
  } else if constexpr (json_detail::IsOptional<T>::value) {
    return value ? get_field<typename T::value_type>(&*value, owner) : nb::none();
  } else if constexpr (json_detail::Described<typename ListElement<T>::type>) {
    nb::list items;
    for (const auto& item : value) items.append(nb::cast(item, nb::rv_policy::copy));
    return nb::tuple(items);
  } else {
    return python_of(json_detail::write(value), true);
  }
}

template <typename T>
void set_field(void* field, const Json& json, const char* key, void (*check)(const void*), const void* owner) {
  T value{};
  json_detail::read(json, key, value);
  std::swap(*static_cast<T*>(field), value);
  try {
    if (check) check(owner);
  } catch (...) {
    std::swap(*static_cast<T*>(field), value);
    throw;
  }
}

/// How Python writes the default of a field; "..." where it is long.
std::string python_literal(const Json& json);

template <typename T>
nb::class_<T> bind_described(nb::module_& module, const char* name, const char* doc) {
  static DescribedClass& described = *new DescribedClass;  // the interpreter's end is no time to tidy up
  described.name = name;
  described.record = json_detail::all_keys_required<T>();
  described.write = [](const void* value) { return json_detail::write(*static_cast<const T*>(value)); };
  if constexpr (requires(const T& value) { value.check(); })
    described.check = [](const void* value) { static_cast<const T*>(value)->check(); };
  T prototype{};
  T::describe(prototype, [&](const char* key, auto& field, const char* text) {
    using F = std::remove_cvref_t<decltype(field)>;
    const auto offset =
        static_cast<std::size_t>(reinterpret_cast<const char*>(&field) - reinterpret_cast<const char*>(&prototype));
    std::string initial;
    if constexpr (json_detail::IsOptional<F>::value)
      initial = "None";
    else if constexpr (json_detail::Described<F> || std::same_as<F, Eigen::Isometry3d>)
      initial = "...";
    else
      initial = python_literal(json_detail::write(field));
    described.fields.push_back(
        {key, text, offset, type_name<F>(false), type_name<F>(true), initial, &get_field<F>, &set_field<F>});
  });
  const std::string text = documentation(described, doc);
  nb::class_<T> cls(module, name, text.c_str());
  cls.def(
      "__init__",
      [](T* self, nb::args args, nb::kwargs kwargs) {
        new (self) T(from_json<T>(constructor_arguments(described, args, kwargs)));
      },
      nb::sig(constructor_signature(described)));
  bind_described_members(cls, described);
  return cls;
}

/// __repr__ of a class with these attributes, arrays by their shape.
void bind_repr(nb::object cls, std::vector<std::string> attributes);

}  // namespace partpose::python

// SPDX-FileCopyrightText: 2026 partpose contributors
// SPDX-License-Identifier: Apache-2.0
#include "described.hpp"

#include <fmt/format.h>

#include <map>

namespace partpose::python {

namespace {

std::map<PyTypeObject*, const DescribedClass*>& described_classes() {
  static auto& classes = *new std::map<PyTypeObject*, const DescribedClass*>;
  return classes;
}

const char* kept(std::string text) {
  static auto& texts = *new std::deque<std::string>;
  return texts.emplace_back(std::move(text)).c_str();
}

void* address(nb::handle self, const DescribedClass& described) {
  if (!nb::isinstance(self, described.type) || !nb::inst_ready(self))
    throw nb::type_error(("a " + described.name + " is expected").c_str());
  return nb::inst_ptr<void>(self);
}

Json to_json_of(nb::handle self, const DescribedClass& described) { return described.write(address(self, described)); }

std::string text_of(nb::handle value) { return nb::cast<std::string>(nb::steal<nb::str>(PyObject_Str(value.ptr()))); }

std::string type_of(nb::handle value) { return text_of(value.type().attr("__name__")); }

std::string short_repr(nb::handle value) {
  if (nb::hasattr(value, "dtype") && nb::hasattr(value, "shape")) {
    if (nb::cast<std::size_t>(value.attr("size")) <= 4) return nb::cast<std::string>(nb::repr(value.attr("tolist")()));
    return fmt::format("<{} {}>", text_of(value.attr("dtype")), text_of(value.attr("shape")));
  }
  std::string text = nb::cast<std::string>(nb::repr(value));
  if ((nb::isinstance<nb::tuple>(value) || nb::isinstance<nb::list>(value)) && text.size() > 200)
    return fmt::format("<{} items>", nb::len(value));
  return text;
}

std::string repr_of(nb::handle self, const std::string& name, const std::vector<std::string>& attributes) {
  std::string text = name + "(";
  for (const auto& attribute : attributes) {
    if (text.back() != '(') text += ", ";
    text += attribute + "=" + short_repr(self.attr(attribute.c_str()));
  }
  return text + ")";
}

}  // namespace

Json json_of(nb::handle value, const std::string& key) {
  if (value.is_none()) return nullptr;
  if (nb::isinstance<nb::bool_>(value)) return nb::cast<bool>(value);
  if (nb::isinstance<nb::int_>(value)) {
    std::int64_t whole = 0;
    std::uint64_t positive = 0;
    if (nb::try_cast(value, positive)) return positive;  // as a parsed file has it
    if (nb::try_cast(value, whole)) return whole;
    throw Error("{}: {} is out of range", key, text_of(value));
  }
  if (nb::isinstance<nb::float_>(value)) return nb::cast<double>(value);
  if (nb::isinstance<nb::str>(value)) return nb::cast<std::string>(value);
  const auto known = described_classes().find(reinterpret_cast<PyTypeObject*>(value.type().ptr()));
  if (known != described_classes().end()) return to_json_of(value, *known->second);
  if (nb::isinstance<nb::dict>(value)) {
    Json json = Json::object();
    for (const auto [name, item] : nb::borrow<nb::dict>(value)) {
      if (!nb::isinstance<nb::str>(name)) throw Error("{}: keys must be strings, got a {}", key, type_of(name));
      const auto text = nb::cast<std::string>(name);
      json[text] = json_of(item, json_detail::key_path(key, text));
    }
    return json;
  }
  if (nb::isinstance<nb::list>(value) || nb::isinstance<nb::tuple>(value)) {
    Json json = Json::array();
    for (const nb::handle item : nb::borrow<nb::object>(value))
      json.push_back(json_of(item, fmt::format("{}[{}]", key, json.size())));
    return json;
  }
  if (nb::hasattr(value, "tolist")) return json_of(value.attr("tolist")(), key);  // NumPy
  if (nb::hasattr(value, "__fspath__")) return json_of(value.attr("__fspath__")(), key);
  if (nb::hasattr(value, "items"))
    return json_of(nb::steal<nb::dict>(PyObject_CallOneArg(reinterpret_cast<PyObject*>(&PyDict_Type), value.ptr())),
                   key);
  throw Error("key \"{}\": a {} is no value for an option", key, type_of(value));
}

nb::object python_of(const Json& json, bool arrays_as_tuples) {
  switch (json.type()) {
    case Json::value_t::boolean:
      return nb::bool_(json.get<bool>());
    case Json::value_t::number_integer:
      return nb::int_(json.get<std::int64_t>());
    case Json::value_t::number_unsigned:
      return nb::int_(json.get<std::uint64_t>());
    case Json::value_t::number_float:
      return nb::float_(json.get<double>());
    case Json::value_t::string: {
      const auto& text = json.get_ref<const std::string&>();
      return nb::steal<nb::object>(
          PyUnicode_DecodeUTF8(text.data(), static_cast<Py_ssize_t>(text.size()), "surrogateescape"));
    }
    case Json::value_t::array: {
      nb::list list;
      for (const auto& item : json) list.append(python_of(item, arrays_as_tuples));
      if (arrays_as_tuples) return nb::tuple(list);
      return list;
    }
    case Json::value_t::object: {
      nb::dict dict;
      for (const auto& [name, item] : json.items()) dict[name.c_str()] = python_of(item, arrays_as_tuples);
      return dict;
    }
    default:
      return nb::none();
  }
}

std::string python_literal(const Json& json) {
  const std::string text = nb::cast<std::string>(nb::repr(python_of(json, true)));
  return text.size() <= 60 ? text : "...";
}

std::string full_name(nb::handle type, const char* cpp_name) {
  if (!type.is_valid()) throw Error("{}: is not bound yet", cpp_name);
  return nb::cast<std::string>(type.attr("__module__")) + "." + nb::cast<std::string>(type.attr("__qualname__"));
}

std::string documentation(const DescribedClass& described, const std::string& doc) {
  std::string text = doc + "\n";
  for (const auto& field : described.fields) {
    text += fmt::format("\n{}", field.name);
    if (!described.record && field.default_value != "...") text += " = " + field.default_value;
    if (!field.doc.empty()) text += ": " + field.doc;
  }
  return text;
}

const char* constructor_signature(const DescribedClass& described) {
  std::string text = "def __init__(self, values: collections.abc.Mapping[str, typing.Any] | None = None, /";
  if (!described.fields.empty()) text += ", *";
  for (const auto& field : described.fields)
    text +=
        fmt::format(", {}: {} = {}", field.name, field.accepted_type, described.record ? "..." : field.default_value);
  return kept(text + ") -> None");
}

Json constructor_arguments(const DescribedClass& described, nb::args args, nb::kwargs kwargs) {
  Json json = Json::object();
  if (nb::len(args) > 1) throw Error("{}: takes one mapping, or keywords", described.name);
  if (nb::len(args) == 1 && !nb::handle(args[0]).is_none()) {
    json = json_of(args[0]);
    if (!json.is_object()) throw Error("{}: takes a mapping, or keywords, got a {}", described.name, type_of(args[0]));
  }
  const Json keywords = json_of(kwargs);
  for (const auto& [name, value] : keywords.items()) json[name] = value;
  return json;
}

void bind_described_members(nb::object cls, DescribedClass& described) {
  described.type = cls;
  described_classes()[reinterpret_cast<PyTypeObject*>(cls.ptr())] = &described;
  const DescribedClass* record = &described;
  const nb::object property = nb::module_::import_("builtins").attr("property");
  for (const Field& each : described.fields) {
    const Field* field = &each;
    const nb::object getter = nb::cpp_function(
        [field, record](nb::handle self) {
          return field->get(static_cast<char*>(address(self, *record)) + field->offset, self);
        },
        nb::is_method(), nb::sig(kept(fmt::format("def {}(self) -> {}", field->name, field->type))),
        field->doc.c_str());
    const nb::object setter = nb::cpp_function(
        [field, record](nb::handle self, nb::handle value) {
          char* owner = static_cast<char*>(address(self, *record));
          field->set(owner + field->offset, json_of(value, field->name), field->name.c_str(), record->check, owner);
        },
        nb::is_method(), nb::arg("value").none(),
        nb::sig(kept(fmt::format("def {}(self, value: {}, /) -> None", field->name, field->accepted_type))));
    cls.attr(field->name.c_str()) = property(getter, setter, nb::none(), nb::str(field->doc.c_str()));
  }
  const auto method = [&](const char* name, auto function, const char* signature, const char* doc, auto... arguments) {
    cls.attr(name) = nb::cpp_function(function, nb::name(name), nb::scope(cls), nb::is_method(), nb::sig(signature),
                                      doc, arguments...);
  };
  method(
      "to_dict", [record](nb::handle self) { return python_of(to_json_of(self, *record)); },
      "def to_dict(self) -> dict[str, typing.Any]", "What its JSON file would say.");
  method(
      "__repr__",
      [record](nb::handle self) {
        std::vector<std::string> names;
        for (const auto& field : record->fields) names.push_back(field.name);
        return repr_of(self, record->name, names);
      },
      "def __repr__(self) -> str", "");
  method(
      "__eq__",
      [record](nb::handle self, nb::handle other) -> nb::object {
        if (!nb::isinstance(other, record->type)) return nb::borrow<nb::object>(Py_NotImplemented);
        return nb::bool_(to_json_of(self, *record) == to_json_of(other, *record));
      },
      "def __eq__(self, other: object, /) -> bool", "", nb::arg("other").none());
  cls.attr("__hash__") = nb::none();
  const auto copy = [record](nb::handle self) { return record->type(python_of(to_json_of(self, *record))); };
  method("__copy__", copy, "def __copy__(self) -> typing.Self", "");
  method(
      "__deepcopy__", [copy](nb::handle self, nb::handle) { return copy(self); },
      "def __deepcopy__(self, memo: typing.Any, /) -> typing.Self", "");
  method(
      "__reduce__",
      [record](nb::handle self) {
        return nb::make_tuple(record->type, nb::make_tuple(python_of(to_json_of(self, *record))));
      },
      "def __reduce__(self) -> tuple[typing.Any, ...]", "");
}

void bind_repr(nb::object cls, std::vector<std::string> attributes) {
  auto name = nb::cast<std::string>(cls.attr("__name__"));
  const auto* state = new std::pair(std::move(name), std::move(attributes));
  cls.attr("__repr__") =
      nb::cpp_function([state](nb::handle self) { return repr_of(self, state->first, state->second); },
                       nb::name("__repr__"), nb::scope(cls), nb::is_method(), nb::sig("def __repr__(self) -> str"));
}

}  // namespace partpose::python

// A JSON document to be written: objects keep their order, numbers keep all their digits.
#pragma once
#include <concepts>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace fissure::output {

class Json {
 public:
  using Array = std::vector<Json>;
  using Object = std::vector<std::pair<std::string, Json>>;

  Json() = default;  // null
  Json(bool value) : value_(value) {}
  template <std::integral T>
  Json(T value) : value_(static_cast<long long>(value)) {}
  Json(double value) : value_(value) {}  // not finite: null, as JSON knows neither
  Json(std::string value) : value_(std::move(value)) {}
  Json(char const* value) : value_(std::string(value)) {}
  Json(Array values) : value_(std::move(values)) {}
  Json(Object members) : value_(std::move(members)) {}
  template <class T>
  Json(std::vector<T> const& values) : value_(Array(values.begin(), values.end())) {}

  static Json array() { return Json(Array{}); }
  static Json object() { return Json(Object{}); }

  /// The member of that name, made when it is not there yet; a null becomes an object.
  Json& operator[](std::string const& key);
  /// Appends to an array; a null becomes an array.
  Json& push(Json value);

  /// Indented by two spaces; arrays of plain values stand on one line.
  std::string text() const;

 private:
  void write(std::string& out, int depth) const;

  std::variant<std::monostate, bool, long long, double, std::string, Array, Object> value_;
};

/// run.json or any other document: whole or not at all. Throws Error when it cannot be written.
void write_run_json(std::string const& path, Json const& document);

}  // namespace fissure::output

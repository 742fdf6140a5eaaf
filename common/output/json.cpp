#include "output/json.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "output/file.h"

namespace fissure::output {

namespace {

/// Length of the UTF-8 sequence at `text[at]`, 0 when it is none (then the byte is replaced: JSON must be UTF-8).
std::size_t utf8_length(std::string const& text, std::size_t at) {
  auto const byte = [&](std::size_t i) { return i < text.size() ? static_cast<unsigned char>(text[i]) : 0u; };
  auto const follows = [&](std::size_t i) { return (byte(i) & 0xC0u) == 0x80u; };
  unsigned const first = byte(at);
  if (first < 0x80) return 1;
  if (first >= 0xC2 && first < 0xE0 && follows(at + 1)) return 2;
  if (first >= 0xE0 && first < 0xF0 && follows(at + 1) && follows(at + 2)) {
    bool const overlong = first == 0xE0 && byte(at + 1) < 0xA0, surrogate = first == 0xED && byte(at + 1) >= 0xA0;
    return overlong || surrogate ? 0 : 3;
  }
  if (first >= 0xF0 && first < 0xF5 && follows(at + 1) && follows(at + 2) && follows(at + 3)) {
    bool const overlong = first == 0xF0 && byte(at + 1) < 0x90, beyond = first == 0xF4 && byte(at + 1) >= 0x90;
    return overlong || beyond ? 0 : 4;
  }
  return 0;
}

void write_string(std::string& out, std::string const& text) {
  out += '"';
  for (std::size_t i = 0; i < text.size();) {
    std::size_t const length = utf8_length(text, i);
    unsigned char const c = static_cast<unsigned char>(text[i]);
    if (length == 0)
      out += "\\ufffd";
    else if (c == '"')
      out += "\\\"";
    else if (c == '\\')
      out += "\\\\";
    else if (c == '\n')
      out += "\\n";
    else if (c == '\t')
      out += "\\t";
    else if (c < 0x20)
      out += fmt::format("\\u{:04x}", c);
    else
      out.append(text, i, length);
    i += std::max<std::size_t>(length, 1);
  }
  out += '"';
}

}  // namespace

Json& Json::operator[](std::string const& key) {
  if (std::holds_alternative<std::monostate>(value_)) value_ = Object{};
  auto* const members = std::get_if<Object>(&value_);
  if (!members) throw std::logic_error("Json: member \"" + key + "\" asked of a value that is no object");
  for (auto& [name, value] : *members)
    if (name == key) return value;
  return members->emplace_back(key, Json()).second;
}

Json& Json::push(Json value) {
  if (std::holds_alternative<std::monostate>(value_)) value_ = Array{};
  auto* const items = std::get_if<Array>(&value_);
  if (!items) throw std::logic_error("Json: push to a value that is no array");
  return items->emplace_back(std::move(value));
}

void Json::write(std::string& out, int depth) const {
  auto const new_line = [&](int d) {
    out += '\n';
    out.append(static_cast<std::size_t>(2 * d), ' ');
  };
  if (auto const* flag = std::get_if<bool>(&value_))
    out += *flag ? "true" : "false";
  else if (auto const* whole = std::get_if<long long>(&value_))
    out += fmt::format("{}", *whole);
  else if (auto const* number = std::get_if<double>(&value_))
    out += std::isfinite(*number) ? fmt::format("{:.17g}", *number) : "null";
  else if (auto const* text = std::get_if<std::string>(&value_))
    write_string(out, *text);
  else if (auto const* items = std::get_if<Array>(&value_)) {
    bool const nested = std::any_of(items->begin(), items->end(), [](Json const& item) {
      return std::holds_alternative<Array>(item.value_) || std::holds_alternative<Object>(item.value_);
    });
    out += '[';
    for (std::size_t i = 0; i < items->size(); ++i) {
      if (i) out += nested ? "," : ", ";
      if (nested) new_line(depth + 1);
      (*items)[i].write(out, depth + 1);
    }
    if (nested) new_line(depth);
    out += ']';
  } else if (auto const* members = std::get_if<Object>(&value_)) {
    out += '{';
    for (std::size_t i = 0; i < members->size(); ++i) {
      if (i) out += ',';
      new_line(depth + 1);
      write_string(out, (*members)[i].first);
      out += ": ";
      (*members)[i].second.write(out, depth + 1);
    }
    if (!members->empty()) new_line(depth);
    out += '}';
  } else
    out += "null";
}

std::string Json::text() const {
  std::string out;
  write(out, 0);
  return out + "\n";
}

void write_run_json(std::string const& path, Json const& document) { write_whole(path, document.text()); }

}  // namespace fissure::output

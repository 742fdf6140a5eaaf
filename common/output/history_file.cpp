#include "output/history_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <limits>
#include <utility>

#include "output/file.h"
#include "output/hdf5.h"

namespace fissure::output {

namespace {

/// A name as RFC 4180 wants it: in quotes when it holds a comma, a quote or a line break.
std::string csv(std::string const& text) {
  if (text.find_first_of(",\"\n\r") == std::string::npos) return text;
  std::string out = "\"";
  for (char const c : text) {
    if (c == '"') out += '"';
    out += c == '\n' || c == '\r' ? ' ' : c;
  }
  return out + '"';
}

std::string header(std::vector<HistoryFile::Column> const& columns) {
  std::string out = "time [s]";
  for (auto const& column : columns) out += "," + csv(column.name + " [" + column.unit + "]");
  return out + "\n";
}

/// The numbers of a row; NaN for what is none to its end.
std::vector<double> numbers(std::string_view row) {
  std::vector<double> values;
  while (!row.empty()) {
    std::size_t const comma = std::min(row.find(','), row.size());
    double value = std::numeric_limits<double>::quiet_NaN();
    auto const [end, error] = std::from_chars(row.data(), row.data() + comma, value);
    values.push_back(end == row.data() + comma ? value : std::numeric_limits<double>::quiet_NaN());
    row.remove_prefix(std::min(comma + 1, row.size()));
  }
  return values;
}

/// Complete rows below the header, without their line ends.
std::vector<std::string_view> rows_of(std::string_view text, std::size_t header_size) {
  std::vector<std::string_view> rows;
  for (std::size_t from = header_size, end; (end = text.find('\n', from)) != std::string_view::npos; from = end + 1)
    rows.push_back(text.substr(from, end - from));
  return rows;
}

}  // namespace

HistoryFile::HistoryFile(std::string const& folder, std::vector<Column> const& columns)
    : folder_(folder), path_(folder + "/history.csv"), header_(header(columns)), columns_(columns) {}

HistoryFile::HistoryFile(HistoryFile&& other) noexcept
    : folder_(std::move(other.folder_)),
      path_(std::move(other.path_)),
      header_(std::move(other.header_)),
      columns_(std::move(other.columns_)),
      rows_(other.rows_),
      file_(std::exchange(other.file_, -1)) {}

HistoryFile::~HistoryFile() {
  if (file_ >= 0) ::close(file_);
}

void HistoryFile::open() {
  file_ = ::open(path_.c_str(), O_WRONLY | O_APPEND | O_CLOEXEC);
  if (file_ < 0) throw file_error(path_, "written", errno);
}

HistoryFile HistoryFile::create(std::string const& folder, std::vector<Column> const& columns) {
  HistoryFile history(folder, columns);
  write_whole(history.path_, history.header_);
  history.open();
  return history;
}

HistoryFile HistoryFile::reopen(std::string const& folder, std::vector<Column> const& columns, double time,
                                std::function<void(std::vector<double> const&)> const& tell) {
  HistoryFile history(folder, columns);
  std::string const text = read_whole(history.path_);
  if (text.compare(0, history.header_.size(), history.header_) != 0)
    throw Error(history.path_ + ":1: has other columns than the run that is to go on; choose the folder of that run");
  std::string kept = history.header_;
  int line = 1;
  double last = -std::numeric_limits<double>::infinity();
  for (auto const row : rows_of(text, history.header_.size())) {
    auto const values = numbers(row);
    ++line;
    if (values.size() != columns.size() + 1 ||
        std::any_of(values.begin(), values.end(), [](double x) { return std::isnan(x); }))
      throw Error(
          fmt::format("{}:{}: this row cannot be read ({} numbers are expected); mend it or take it out, then restart",
                      history.path_, line, columns.size() + 1));
    if (!(values[0] > last))
      throw Error(fmt::format(
          "{}:{}: its time, {:.6g} s, is not after that of the row before; mend it or take it out, then restart",
          history.path_, line, values[0]));
    last = values[0];
    if (values[0] > time) break;
    kept.append(row) += '\n';
    ++history.rows_;
    if (tell) tell(values);
  }
  write_whole(history.path_, kept);
  history.open();
  return history;
}

void HistoryFile::append(double time, std::vector<double> const& values) {
  if (values.size() != columns_.size())
    throw Error(
        fmt::format("{}: a row of {} values cannot be written ({} columns)", path_, values.size(), columns_.size()));
  std::string row = fmt::format("{:.17g}", time);
  for (double const value : values) row += fmt::format(",{:.17g}", value);
  row += '\n';
  off_t const end = ::lseek(file_, 0, SEEK_END);
  ssize_t const written = ::write(file_, row.data(), row.size());
  if (written == static_cast<ssize_t>(row.size())) {
    ++rows_;
    return;
  }
  int const reason = written < 0 ? errno : ENOSPC;
  if (written > 0 && ::ftruncate(file_, end) != 0) throw file_error(path_, "cut back to its last whole row", errno);
  throw file_error(path_, "written", reason);
}

void HistoryFile::write_hdf5() const {
  std::string const text = read_whole(path_);
  std::vector<std::vector<double>> values(columns_.size() + 1);
  for (auto const row : rows_of(text, header_.size())) {
    auto const found = numbers(row);
    for (std::size_t i = 0; i < values.size() && i < found.size(); ++i) values[i].push_back(found[i]);
  }
  h5::Image image(text.size() + (1 << 16));
  image.group("/history");
  for (std::size_t i = 0; i < values.size(); ++i) {
    std::string name = "/history/" + (i ? columns_[i - 1].name : "time");
    for (std::size_t at = 9; (at = name.find('/', at)) != std::string::npos;)
      name[at] = '|';  // a slash would be a group
    image.dataset(name, {values[i].size()}, values[i].data(), H5T_IEEE_F64LE);
    image.attribute(name, "unit", i ? columns_[i - 1].unit : std::string("s"));
  }
  write_whole(folder_ + "/history.h5", image.bytes());
}

}  // namespace fissure::output

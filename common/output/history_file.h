// history.csv: one row per sample, one column per measure, on the disk as soon as it is taken; history.h5: the same.
#pragma once
#include <functional>
#include <string>
#include <vector>

namespace fissure::output {

class HistoryFile {
 public:
  struct Column {
    std::string name, unit;
  };

  /// Begins history.csv with the header "time [s],force [N],..."; time comes first by itself.
  static HistoryFile create(std::string const& folder, std::vector<Column> const& columns);

  /// Continues a history: rows later than `time` [s], and a last one that is not complete, are taken away.
  /// Throws Error when the file is missing or its columns are others.
  /// `tell` gets the rows that are kept, with their time in front.
  static HistoryFile reopen(std::string const& folder, std::vector<Column> const& columns, double time,
                            std::function<void(std::vector<double> const&)> const& tell = {});

  HistoryFile(HistoryFile&& other) noexcept;
  HistoryFile& operator=(HistoryFile&&) = delete;
  ~HistoryFile();

  /// One row, written through to the file. On a full disk throws Error and leaves the rows before it whole.
  void append(double time, std::vector<double> const& values);

  /// Rows so far, those that were kept included.
  std::size_t rows() const { return rows_; }

  /// The same as history.h5, group "history": one dataset per column, with attribute "unit".
  void write_hdf5() const;

 private:
  HistoryFile(std::string const& folder, std::vector<Column> const& columns);
  void open();
  std::string folder_, path_, header_;
  std::vector<Column> columns_;
  std::size_t rows_ = 0;
  int file_ = -1;
};

}  // namespace fissure::output

// MAT files for tests, written by libmatio.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace sinew {

enum class MatLayout { k5, k5Compressed, k73 };

/// Text of an enumerator, for names of tests.
[[nodiscard]] std::string NameOf(MatLayout layout);

class MatWriter {
 public:
  /// A value of a field: a column of numbers, a row of 16-bit integers, or a text.
  using Field = std::variant<std::vector<double>, std::vector<std::int16_t>, std::string>;
  using Fields = std::vector<std::pair<std::string, Field>>;

  MatWriter(const std::string& path, MatLayout layout);
  ~MatWriter();  ///< the file is complete only then
  MatWriter(const MatWriter&) = delete;
  MatWriter& operator=(const MatWriter&) = delete;

  MatWriter& Array(const std::string& name, std::size_t rows, std::size_t columns,
                   std::vector<double> values);
  MatWriter& Column(const std::string& name, const std::vector<double>& values);
  MatWriter& Text(const std::string& name, const std::string& text);
  MatWriter& Struct(const std::string& name, const Fields& fields);
  /// A channel as Spike2 exports it.
  MatWriter& Spike2(const std::string& name, const std::string& title, const std::string& units,
                    double interval, double start, const std::vector<double>& values);
  /// A 1 x N struct array within a struct: name.inner(i).field.
  MatWriter& StructArray(const std::string& name, const std::string& inner, const std::string& field,
                         const std::vector<std::vector<double>>& values);
  MatWriter& Cells(const std::string& name, const std::vector<std::vector<double>>& values);
  MatWriter& Complex(const std::string& name);
  MatWriter& Sparse(const std::string& name);

 private:
  struct File;
  std::unique_ptr<File> file_;
};

/// The bytes of a version 5 file with one variable that is an object of MATLAB, such as a table. libmatio
/// cannot write it.
[[nodiscard]] std::string MatObject(const std::string& name, const std::string& class_name);

}  // namespace sinew

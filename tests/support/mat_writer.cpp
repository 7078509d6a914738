#include "tests/support/mat_writer.h"

#include <matio.h>

#include <array>

namespace sinew {
namespace {

matvar_t* Numbers(const char* name, std::size_t rows, std::size_t columns,
                  const std::vector<double>& values) {
  std::array<std::size_t, 2> sizes = {rows, columns};
  return Mat_VarCreate(name, MAT_C_DOUBLE, MAT_T_DOUBLE, 2, sizes.data(), const_cast<double*>(values.data()),
                       0);
}

matvar_t* Make(const MatWriter::Field& field) {
  if (const auto* numbers = std::get_if<std::vector<double>>(&field))
    return Numbers(nullptr, numbers->size(), 1, *numbers);
  if (const auto* integers = std::get_if<std::vector<std::int16_t>>(&field)) {
    std::array<std::size_t, 2> sizes = {1, integers->size()};
    return Mat_VarCreate(nullptr, MAT_C_INT16, MAT_T_INT16, 2, sizes.data(),
                         const_cast<std::int16_t*>(integers->data()), 0);
  }
  const auto& text = std::get<std::string>(field);
  std::array<std::size_t, 2> sizes = {1, text.size()};
  return Mat_VarCreate(nullptr, MAT_C_CHAR, MAT_T_UTF8, 2, sizes.data(), const_cast<char*>(text.data()), 0);
}

}  // namespace

struct MatWriter::File {
  mat_t* mat = nullptr;
  matio_compression compression = MAT_COMPRESSION_NONE;

  void Write(matvar_t* variable) const {
    Mat_VarWrite(mat, variable, compression);
    Mat_VarFree(variable);
  }
};

std::string NameOf(MatLayout layout) {
  return layout == MatLayout::k5             ? "Version5"
         : layout == MatLayout::k5Compressed ? "Compressed5"
                                             : "Version73";
}

MatWriter::MatWriter(const std::string& path, MatLayout layout) : file_(std::make_unique<File>()) {
  file_->mat = Mat_CreateVer(path.c_str(), nullptr, layout == MatLayout::k73 ? MAT_FT_MAT73 : MAT_FT_MAT5);
  if (layout != MatLayout::k5) file_->compression = MAT_COMPRESSION_ZLIB;
}

MatWriter::~MatWriter() {
  Mat_Close(file_->mat);
}

MatWriter& MatWriter::Array(const std::string& name, std::size_t rows, std::size_t columns,
                            std::vector<double> values) {
  file_->Write(Numbers(name.c_str(), rows, columns, values));
  return *this;
}

MatWriter& MatWriter::Column(const std::string& name, const std::vector<double>& values) {
  return Array(name, values.size(), 1, values);
}

MatWriter& MatWriter::Text(const std::string& name, const std::string& text) {
  std::array<std::size_t, 2> sizes = {1, text.size()};
  file_->Write(Mat_VarCreate(name.c_str(), MAT_C_CHAR, MAT_T_UTF8, 2, sizes.data(),
                             const_cast<char*>(text.data()), 0));
  return *this;
}

MatWriter& MatWriter::Struct(const std::string& name, const Fields& fields) {
  std::array<std::size_t, 2> one = {1, 1};
  std::vector<const char*> names;
  for (const auto& [field, value] : fields) names.push_back(field.c_str());
  matvar_t* made =
      Mat_VarCreateStruct(name.c_str(), 2, one.data(), names.data(), static_cast<unsigned>(names.size()));
  for (const auto& [field, value] : fields) Mat_VarSetStructFieldByName(made, field.c_str(), 0, Make(value));
  file_->Write(made);
  return *this;
}

MatWriter& MatWriter::Spike2(const std::string& name, const std::string& title, const std::string& units,
                             double interval, double start, const std::vector<double>& values) {
  return Struct(name, {{"title", title},
                       {"comment", std::string("No comment")},
                       {"interval", std::vector<double>{interval}},
                       {"scale", std::vector<double>{0.5}},
                       {"offset", std::vector<double>{0}},
                       {"units", units},
                       {"start", std::vector<double>{start}},
                       {"length", std::vector<double>{static_cast<double>(values.size())}},
                       {"values", values}});
}

MatWriter& MatWriter::StructArray(const std::string& name, const std::string& inner, const std::string& field,
                                  const std::vector<std::vector<double>>& values) {
  std::array<std::size_t, 2> one = {1, 1};
  std::array<std::size_t, 2> many = {1, values.size()};
  std::array<const char*, 1> inner_name = {inner.c_str()};
  std::array<const char*, 1> field_name = {field.c_str()};
  matvar_t* array = Mat_VarCreateStruct(inner.c_str(), 2, many.data(), field_name.data(), 1);
  for (std::size_t i = 0; i < values.size(); ++i)
    Mat_VarSetStructFieldByName(array, field.c_str(), i, Numbers(nullptr, 1, values[i].size(), values[i]));
  matvar_t* outer = Mat_VarCreateStruct(name.c_str(), 2, one.data(), inner_name.data(), 1);
  Mat_VarSetStructFieldByName(outer, inner.c_str(), 0, array);
  file_->Write(outer);
  return *this;
}

MatWriter& MatWriter::Cells(const std::string& name, const std::vector<std::vector<double>>& values) {
  std::array<std::size_t, 2> sizes = {1, values.size()};
  matvar_t* cells = Mat_VarCreate(name.c_str(), MAT_C_CELL, MAT_T_CELL, 2, sizes.data(), nullptr, 0);
  for (std::size_t i = 0; i < values.size(); ++i)
    Mat_VarSetCell(cells, static_cast<int>(i), Numbers(nullptr, values[i].size(), 1, values[i]));
  file_->Write(cells);
  return *this;
}

MatWriter& MatWriter::Complex(const std::string& name) {
  std::array<std::size_t, 2> sizes = {3, 1};
  std::array<double, 3> real = {1, 2, 3};
  std::array<double, 3> imaginary = {4, 5, 6};
  mat_complex_split_t both = {real.data(), imaginary.data()};
  file_->Write(
      Mat_VarCreate(name.c_str(), MAT_C_DOUBLE, MAT_T_DOUBLE, 2, sizes.data(), &both, MAT_F_COMPLEX));
  return *this;
}

MatWriter& MatWriter::Sparse(const std::string& name) {
  std::array<std::size_t, 2> sizes = {3, 2};
  std::array<mat_uint32_t, 2> rows = {0, 2};
  std::array<mat_uint32_t, 3> columns = {0, 1, 2};
  std::array<double, 2> values = {1.5, 2.5};
  mat_sparse_t sparse{};
  sparse.nzmax = 2;
  sparse.ir = rows.data();
  sparse.nir = 2;
  sparse.jc = columns.data();
  sparse.njc = 3;
  sparse.ndata = 2;
  sparse.data = values.data();
  file_->Write(Mat_VarCreate(name.c_str(), MAT_C_SPARSE, MAT_T_DOUBLE, 2, sizes.data(), &sparse, 0));
  return *this;
}

std::string MatObject(const std::string& name, const std::string& class_name) {
  const auto number = [](std::uint32_t value) {
    std::string bytes;
    for (int i = 0; i < 4; ++i) bytes += static_cast<char>(value >> (8U * static_cast<unsigned>(i)) & 0xffU);
    return bytes;
  };
  const auto element = [&](std::uint32_t type, std::string content) {
    const std::string tag = number(type) + number(static_cast<std::uint32_t>(content.size()));
    content.resize((content.size() + 7) / 8 * 8);
    return tag + content;
  };
  constexpr std::uint32_t kInt8 = 1;
  constexpr std::uint32_t kUint32 = 6;
  constexpr std::uint32_t kMatrix = 14;
  constexpr std::uint32_t kOpaque = 17;
  constexpr std::uint32_t kUint32Class = 13;
  std::string reference;
  for (const std::uint32_t value : {0xdd000000U, 2U, 1U, 1U, 1U, 1U}) reference += number(value);
  const std::string array = element(kUint32, number(kUint32Class) + number(0)) +
                            element(5, number(6) + number(1)) + element(kInt8, "") +
                            element(kUint32, reference);
  std::string header = "MATLAB 5.0 MAT-file";
  header.resize(116, ' ');
  header.resize(124, '\0');
  header += std::string("\0\1IM", 4);
  return header +
         element(kMatrix, element(kUint32, number(kOpaque) + number(0)) + element(kInt8, name) +
                              element(kInt8, "MCOS") + element(kInt8, class_name) + element(kMatrix, array));
}

}  // namespace sinew

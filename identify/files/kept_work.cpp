#include "identify/files/kept_work.h"

#include <cmath>
#include <utility>

#include "identify/files/columns.h"

namespace sinew::files {
namespace {

// Rows of different lengths: the lengths, and all numbers one after the other.
struct Rows {
  std::vector<double> counts;
  std::vector<double> numbers;

  void Add(const std::vector<double>& row) {
    counts.push_back(static_cast<double>(row.size()));
    numbers.insert(numbers.end(), row.begin(), row.end());
  }
  void Write(Hdf5Node& node) {
    node.At("count").SetVector(std::move(counts));
    node.At("numbers").SetVector(std::move(numbers));
  }
};

Result<std::vector<std::vector<double>>> ReadRows(const std::string& path, const Hdf5Node& node,
                                                  std::size_t count) {
  const auto* counts = NumberColumn(node, "count", count);
  const Hdf5Node* found = node.Find("numbers");
  if (counts == nullptr || found == nullptr || found->array() == nullptr)
    return Fail("{}: /resume is not complete", path);
  const std::vector<double>& numbers = found->array()->values;
  std::vector<std::vector<double>> rows;
  std::size_t at = 0;
  for (const double size : *counts) {
    if (!(size >= 0 && size <= static_cast<double>(numbers.size() - at)))
      return Fail("{}: /resume is not complete", path);
    const auto begin = numbers.begin() + static_cast<std::ptrdiff_t>(at);
    at += static_cast<std::size_t>(size);
    rows.emplace_back(begin, numbers.begin() + static_cast<std::ptrdiff_t>(at));
  }
  return rows;
}

Status ReadFits(const std::string& path, const Hdf5Node& node, FitRecord::Answers& fits) {
  const Hdf5Node* questions = node.Find("question");
  const std::size_t count =
      questions == nullptr || questions->texts() == nullptr ? 0 : questions->texts()->size();
  const auto* question = TextColumn(node, "question", count);
  const auto* text = TextColumn(node, "text", count);
  if (question == nullptr || text == nullptr) return Fail("{}: /resume/fits is not complete", path);
  SINEW_ASSIGN(auto rows, ReadRows(path, node, count));
  for (std::size_t i = 0; i < count; ++i) {
    Digest::Value value{};
    if (!FromHex((*question)[i], value))
      return Fail("{}: /resume/fits/question '{}' is none: expected 32 hexadecimal digits", path,
                  (*question)[i]);
    fits.emplace(value, FitRecord::Answer{std::move(rows[i]), (*text)[i]});
  }
  return {};
}

}  // namespace

void WriteKeptWork(const std::vector<KeptResiduals>& residuals, const FitRecord* record, Hdf5Node& root) {
  if (!residuals.empty()) {
    Hdf5Node& node = root.At("resume/residuals");
    std::vector<double> evaluation;
    Rows rows;
    for (const KeptResiduals& kept : residuals) {
      evaluation.push_back(static_cast<double>(kept.evaluation));
      rows.Add(kept.numbers);
    }
    node.At("evaluation").SetVector(std::move(evaluation));
    rows.Write(node);
  }
  const FitRecord::Answers fits = record == nullptr ? FitRecord::Answers() : record->All();
  if (fits.empty()) return;
  Hdf5Node& node = root.At("resume/fits");
  std::vector<std::string> question, text;
  Rows rows;
  for (const auto& [value, answer] : fits) {
    question.push_back(ToHex(value));
    text.push_back(answer.text);
    rows.Add(answer.numbers);
  }
  node.At("question").data = std::move(question);
  node.At("text").data = std::move(text);
  rows.Write(node);
}

Result<KeptWork> ReadKeptWork(const std::string& path, const Hdf5Node& root, std::size_t evaluations) {
  KeptWork kept;
  if (const Hdf5Node* node = root.Find("resume/residuals"); node != nullptr) {
    const Hdf5Node* found = node->Find("evaluation");
    const std::size_t count =
        found == nullptr || found->array() == nullptr ? 0 : found->array()->values.size();
    const auto* evaluation = NumberColumn(*node, "evaluation", count);
    if (evaluation == nullptr) return Fail("{}: /resume/residuals is not complete", path);
    SINEW_ASSIGN(auto rows, ReadRows(path, *node, count));
    double last = -1;
    for (std::size_t i = 0; i < count; ++i) {
      const double at = (*evaluation)[i];
      if (!(at > last && at < static_cast<double>(evaluations)))
        return Fail("{}: /resume/residuals and /trace do not belong together", path);
      last = at;
      kept.residuals.push_back({static_cast<long>(at), std::move(rows[i])});
    }
  }
  if (const Hdf5Node* node = root.Find("resume/fits"); node != nullptr)
    SINEW_TRY(ReadFits(path, *node, kept.fits));
  return kept;
}

}  // namespace sinew::files

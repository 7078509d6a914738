#include "identify/files/searches.h"

#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "base/constants.h"
#include "base/numbers.h"
#include "identify/files/columns.h"
#include "identify/solvers/solver.h"

namespace sinew::files {
namespace {

// Counts are whole numbers below 2^53; a limit that is none is stored as infinity.
constexpr std::array<std::pair<const char*, long FinishedSearch::*>, 5> kCounts{
    {{"max_evaluations", &FinishedSearch::max_evaluations},
     {"first", &FinishedSearch::first},
     {"evaluations", &FinishedSearch::evaluations},
     {"failures", &FinishedSearch::failures},
     {"infeasible", &FinishedSearch::infeasible}}};
constexpr std::array<std::pair<const char*, std::string FinishedSearch::*>, 4> kTexts{
    {{"solver", &FinishedSearch::solver},
     {"first_failure", &FinishedSearch::first_failure},
     {"stop_reason", &FinishedSearch::stop_kind},
     {"stop_test", &FinishedSearch::stop_test}}};
constexpr std::array<std::pair<const char*, Vector FinishedSearch::*>, 2> kPoints{
    {{"start", &FinishedSearch::start}, {"x", &FinishedSearch::x}}};

double ToNumber(long count) {
  return count == kUnlimitedEvaluations ? kInfinity : static_cast<double>(count);
}

Status CheckRange(const std::string& path, const FinishedSearch& search, std::size_t evaluations) {
  const auto all = static_cast<long>(evaluations);
  const bool fits = search.first >= 0 && search.evaluations >= 0 && search.first <= all &&
                    search.evaluations <= all - search.first && TerminationOf(search.stop_kind);
  return fits ? Status() : Fail("{}: /searches and /trace do not belong together", path);
}

}  // namespace

void WriteSearches(const std::vector<FinishedSearch>& searches, std::size_t variables, Hdf5Node& node) {
  std::vector<double> cost, iterations;
  for (const FinishedSearch& search : searches) {
    cost.push_back(search.cost);
    iterations.push_back(search.iterations);
  }
  node.At("cost").SetVector(std::move(cost));
  node.At("iterations").SetVector(std::move(iterations));
  for (const auto& [name, member] : kCounts) {
    std::vector<double> column;
    for (const FinishedSearch& search : searches) column.push_back(ToNumber(search.*member));
    node.At(name).SetVector(std::move(column));
  }
  for (const auto& [name, member] : kTexts) {
    std::vector<std::string> column;
    for (const FinishedSearch& search : searches) column.push_back(search.*member);
    node.At(name).data = std::move(column);
  }
  for (const auto& [name, member] : kPoints) {
    std::vector<double> rows;
    for (const FinishedSearch& search : searches) {
      const Vector& point = search.*member;
      rows.insert(rows.end(), point.data(), point.data() + point.size());
    }
    node.At(name).SetMatrix(searches.size(), variables, std::move(rows));
  }
}

Result<std::vector<FinishedSearch>> ReadSearches(const std::string& path, const Hdf5Node& root,
                                                 std::size_t evaluations, std::size_t variables) {
  const Hdf5Node* node = root.Find("searches");
  if (node == nullptr) return std::vector<FinishedSearch>();
  const Hdf5Node* first = node->Find("cost");
  const std::size_t count = first == nullptr || first->array() == nullptr ? 0 : first->array()->values.size();
  std::vector<FinishedSearch> searches(count);
  const auto incomplete = [&] { return Fail("{}: /searches is not complete", path); };
  const auto* cost = NumberColumn(*node, "cost", count);
  const auto* iterations = NumberColumn(*node, "iterations", count);
  if (cost == nullptr || iterations == nullptr) return incomplete();
  for (const auto& [name, member] : kCounts) {
    const auto* column = NumberColumn(*node, name, count);
    if (column == nullptr) return incomplete();
    for (std::size_t i = 0; i < count; ++i) {
      const double number = (*column)[i];
      const bool whole = number >= 0 && number < 9e15;
      if (!whole && !(std::isinf(number) && number > 0)) return incomplete();
      searches[i].*member = whole ? static_cast<long>(number) : kUnlimitedEvaluations;
    }
  }
  for (const auto& [name, member] : kTexts) {
    const auto* column = TextColumn(*node, name, count);
    if (column == nullptr) return incomplete();
    for (std::size_t i = 0; i < count; ++i) searches[i].*member = (*column)[i];
  }
  for (const auto& [name, member] : kPoints) {
    const auto* rows = NumberColumn(*node, name, count * variables);
    if (rows == nullptr) return incomplete();
    for (std::size_t i = 0; i < count; ++i)
      searches[i].*member =
          Eigen::Map<const Vector>(rows->data() + i * variables, static_cast<Eigen::Index>(variables));
  }
  for (std::size_t i = 0; i < count; ++i) {
    searches[i].cost = (*cost)[i];
    const auto whole = WholeNumber((*iterations)[i]);
    if (!whole || *whole < 0 || *whole > std::numeric_limits<int>::max()) return incomplete();
    searches[i].iterations = static_cast<int>(*whole);
    SINEW_TRY(CheckRange(path, searches[i], evaluations));
  }
  return searches;
}

}  // namespace sinew::files

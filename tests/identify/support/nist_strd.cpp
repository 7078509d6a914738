#include "tests/identify/support/nist_strd.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <map>
#include <unsupported/Eigen/AutoDiff>

#include "base/constants.h"
#include "base/text.h"

namespace sinew {
namespace {

using Dual = Eigen::AutoDiffScalar<Vector>;
using Model = std::function<Dual(const std::vector<Dual>& b, double x)>;

Dual ArcTangent(const Dual& u) {
  return {std::atan(u.value()), u.derivatives() / (1 + u.value() * u.value())};
}

// The equations as given in the files.
const std::map<std::string, Model>& Models() {
  static const std::map<std::string, Model> kModels = {
      {"Misra1a", [](const auto& b, double x) -> Dual { return b[0] * (1.0 - exp(-b[1] * x)); }},
      {"Chwirut2", [](const auto& b, double x) -> Dual { return exp(-b[0] * x) / (b[1] + b[2] * x); }},
      {"Lanczos3",
       [](const auto& b, double x) -> Dual {
         return b[0] * exp(-b[1] * x) + b[2] * exp(-b[3] * x) + b[4] * exp(-b[5] * x);
       }},
      {"Gauss1",
       [](const auto& b, double x) -> Dual {
         const Dual u = (x - b[3]) / b[4];
         const Dual v = (x - b[6]) / b[7];
         return b[0] * exp(-b[1] * x) + b[2] * exp(-u * u) + b[5] * exp(-v * v);
       }},
      {"DanWood", [](const auto& b, double x) -> Dual { return b[0] * exp(b[1] * std::log(x)); }},
      {"Kirby2",
       [](const auto& b, double x) -> Dual {
         return (b[0] + b[1] * x + b[2] * (x * x)) / (1.0 + b[3] * x + b[4] * (x * x));
       }},
      {"Hahn1",
       [](const auto& b, double x) -> Dual {
         return (b[0] + b[1] * x + b[2] * (x * x) + b[3] * (x * x * x)) /
                (1.0 + b[4] * x + b[5] * (x * x) + b[6] * (x * x * x));
       }},
      {"MGH17",
       [](const auto& b, double x) -> Dual { return b[0] + b[1] * exp(-x * b[3]) + b[2] * exp(-x * b[4]); }},
      {"Roszman1",
       [](const auto& b, double x) -> Dual {
         const Dual u = b[2] / (x - b[3]);
         return b[0] - b[1] * x - ArcTangent(u) / kPi;
       }},
      {"ENSO",
       [](const auto& b, double x) -> Dual {
         const double year = 2 * kPi * x / 12;
         const Dual u = 2 * kPi * x / b[3];
         const Dual v = 2 * kPi * x / b[6];
         return b[0] + b[1] * std::cos(year) + b[2] * std::sin(year) + b[4] * cos(u) + b[5] * sin(u) +
                b[7] * cos(v) + b[8] * sin(v);
       }},
      {"MGH09",
       [](const auto& b, double x) -> Dual { return b[0] * (x * x + x * b[1]) / (x * x + x * b[2] + b[3]); }},
      {"Thurber",
       [](const auto& b, double x) -> Dual {
         return (b[0] + b[1] * x + b[2] * (x * x) + b[3] * (x * x * x)) /
                (1.0 + b[4] * x + b[5] * (x * x) + b[6] * (x * x * x));
       }},
      {"Rat42", [](const auto& b, double x) -> Dual { return b[0] / (1.0 + exp(b[1] - b[2] * x)); }},
      {"MGH10", [](const auto& b, double x) -> Dual { return b[0] * exp(b[1] / (x + b[2])); }}};
  return kModels;
}

}  // namespace

Result<NistDataset> ReadNist(const std::string& folder, const std::string& name) {
  const std::string path = folder + "/" + name + ".dat";
  std::ifstream file(path);
  if (!file) return Fail("{}: cannot be read", path);
  NistDataset data;
  data.name = name;
  std::string line;
  bool in_data = false;
  for (long number = 1; std::getline(file, line); ++number) {
    const std::vector<std::string_view> words = SplitBlanks(Trim(line));
    if (words.empty()) continue;
    if (words[0][0] == 'b' && words.size() == 6 && words[1] == "=") {
      for (const std::size_t w : {2, 3, 4}) {
        const std::optional<double> value = ParseNumber(words[w]);
        if (!value) return FailAt(path, number, "'{}' is not a number", words[w]);
        (w == 4 ? data.certified : data.starts[w - 2]).push_back(*value);
      }
    } else if (words.size() == 5 && words[0] == "Residual" && words[1] == "Sum") {
      data.residual_sum_of_squares = ParseNumber(words[4]).value_or(0);
    } else if (words[0] == "Data:") {
      in_data = true;  // the word also occurs in the header, where no line has two numbers
    } else if (in_data && words.size() == 2) {
      const std::optional<double> y = ParseNumber(words[0]);
      const std::optional<double> x = ParseNumber(words[1]);
      if (!y || !x) continue;
      data.y.push_back(*y);
      data.x.push_back(*x);
    }
  }
  // Some copies of Roszman1.dat have "1.20196866396E-0" where NIST has this; only this gives the certified
  // sum.
  if (name == "Roszman1" && !data.certified.empty()) data.certified[0] = 2.0196866396E-01;
  if (data.certified.empty() || data.y.empty()) return Fail("{}: not a NIST StRD file", path);
  return data;
}

const std::vector<std::string>& NistNames() {
  static const std::vector<std::string> kNames = {"Misra1a", "Chwirut2", "Lanczos3", "Gauss1",   "DanWood",
                                                  "Kirby2",  "Hahn1",    "MGH17",    "Roszman1", "ENSO",
                                                  "MGH09",   "Thurber",  "Rat42",    "MGH10"};
  return kNames;
}

void MakeNist(const NistDataset& data, int start, FunctionProblem& problem) {
  std::vector<int> columns;
  for (std::size_t i = 0; i < data.certified.size(); ++i) {
    const auto [low, high] = std::minmax({data.starts[0][i], data.starts[1][i], data.certified[i]});
    const double margin = 2 * (high - low);
    problem.Add("b" + std::to_string(i + 1), low - margin, high + margin,
                data.starts[static_cast<std::size_t>(start)][i]);
    columns.push_back(static_cast<int>(i));
  }
  const Model& model = Models().at(data.name);
  problem.AddBlock(
      data.name, data.y, columns,
      [x = data.x, &model](const Vector& p, Eigen::Ref<Vector> values, Matrix* derivatives) -> Status {
        std::vector<Dual> b;
        for (Eigen::Index i = 0; i < p.size(); ++i) b.emplace_back(p[i], p.size(), i);
        for (std::size_t i = 0; i < x.size(); ++i) {
          const Dual y = model(b, x[i]);
          values[static_cast<Eigen::Index>(i)] = y.value();
          if (derivatives != nullptr) {
            derivatives->row(static_cast<Eigen::Index>(i)) = y.derivatives().transpose();
          }
        }
        return {};
      });
}

double CertifiedDigits(double value, double certified) {
  constexpr double kPublishedDigits = 11;
  const double error = std::abs(value - certified) / std::abs(certified);
  return error == 0 ? kPublishedDigits : std::clamp(-std::log10(error), 0.0, kPublishedDigits);
}

}  // namespace sinew

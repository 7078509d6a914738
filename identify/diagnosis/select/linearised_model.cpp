#include "identify/diagnosis/select/linearised_model.h"

#include <algorithm>

namespace sinew::diagnosis {

LinearisedModel::LinearisedModel(const Problem& problem, const std::vector<Candidate>& candidates,
                                 const Refit& model, const Vector& nulls)
    : problem_(problem),
      candidates_(candidates),
      model_(model),
      nulls_(nulls),
      fit_(problem, *model.setup),
      whitening_(model.noise, TrainStretches(fit_)) {}

Status LinearisedModel::Linearise() {
  SINEW_ASSIGN(design_, MakeDesign(fit_, model_.x, candidates_, whitening_, ScoredCandidates::kTested));
  residual_ = Whitened(design_.residual);
  base_ = Whitened(design_.base);
  columns_ = Whitened(design_.candidates);
  return {};
}

Matrix LinearisedModel::Whitened(Matrix rows) const {
  for (std::size_t t = 0; t < fit_.train_blocks().size(); ++t) {
    const auto& train = fit_.train_blocks()[t];
    const int n = problem_.layout()[static_cast<std::size_t>(train.block)].samples();
    whitening_.Apply(static_cast<int>(t), rows.middleRows(train.first_row, n));
  }
  return rows;
}

bool LinearisedModel::IsOf(int candidate, int parameter) const {
  const auto& own = candidates_[static_cast<std::size_t>(candidate)].parameters;
  return std::find(own.begin(), own.end(), parameter) != own.end();
}

bool LinearisedModel::HasProbes(int index) const {
  return !fit_.setup().parameters[static_cast<std::size_t>(index)].probes.empty();
}

Matrix LinearisedModel::BaseWithout(const std::vector<int>& causes) const {
  Matrix others = base_;
  for (const auto& [v, column] : design_.at_bound) others.col(v) = Whitened(column);
  for (Eigen::Index v = 0; v < others.cols(); ++v) {
    for (const int cause : causes) {
      if (IsOf(cause, fit_.setup().free[static_cast<std::size_t>(v)])) others.col(v).setZero();
    }
  }
  return others;
}

std::optional<Vector> LinearisedModel::TangentOf(int cause) const {
  const Vector slopes = fit_.Slopes(model_.x);
  Vector change = Vector::Zero(base_.cols());
  for (const Eigen::Index v : VariablesOf(cause)) {
    const int index = fit_.setup().free[static_cast<std::size_t>(v)];
    change[v] = (model_.point[index] - nulls_[index]) / slopes[v];
  }
  if (change.isZero(0)) return {};
  return Vector(base_ * change);
}

std::optional<Vector> LinearisedModel::SecantOf(int cause) const {
  Vector without = model_.point;
  Remove(cause, without);
  auto workspace = fit_.NewWorkspace();
  Vector residual;
  if (!fit_.Evaluate(fit_.Variables(without), workspace, residual, nullptr) || !residual.allFinite())
    return {};
  return Vector(Whitened(design_.residual - residual));
}

std::vector<Eigen::Index> LinearisedModel::ColumnsOf(int candidate, int probe) const {
  std::vector<Eigen::Index> own;
  for (std::size_t k = 0; k < design_.columns.size(); ++k) {
    if (design_.columns[k].candidate == candidate && design_.columns[k].probe == probe)
      own.push_back(static_cast<Eigen::Index>(k));
  }
  return own;
}

std::vector<Eigen::Index> LinearisedModel::VariablesOf(int released) const {
  std::vector<Eigen::Index> own;
  for (std::size_t v = 0; v < fit_.setup().free.size(); ++v) {
    const int index = fit_.setup().free[v];
    if (IsOf(released, index) && !HasProbes(index)) own.push_back(static_cast<Eigen::Index>(v));
  }
  return own;
}

void LinearisedModel::Remove(int cause, Vector& point) const {
  for (const int index : candidates_[static_cast<std::size_t>(cause)].parameters)
    point[index] = nulls_[index];
}

void LinearisedModel::Add(int candidate, int probe, const Vector& change, Vector& point) const {
  const Candidate& added = candidates_[static_cast<std::size_t>(candidate)];
  const auto at = static_cast<std::size_t>(probe);
  for (const auto& [index, value] : added.probes[at].at) point[index] = value;
  if (IsScoredBySecant(added, at)) return;
  const std::vector<Eigen::Index> own = ColumnsOf(candidate, probe);
  for (std::size_t i = 0; i < own.size(); ++i) {
    const int index = design_.columns[static_cast<std::size_t>(own[i])].parameter;
    const Parameter& p = fit_.setup().parameters[static_cast<std::size_t>(index)];
    point[index] = std::clamp(p.null_value + change[static_cast<Eigen::Index>(i)], p.lower, p.upper);
  }
}

}  // namespace sinew::diagnosis

// Step 6: the gain of a model on trials that it was never fitted to.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <utility>
#include <vector>

#include "identify/diagnosis/diagnosis.h"
#include "identify/diagnosis/fit/refit.h"

namespace sinew::diagnosis {

/// The residuals of the held-out trials, their noise, and the gain of one model over another.
class HeldOut {
 public:
  /// @param record of FitSetup, may be null; both outlive it @param threads that fit held-out trials
  HeldOut(const Problem& problem, FitRecord* record, int threads);

  [[nodiscard]] bool exists() const { return !blocks_.empty(); }
  /// Indices into the layout.
  [[nodiscard]] const std::vector<int>& blocks() const { return blocks_; }
  /// Nuisance parameters of held-out trials whose priors ResidualsWithPriors counts, increasing.
  [[nodiscard]] const std::vector<int>& priors() const { return priors_; }

  /// The point with the nuisance parameters of every held-out trial fitted to that trial [P]. The first point
  /// (the base model's) and the last ones are kept: a fit of hundreds of values takes seconds, and further
  /// ones begin at the known answers. Not thread-safe.
  [[nodiscard]] Vector Fitted(const Vector& point) const;

  /// From now on these parameters are fitted by generalised least squares under this noise model; nullptr: by
  /// ordinary ones, as at first. Where noise of the inputs is a random walk, ordinary ones follow it, and
  /// their residuals are less likely than those at the true initial states. Not thread-safe.
  void FitUnder(const noise::NoiseModel* noise);

  /// Where nuisance values have priors: the answers of two models become starts of each other's, so that a
  /// gain is not one minimum against another. To be called before their residuals are compared.
  void Align(const Vector& one, const Vector& other) const;

  /// Weighted residuals [held-out blocks][samples], with the nuisance parameters of every held-out trial
  /// fitted to that trial. Errors: those of Problem::Predict.
  [[nodiscard]] Result<std::vector<Vector>> Residuals(const Vector& point) const;

  /// The same, and below them the rows of the priors of these nuisance parameters [priors, standard
  /// deviations]: a likelihood of held-out trials whose values follow the data has to count what they deviate
  /// by. Without priors, or where samples have groups, whose noise says it: as Residuals.
  [[nodiscard]] Result<std::vector<Vector>> ResidualsWithPriors(const Vector& point) const;

  /// Adds `term(block)` (weighted, empty: nothing) to the residuals.
  void Add(const std::function<Vector(const Block&)>& term, std::vector<Vector>& residuals) const {
    for (std::size_t i = 0; i < blocks_.size(); ++i) {
      const Vector more = term(block(i));
      if (more.size() > 0) residuals[i] += more;
    }
  }

  /// Estimates the noise of the blocks with groups of samples (Block::group) from the base model's residuals;
  /// gains of causes in these blocks are judged by it. Errors: those of EstimateNoiseModel.
  [[nodiscard]] Status EstimateOwnNoise(const std::vector<Vector>& base);

  /// Sum of squared innovations of the residuals in units of their variance, by the noise model of the
  /// training trials, or by the blocks' own.
  [[nodiscard]] double Innovations(const std::vector<Vector>& residuals,
                                   const noise::NoiseModel& noise) const;

  /// Rows of all held-out blocks, one below the other, whitened likewise [sum of samples x k]. Further rows,
  /// of priors, stay as they are.
  [[nodiscard]] Matrix Whitened(const Matrix& rows, const noise::NoiseModel& noise) const;

  /// The same for every group of samples (Block::group), in a fixed order; empty: there are no groups.
  [[nodiscard]] std::vector<double> InnovationsOfGroups(const std::vector<Vector>& residuals,
                                                        const noise::NoiseModel& noise) const;

  /// Gains pooled per quantity, with an interval by a moving-block bootstrap of the samples (Kuensch 1989).
  /// @param floor noise model whose ProcessDeviation per channel is the noise floor
  [[nodiscard]] std::vector<Gain> Gains(const std::vector<Vector>& before, const std::vector<Vector>& after,
                                        const noise::NoiseModel& floor, std::uint64_t seed) const;

 private:
  [[nodiscard]] const Block& block(std::size_t i) const {
    return problem_.layout()[static_cast<std::size_t>(blocks_[i])];
  }
  /// Noise model of a block; nullptr if there is none.
  [[nodiscard]] const noise::ChannelNoiseModel* NoiseOf(const Block& block,
                                                        const noise::NoiseModel& trained) const;
  [[nodiscard]] Vector FittedUnder(const noise::NoiseModel& noise, const Vector& fitted) const;
  [[nodiscard]] Matrix WhitenedBlock(std::size_t i, const Matrix& rows, const noise::NoiseModel& noise) const;
  [[nodiscard]] double FloorOf(const Block& block, const noise::NoiseModel& trained) const;

  const Problem& problem_;
  FitRecord* record_;
  int threads_;
  bool many_minima_ = false;  // a held-out trial has nuisance values with priors
  std::vector<int> blocks_;
  std::vector<int> priors_;  // parameters whose priors count
  std::optional<noise::NoiseModel> under_;
  noise::NoiseModel own_;                                  // of the blocks with groups, per channel
  mutable std::vector<std::pair<Vector, Vector>> fitted_;  // points, last one last, and their answers
};

/// Standard deviation of the noise of a block, weighted: the one stated by the data, else that of the noise
/// model of its channel, or of another fitted channel of the same quantity; 0 if there is none.
[[nodiscard]] double NoiseFloorOf(const Block& block, const noise::NoiseModel& noise, const Layout& layout);

}  // namespace sinew::diagnosis

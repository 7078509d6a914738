#include "problems/nms/excitation/search.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlopt.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "base/random.h"
#include "identify/fit_setup.h"
#include "problems/nms/excitation/free_muscle.h"
#include "tests/problems/nms/ceinms_example.h"

namespace sinew {
namespace {

using testing::HasSubstr;

struct Bound {
  NmsMode mode;
  FreeMuscles free;
  std::unique_ptr<NmsProblem> problem;
};

std::string Yaml(const std::string& mode, const std::string& model = "as_ceinms: true") {
  return "nms:\n  subject: subject.xml\n  " + model + "\n  mode: " + mode +
         "\n  parameters:\n    strength: {share: single, lower: 0.5, upper: 2.5}\n";
}

constexpr const char* kHybrid =
    "{type: assisted, alpha: 1, beta: 2, gamma: 3, synthesise: [bifemsh_r], adjust: [rect_fem_r, vas_int_r, "
    "vas_lat_r, vas_med_r, bifemlh_r, semimem_r, med_gas_r, lat_gas_r, soleus_r, tib_ant_r]}";

Result<Bound> Bind(const Dataset& data, const std::string& text) {
  SINEW_ASSIGN(const YamlReader yaml, YamlReader::Parse(text, "nms.yaml"));
  SINEW_ASSIGN(const YamlReader section, yaml.At("nms"));
  SINEW_ASSIGN(NmsSettings settings, ReadNmsSettings(section, data.files));
  Bound bound;
  bound.mode = settings.mode;
  if (bound.mode.type != NmsModeType::kOpenLoop) {
    const auto muscles = MusclesOf(settings.subject, settings.joints);
    SINEW_ASSIGN(bound.free, ChooseFreeMuscles(bound.mode, muscles, settings.subject, data));
  }
  SINEW_ASSIGN(bound.problem, NmsProblem::Make(data, std::move(settings), bound.free.synthesised));
  return bound;
}

Vector Start(const NmsProblem& problem) {
  return MakeFitSetup(problem, {})->rest;
}

// What the problem predicts for a joint, from its muscles.
Vector Moment(const NmsProblem& problem, std::size_t trial, std::size_t joint) {
  const NmsParts parts = problem.PartsAt(Start(problem), trial);
  std::vector<MuscleTrace<double>> muscles;
  EXPECT_TRUE(problem.MusclesAt(Start(problem), trial, muscles));
  Vector moment = parts.beyond[joint];
  const auto& movers = problem.data().joint_muscles[joint];
  for (std::size_t k = 0; k < movers.size(); ++k) {
    const auto& force = muscles[static_cast<std::size_t>(movers[k])].tendon_force;
    moment += parts.arms[joint][k].cwiseProduct(Eigen::Map<const Vector>(force.data(), moment.size()));
  }
  return moment;
}

double MomentCost(const NmsProblem& problem, std::size_t trial) {
  double sum = 0;
  for (std::size_t j = 0; j < problem.data().joint_muscles.size(); ++j) {
    const Block& block =
        problem.data().layout[static_cast<std::size_t>(problem.data().trials[trial].first_block) + j];
    const Vector moment = Moment(problem, trial, j);
    for (std::size_t k = 0; k < block.measured.size(); ++k)
      sum += std::pow(block.measured[k] - moment[block.sample[k]], 2);
  }
  return sum;
}

double WorstRmse(const NmsProblem& problem) {
  double worst = 0;
  for (std::size_t t = 0; t < problem.data().trials.size(); ++t)
    worst = std::max(
        worst, std::sqrt(MomentCost(problem, t) / static_cast<double>(problem.data().trials[t].time.size())));
  return worst;
}

class ExcitationSearchTest : public testing::Test {
 protected:
  void SetUp() override {
    if (!std::filesystem::exists(ExamplePath("true.xml"))) GTEST_SKIP() << "needs the shared data";
  }
};

// The same problem with the kinks split off, e = measured + more - less, as a smooth one for somebody else's
// solver.
struct Split {
  const ExcitationFrame& frame;
  const FrameMuscles& muscles;
};

double SplitObjective(unsigned count, const double* x, double* gradient, void* data) {
  const Split& split = *static_cast<Split*>(data);
  const auto n = static_cast<Eigen::Index>(count / 2);
  const ExcitationWeights& w = split.frame.weights;
  Vector e(n);
  double kinks = 0;
  for (Eigen::Index m = 0; m < n; ++m) {
    const double measured = split.frame.measured[m];
    e[m] = (std::isnan(measured) ? 0 : measured) + x[m] - x[n + m];
    if (!std::isnan(measured)) kinks += x[m] + x[n + m];
  }
  Vector rest = split.frame.moment;
  Vector slope(n);
  for (Eigen::Index m = 0; m < n; ++m) {
    const auto force = split.muscles.Force(static_cast<int>(m), e[m]);
    rest -= split.frame.arms.col(m) * force->force;
    slope[m] = force->slope;
  }
  for (Eigen::Index m = 0; gradient != nullptr && m < n; ++m) {
    const double smooth = -2 * w.alpha * split.frame.arms.col(m).dot(rest) * slope[m] + 2 * w.beta * e[m];
    const double kink = std::isnan(split.frame.measured[m]) ? 0 : w.gamma;
    gradient[m] = smooth + kink;
    gradient[n + m] = -smooth + kink;
  }
  return w.alpha * rest.squaredNorm() + w.beta * e.squaredNorm() + w.gamma * kinks;
}

double BestOfManyStarts(const ExcitationFrame& frame, const FrameMuscles& muscles, int starts,
                        Random& random) {
  Split split{frame, muscles};
  const auto n = static_cast<std::size_t>(frame.measured.size());
  std::vector<double> upper(2 * n);
  for (std::size_t m = 0; m < n; ++m) {
    const double measured = frame.measured[static_cast<Eigen::Index>(m)];
    upper[m] = std::isnan(measured) ? 1 : 1 - measured;
    upper[n + m] = std::isnan(measured) ? 0 : measured;
  }
  double best = std::numeric_limits<double>::infinity();
  for (int start = 0; start < starts; ++start) {
    nlopt_opt solver = nlopt_create(NLOPT_LD_SLSQP, static_cast<unsigned>(2 * n));
    nlopt_set_min_objective(solver, SplitObjective, &split);
    nlopt_set_lower_bounds1(solver, 0);
    nlopt_set_upper_bounds(solver, upper.data());
    nlopt_set_ftol_rel(solver, 1e-14);
    nlopt_set_maxeval(solver, 2000);
    std::vector<double> x(2 * n);
    for (std::size_t k = 0; k < 2 * n; ++k) x[k] = start == 0 ? 0 : upper[k] * random.Uniform();
    double value = 0;
    nlopt_optimize(solver, x.data(), &value);
    best = std::min(best, SplitObjective(static_cast<unsigned>(2 * n), x.data(), nullptr, &split));
    nlopt_destroy(solver);
  }
  return best;
}

// Frames against 20 starts of SLSQP on the split problem.
TEST_F(ExcitationSearchTest, NoFrameHasABetterMinimum) {
  for (const char* subject : {"true.xml", "start.xml"}) {
    for (const char* mode : {kHybrid, "{type: optimised, beta: 2}", "{type: assisted, beta: 0.5, gamma: 30}",
                             "{type: assisted, beta: 1, gamma: 300}"}) {
      const auto bound = Bind(CeinmsExample(subject), Yaml(mode));
      ASSERT_TRUE(bound) << bound.error().message;
      Random random(3);
      double worst = 0;
      double gap = 0;
      int frames = 0;
      const auto watch = [&](std::size_t trial, std::size_t frame, const ExcitationFrame& problem,
                             const FrameMuscles& muscles, const FrameSolution& solution) {
        if (trial > 0 || frame % 4 != 0) return;
        const double best = BestOfManyStarts(problem, muscles, 20, random);
        worst = std::max(worst, (solution.objective - best) / std::max(best, 1e-6));
        EXPECT_NEAR(*FrameObjective(problem, muscles, solution.excitation), solution.objective,
                    1e-12 * (1 + solution.objective));
        gap = std::max(gap, solution.gap / solution.objective);
        ++frames;
      };
      const auto found =
          FindExcitations(*bound->problem, Start(*bound->problem), bound->mode, bound->free, watch);
      ASSERT_TRUE(found) << found.error().message;
      EXPECT_EQ(frames, 31);
      EXPECT_LT(worst, 1e-6) << subject << " " << mode;
      std::printf("%s %s: worst excess %.2g, worst gap %.2g\n", subject, mode, worst, gap);
      for (const FoundExcitations& trial : *found) EXPECT_EQ(trial.unsettled, 0);
    }
  }
}

// The torques were made open loop with these parameters: less effort is what the search finds.
TEST_F(ExcitationSearchTest, IsBelowTheObjectiveOfOpenLoop) {
  const auto bound = Bind(CeinmsExample("true.xml"), Yaml(kHybrid));
  ASSERT_TRUE(bound) << bound.error().message;
  const auto open = Bind(CeinmsExample("true.xml"), Yaml("{type: open_loop}"));
  ASSERT_TRUE(open) << open.error().message;
  const auto found = FindExcitations(*bound->problem, Start(*bound->problem), bound->mode, bound->free);
  ASSERT_TRUE(found) << found.error().message;
  for (std::size_t t = 0; t < 3; ++t) {
    const NmsParts parts = open->problem->PartsAt(Start(*open->problem), t);
    double effort = 0;
    for (std::size_t m = 0; m < 11; ++m) {
      const ActingExcitations acting = ActAtFrames(open->problem->settings().model, parts.slots[m],
                                                   open->problem->data().trials[t].muscles[m]);
      for (std::size_t k = acting.frames_from; k < acting.value.size(); ++k)
        effort += acting.value[k] * acting.value[k];
    }
    const double before = MomentCost(*open->problem, t) + 2 * effort;
    const double after = (*found)[t].objective.sum();
    EXPECT_LT(after, before);
    std::printf("trial %zu: open loop %.6f, found %.6f in %.4f s\n", t + 1, before, after,
                (*found)[t].seconds);
  }
}

// The objective that was reported, from the excitations that were put into the problem.
TEST_F(ExcitationSearchTest, TheProblemPredictsWhatWasFound) {
  for (const char* model : {"as_ceinms: true", "as_ceinms: false", "as_ceinms: false\n  tendon: elastic"}) {
    const auto bound = Bind(CeinmsExample("true.xml"), Yaml(kHybrid, model));
    ASSERT_TRUE(bound) << bound.error().message;
    const auto found = FindExcitations(*bound->problem, Start(*bound->problem), bound->mode, bound->free);
    ASSERT_TRUE(found) << found.error().message;
    for (std::size_t t = 0; t < 3; ++t) {
      const FoundExcitations& of = (*found)[t];
      double objective = MomentCost(*bound->problem, t);
      for (std::size_t m = 0; m < of.excitation.size(); ++m) {
        EXPECT_GE(of.excitation[m].minCoeff(), 0);
        EXPECT_LE(of.excitation[m].maxCoeff(), 1);
        objective += 2 * of.excitation[m].squaredNorm();
        if (of.measured[m].size() > 0) objective += 3 * (of.excitation[m] - of.measured[m]).lpNorm<1>();
      }
      EXPECT_NEAR(objective, of.objective.sum(), 1e-8 * objective) << model;
      EXPECT_EQ(of.unsettled, 0) << model;
      EXPECT_EQ(of.followed, 121);
    }
  }
}

TEST_F(ExcitationSearchTest, GreatGammaIsOpenLoop) {
  const auto open = Bind(CeinmsExample("start.xml"), Yaml("{type: open_loop}"));
  const auto bound =
      Bind(CeinmsExample("start.xml"), Yaml("{type: assisted, alpha: 1, beta: 2, gamma: 1e9}"));
  ASSERT_TRUE(open && bound);
  const auto found = FindExcitations(*bound->problem, Start(*bound->problem), bound->mode, bound->free);
  ASSERT_TRUE(found) << found.error().message;
  EXPECT_EQ(bound->free.adjusted.size(), 11U);
  for (std::size_t t = 0; t < 3; ++t) {
    for (std::size_t j = 0; j < 2; ++j)
      EXPECT_LT((Moment(*open->problem, t, j) - Moment(*bound->problem, t, j)).cwiseAbs().maxCoeff(), 1e-9);
  }
}

TEST_F(ExcitationSearchTest, AlphaAloneFollowsTheMoments) {
  const auto open = Bind(CeinmsExample("start.xml"), Yaml("{type: open_loop}"));
  const auto bound = Bind(CeinmsExample("start.xml"), Yaml("{type: optimised, beta: 0}"));
  ASSERT_TRUE(open && bound);
  const auto found = FindExcitations(*bound->problem, Start(*bound->problem), bound->mode, bound->free);
  ASSERT_TRUE(found) << found.error().message;
  std::printf("worst RMSE: open loop %.3f, alpha alone %.3g N m\n", WorstRmse(*open->problem),
              WorstRmse(*bound->problem));
  EXPECT_LT(WorstRmse(*bound->problem), 0.05 * WorstRmse(*open->problem));
}

TEST_F(ExcitationSearchTest, HybridWithoutEmgOfAMuscle) {
  Dataset data = CeinmsExample("true.xml");
  for (auto& [name, trial] : data.trials) trial.grids["excitations"].channels.erase("bifemsh_r");
  const auto refused = Bind(data, Yaml("{type: open_loop}"));
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().message, HasSubstr("grid 'excitations' has no channel 'bifemsh_r'"));
  const auto bound = Bind(data, Yaml("{type: hybrid, beta: 0.01}"));
  ASSERT_TRUE(bound) << bound.error().message;
  EXPECT_THAT(bound->free.synthesised, testing::ElementsAre("bifemsh_r"));
  EXPECT_THAT(bound->free.adjusted, testing::IsEmpty());
  ASSERT_TRUE(FindExcitations(*bound->problem, Start(*bound->problem), bound->mode, bound->free));
  // All others are as they were when the torques were made.
  EXPECT_LT(WorstRmse(*bound->problem), 1.0);
}

TEST_F(ExcitationSearchTest, OptimisedNeedsNoEmg) {
  Dataset data = CeinmsExample("true.xml");
  for (auto& [name, trial] : data.trials) trial.grids.erase("excitations");
  for (const char* model : {"as_ceinms: false", "as_ceinms: true"}) {
    const auto bound = Bind(data, Yaml("{type: optimised}", model));
    ASSERT_TRUE(bound) << bound.error().message;
    const auto found = FindExcitations(*bound->problem, Start(*bound->problem), bound->mode, bound->free);
    ASSERT_TRUE(found) << found.error().message;
    std::printf("optimised, %s: worst RMSE %.3g N m\n", model, WorstRmse(*bound->problem));
    EXPECT_EQ(*std::max_element((*found)[0].slack.begin(), (*found)[0].slack.end()), 0);
  }
}

// An elastic tendon follows as long as it is taut. A tendon that no EMG keeps taut hangs slack, its muscle
// cannot help within a frame, and that is said.
TEST_F(ExcitationSearchTest, ElasticTendonsFollowWhereTheyAreTaut) {
  constexpr const char* kElastic = "as_ceinms: false\n  tendon: elastic";
  const auto open = Bind(CeinmsExample("true.xml"), Yaml("{type: open_loop}", kElastic));
  const auto assisted = Bind(CeinmsExample("true.xml"), Yaml(kHybrid, kElastic));
  ASSERT_TRUE(open && assisted);
  ASSERT_TRUE(FindExcitations(*assisted->problem, Start(*assisted->problem), assisted->mode, assisted->free));
  EXPECT_GT(WorstRmse(*open->problem), 10);
  EXPECT_LT(WorstRmse(*assisted->problem), 1);
  const auto optimised = Bind(CeinmsExample("true.xml"), Yaml("{type: optimised}", kElastic));
  ASSERT_TRUE(optimised);
  const auto found =
      FindExcitations(*optimised->problem, Start(*optimised->problem), optimised->mode, optimised->free);
  ASSERT_TRUE(found) << found.error().message;
  const auto& names = optimised->problem->data().muscles;
  const auto soleus = std::find(names.begin(), names.end(), "soleus_r") - names.begin();
  EXPECT_GT((*found)[0].slack[static_cast<std::size_t>(soleus)], 10);
  std::printf(
      "elastic: worst RMSE open loop %.3g, assisted %.3g, optimised %.3g N m; soleus slack in %d frames\n",
      WorstRmse(*open->problem), WorstRmse(*assisted->problem), WorstRmse(*optimised->problem),
      (*found)[0].slack[static_cast<std::size_t>(soleus)]);
}

TEST_F(ExcitationSearchTest, WhatCannotBeIsSaid) {
  const auto failure = [](const std::string& text, const std::string& erased = "") {
    Dataset data = CeinmsExample("true.xml");
    if (!erased.empty()) data.trials["trial2"].grids["excitations"].channels.erase(erased);
    auto bound = Bind(data, text);
    if (!bound) return bound.error().message;
    const auto found = FindExcitations(*bound->problem, Start(*bound->problem), bound->mode, bound->free);
    return found ? std::string() : found.error().message;
  };
  EXPECT_THAT(failure(Yaml(kHybrid, "tendon: equilibrium")), HasSubstr("expected tendon: rigid or elastic"));
  EXPECT_THAT(failure(Yaml("{type: hybrd}")), HasSubstr("nms.yaml:4: mode: type: there is no mode 'hybrd'"));
  EXPECT_THAT(failure(Yaml("{type: hybrid, beta: -1}")), HasSubstr("nms.yaml:4: mode: beta = -1"));
  EXPECT_THAT(failure(Yaml("{type: hybrid, alpha: 0}")), HasSubstr("alpha = 0: expected a number above 0"));
  EXPECT_THAT(failure(Yaml("{type: hybrid, synthesise: [soles_r]}")), HasSubstr("did you mean 'soleus_r'"));
  EXPECT_THAT(failure(Yaml("{type: hybrid, joints: [hip]}")), HasSubstr("no joint that is fitted 'hip'"));
  EXPECT_THAT(failure(Yaml("{type: hybrid}")), HasSubstr("nothing to find"));
  EXPECT_THAT(failure(Yaml("{type: optimised, adjust: [soleus_r]}")), HasSubstr("expected no list"));
  EXPECT_THAT(failure(Yaml("{type: hybrid, synthesise: [soleus_r], adjust: [soleus_r]}")),
              HasSubstr("expected one of them"));
  EXPECT_THAT(failure(Yaml("{type: hybrid, synthesise: [soleus_r]}"), "tib_ant_r"),
              HasSubstr("trial 'trial2': the muscle 'tib_ant_r' has no measured excitation"));
}

}  // namespace
}  // namespace sinew
